//! The bound of [`track_points`](super::track_points).
//!
//! The uncertainty of a place, in pixels along x and y, is carried from one iteration to the next. A step is `δ = −G⁻¹ b`
//! with `b = mean(g (J − I))`. Two sides whose places differ by u take steps that differ by `−G⁻¹ H u`, where
//! `H = mean(g ∇Jᵀ)`, and by the roundings of b and of Cramer's rule. So the places after the step differ by at most
//! `|1 − G⁻¹ H| u` and those roundings. The gradient of bilinear samples changes within a pixel with their mixed
//! difference, and at whole places by no more than twice the largest difference of neighbours; both are allowed for where u
//! reaches there. Where a rule (the window leaves the image, a step is short, steps go to and fro, the tensor is weak) is
//! within its uncertainty of being decided otherwise, the point has no bound.

use super::track_points::{Event, Params, Patch, TO_AND_FRO, follow, scratch};

const EPSILON: f64 = f32::EPSILON as f64;

/// Values per point whose comparison says nothing.
const OPEN: [f32; 4] = [f32::MAX; 4];

pub(super) fn rounding(
    p: &Params,
    image: &[f32],
    patches: &[f32],
    tensors: &[f32],
    points: &[f32],
    bound: &mut [f32],
) {
    let area = (p.window_width * p.window_height) as usize;
    let row = 3 * area.next_multiple_of(4);
    let mut room = vec![0.0; scratch(p)];
    for (i, out) in bound.chunks_exact_mut(4).enumerate() {
        let patch = Patch { rows: &patches[row * i..][..row], area, tensor: &tensors[4 * i..][..4] };
        let mut carried = Uncertainty::new(p, patch);
        let found = follow(p, image, patch, &points[4 * i..][..4], &mut room, |event| carried.follow(&event));
        let apart: [f64; 2] = std::array::from_fn(|k| {
            (carried.place[k] + 2.0 * EPSILON * f64::from(found[k] * p.scale).abs()) / f64::from(p.scale)
        });
        let values = [apart[0], apart[1], 0.0, carried.error].map(|value| value as f32);
        let settled = !carried.open && values.iter().all(|value| value.is_finite());
        out.copy_from_slice(if settled { &values } else { &OPEN });
    }
}

/// What is uncertain about a point that is followed.
struct Uncertainty<'a> {
    p: &'a Params,
    patch: Patch<'a>,
    /// Of the place, px.
    place: [f64; 2],
    /// Of the previous step.
    shift: [f64; 2],
    /// Of the error, gray levels.
    error: f64,
    /// Whether a rule may be decided either way.
    open: bool,
}

/// Means over a window's samples.
#[derive(Default)]
struct Means {
    /// `g ∇Jᵀ`, by the index of g and that of ∇J.
    slopes: [[f64; 2]; 2],
    /// `|g|` times the mixed difference, by the index of g.
    mixed: [f64; 2],
    /// `|g|`.
    gradient: [f64; 2],
    /// `|g|` times the largest pixel around the sample.
    sizes: [f64; 2],
    /// `|g (J − I)|`.
    terms: [f64; 2],
    /// `|J − I|`, and the largest pixel around the sample.
    difference: f64,
    size: f64,
    /// The largest differences of neighbours along x and y.
    steepest: [f64; 2],
}

impl<'a> Uncertainty<'a> {
    fn new(p: &'a Params, patch: Patch<'a>) -> Self {
        let [xx, xy, yy] = [0, 1, 2].map(|k| f64::from(patch.tensor[k]));
        let [eigenvalue, determinant] = patch.clarity().map(f64::from);
        let near = |value: f64, limit: f32, error: f64| (value - f64::from(limit)).abs() <= error;
        let open = near(eigenvalue, p.min_eigenvalue, 8.0 * EPSILON * (xx + yy + xy.abs()))
            || near(determinant, p.min_determinant, 4.0 * EPSILON * (xx * yy + xy * xy));
        // A patch that is the same everywhere is weak on both sides.
        let open = open && patch.tensor[3] > 0.0 && xx + yy > 0.0;
        Self { p, patch, place: [0.0; 2], shift: [0.0; 2], error: 0.0, open }
    }

    /// The roundings of a mean relative to the mean magnitude of its terms.
    fn of_mean(&self) -> f64 {
        (self.patch.area.div_ceil(64) + 20) as f64 * EPSILON
    }

    fn follow(&mut self, event: &Event<'_>) {
        match *event {
            Event::Step { place, pixels, samples, shift, before } => {
                self.meets(place);
                let means = self.means(place, pixels, samples);
                self.step(place, &means, shift, before);
            }
            Event::Left { place } => self.meets(place),
            Event::End { place, pixels, samples } => {
                self.meets(place);
                let means = self.means(place, pixels, samples);
                let moved: f64 = (0..2).map(|k| means.steepest[k] * self.place[k]).sum();
                self.error = moved + 8.0 * EPSILON * means.size + self.of_mean() * means.difference;
            }
        }
    }

    /// The rule that the window must meet the image.
    fn meets(&mut self, place: [f32; 2]) {
        let sides = [(self.p.window_width, self.p.width), (self.p.window_height, self.p.height)];
        for (k, (window, side)) in sides.into_iter().enumerate() {
            let at = f64::from(place[k]);
            let distance = (at + f64::from(window)).abs().min((at - f64::from(side)).abs());
            self.open |= self.place[k] > 0.0 && distance <= self.place[k];
        }
    }

    fn means(&self, place: [f32; 2], pixels: &[f32], samples: &[f32]) -> Means {
        let (columns, side) = (self.p.window_width as usize, self.p.window_width as usize + 1);
        let [x, y] = place.map(|at| f64::from(at - at.floor()));
        let [gray, i_x, i_y] = [0, 1, 2].map(|k| self.patch.channel(k));
        let mut means = Means::default();
        let share = 1.0 / self.patch.area as f64;
        for k in 0..self.patch.area {
            let at = k / columns * side + k % columns;
            let [a, b, c, d] = [at, at + 1, at + side, at + side + 1].map(|at| f64::from(pixels[at]));
            let slope = [(1.0 - y) * (b - a) + y * (d - c), (1.0 - x) * (c - a) + x * (d - b)];
            let size = a.abs().max(b.abs()).max(c.abs()).max(d.abs());
            let difference = f64::from(samples[k] - gray[k]).abs();
            for (i, g) in [i_x[k], i_y[k]].map(f64::from).into_iter().enumerate() {
                (0..2).for_each(|j| means.slopes[i][j] += share * g * slope[j]);
                means.mixed[i] += share * (g * (a + d - b - c)).abs();
                means.gradient[i] += share * g.abs();
                means.sizes[i] += share * g.abs() * size;
                means.terms[i] += share * g.abs() * difference;
            }
            means.difference += share * difference;
            means.size += share * size;
            means.steepest[0] = means.steepest[0].max((b - a).abs()).max((d - c).abs());
            means.steepest[1] = means.steepest[1].max((c - a).abs()).max((d - b).abs());
        }
        // Next to whole places the other side may sample the neighbours, which these differences do not hold.
        let near = (0..2).any(|k| self.on_whole(place, k));
        if near {
            means.steepest = means.steepest.map(|_| 2.0 * 255.0);
        }
        means
    }

    /// Whether the other side's place may lie in another pixel.
    fn on_whole(&self, place: [f32; 2], k: usize) -> bool {
        let part = f64::from(place[k] - place[k].floor());
        self.place[k] > 0.0 && (part <= self.place[k] || 1.0 - part <= self.place[k])
    }

    fn step(&mut self, place: [f32; 2], means: &Means, shift: [f32; 2], before: Option<[f32; 2]>) {
        let [xx, xy, yy] = [0, 1, 2].map(|k| f64::from(self.patch.tensor[k]));
        let determinant = xx * yy - xy * xy;
        let inverse = [[yy / determinant, -xy / determinant], [-xy / determinant, xx / determinant]];
        let near: [bool; 2] = std::array::from_fn(|k| self.on_whole(place, k));
        // Of b: by the samples' and the sums' roundings, and by what the slopes do not tell.
        let of_b: [f64; 2] = std::array::from_fn(|i| {
            let rounding = 6.0 * EPSILON * means.sizes[i] + self.of_mean() * means.terms[i];
            let bent = means.mixed[i] * 2.0 * self.place[0] * self.place[1];
            let kinks = (0..2).filter(|k| near[*k]).map(|k| 2.0 * means.steepest[k] * self.place[k]);
            rounding + bent + means.gradient[i] * kinks.sum::<f64>()
        });
        let size = shift.map(|shift| f64::from(shift).abs());
        let of_determinant = 4.0 * EPSILON * (xx * yy + xy * xy) / determinant;
        let mut of_shift = [0.0; 2];
        let mut of_place = [0.0; 2];
        for i in 0..2 {
            let terms: f64 = (0..2).map(|j| inverse[i][j].abs() * means.terms[j]).sum();
            let rounding = 4.0 * EPSILON * terms + (6.0 * EPSILON + of_determinant) * size[i];
            let own: f64 = rounding + (0..2).map(|j| inverse[i][j].abs() * of_b[j]).sum::<f64>();
            let slope = |k: usize| -(inverse[i][0] * means.slopes[0][k] + inverse[i][1] * means.slopes[1][k]);
            let carried = |k: usize, one: f64| (one + slope(k)).abs() * self.place[k];
            of_shift[i] = own + carried(0, 0.0) + carried(1, 0.0);
            let one = |k: usize| if i == k { 1.0 } else { 0.0 };
            of_place[i] = own
                + carried(0, one(0))
                + carried(1, one(1))
                + EPSILON * (f64::from(place[i]).abs() + size[i]);
        }
        self.open |= !(of_determinant < 0.5);
        self.rules(shift, of_shift, before);
        (self.place, self.shift) = (of_place, of_shift);
    }

    /// The rules that end the iterations.
    fn rules(&mut self, shift: [f32; 2], of_shift: [f64; 2], before: Option<[f32; 2]>) {
        let size = shift.map(|shift| f64::from(shift).abs());
        let square = size[0] * size[0] + size[1] * size[1];
        let of_square: f64 = (0..2).map(|k| (2.0 * size[k] + of_shift[k]) * of_shift[k]).sum();
        let limit = f64::from(self.p.epsilon);
        self.open |= (square - limit).abs() <= of_square + 4.0 * EPSILON * square;
        if let Some(before) = before {
            let beyond: [f64; 2] =
                std::array::from_fn(|k| f64::from((shift[k] + before[k]).abs()) - f64::from(TO_AND_FRO));
            let error: [f64; 2] =
                std::array::from_fn(|k| of_shift[k] + self.shift[k] + EPSILON * f64::from(shift[k]).abs());
            // Neither rule is certain if one distance is near its limit and the other is not clearly beyond it.
            let near = (0..2).any(|k| beyond[k].abs() <= error[k]);
            self.open |= near && (0..2).all(|k| beyond[k] <= error[k]);
        }
    }
}
