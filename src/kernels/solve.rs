//! Averages rows of the five channels by a symmetric window, and solves the averaged equations for the displacement.
//!
//! Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003, section 3. 10⁻³ is added to the
//! determinant to keep it off zero, as in OpenCV. A result without a value, after overflow, becomes zero motion, so
//! that it cannot spread.

use super::parallel_rows::{Band, Split, bands, dimensions, extend_row, repeat_last, weighted_sum};
use super::tables;
use super::test_inputs::{Fill, Random, cases as each_fill};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the window.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The window has `2 radius + 1` columns.
        radius: u32,
    }
}

kernel!(
    "solve" + ["image", "window", "average", "solution"],
    reference(Params; columns, window) -> (flow),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-30,
        relative: 0.0, of_largest: 0.0,
        reason: "the roundings of its own averages, products and determinant, by Cramer's rule; and what is smaller than \
                 10⁻³⁰ px a GPU may flush to zero on the way",
    },
    rounding: rounding,
);

fn reference(p: &Params, columns: &[f32], window: &[f32], flow: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    average(p, columns, window, flow, 2, #[inline(always)] |_, averages, rows| {
        let (u, v) = rows.split_at_mut(stride);
        for x in 0..width {
            [u[x], v[x]] = displacement(averages.map(|average| average[x]), REGULAR);
        }
    });
}

/// The displacement that solves a pixel's equations, by Cramer's rule with `regular` added to the determinant.
#[inline(always)]
pub(super) fn displacement([g_xx, g_xy, g_yy, h_x, h_y]: [f32; 5], regular: f32) -> [f32; 2] {
    let scale = 1.0 / (g_xx * g_yy - g_xy * g_xy + regular);
    [known((g_yy * h_x - g_xy * h_y) * scale), known((g_xx * h_y - g_xy * h_x) * scale)]
}

/// Averages rows of five channels by the window and hands `f` the number of each, the averages, and the row of the
/// result that they belong to.
#[inline(always)]
pub(super) fn average(
    p: &Params,
    columns: &[f32],
    window: &[f32],
    result: &mut [f32],
    channels: usize,
    f: impl Fn(usize, [&[f32]; 5], &mut [f32]) + Sync,
) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let radius = p.radius as usize;
    let padding = radius.next_multiple_of(4) - radius;
    let window = &window[padding..][..2 * radius + 1];
    let extended = width + 2 * radius;
    let split = Split { scratch: extended + 5 * width, ..Split::rows_of(channels * stride) };
    bands(result, &mut [], split, #[inline(always)] |band| {
        let Band { y0, out, scratch, .. } = band;
        let (extended, sums) = scratch.split_at_mut(extended);
        for (i, rows) in out.chunks_exact_mut(channels * stride).enumerate() {
            for (channel, sum) in sums.chunks_exact_mut(width).enumerate() {
                extend_row(extended, &columns[(5 * (y0 + i) + channel) * stride..], width, radius);
                weighted_sum(sum, window, |k| &extended[k..][..width]);
            }
            f(y0 + i, [0, 1, 2, 3, 4].map(|channel| &sums[channel * width..][..width]), rows);
            for row in rows.chunks_exact_mut(stride) {
                repeat_last(row, width);
            }
        }
    });
}

/// What keeps the determinant off zero.
const REGULAR: f32 = 1e-3;

/// Displacements beyond this become zero.
const LARGEST: f32 = 1e9;

#[inline(always)]
fn known(d: f32) -> f32 {
    if d.abs() <= LARGEST { d } else { 0.0 }
}

/// The largest difference that roundings may cause between the two sides' displacements, to first order in a rounding's
/// relative error `ε / 2`.
///
/// Both sides have the same columns. An average g of n terms, with S the average of the terms' magnitudes, is off by at
/// most `n S ε / 2` in whatever order it is summed, so that two of them lie within `n S ε` of each other. Cramer's rule
/// divides `N = g_yy h_x − g_xy h_y` (and the like for v) by `D = g_xx g_yy − g_xy² + 10⁻³`. Two factors of n roundings
/// each, those of the products and that of the difference make `|δN| ≤ (2 n + 2) ε (S_yy S_hx + S_xy S_hy)`, and with
/// one more for 10⁻³ `|δD| ≤ (2 n + 3) ε (S_xx S_yy + S_xy² + 10⁻³)`, whatever cancels. From `N' / D' − N / D = (δN − d
/// δD) / D'` follows
///
/// `|δd| ≤ (|δN| + |d| |δD|) / (D − |δD|) + 4 ε |d|`,
///
/// where the last part is that of the reciprocal, which WGSL allows 2.5 units in the last place, and of its product. So
/// the bound grows with `S_xx S_yy / D`, as the ratio of the equations' eigenvalues does. Where D is within its
/// roundings of zero, or d within its own of what counts as no motion, the sides may have any two displacements.
/// Averages are those of the reference, and what follows from them is computed in `f64`.
fn rounding(p: &Params, columns: &[f32], window: &[f32], bound: &mut [f32]) {
    rounding_of(p, REGULAR, columns, window, bound);
}

/// The same for another number in place of 10⁻³.
pub(super) fn rounding_of(p: &Params, regular: f32, columns: &[f32], window: &[f32], bound: &mut [f32]) {
    let (width, height, stride) = dimensions(p.width, p.height);
    let of_row = 5 * stride;
    let averaged = |columns: &[f32]| {
        let mut sums = vec![0.0; of_row * height];
        average(p, columns, window, &mut sums, 5, |_, averages, rows| {
            for (row, average) in rows.chunks_exact_mut(stride).zip(averages) {
                row[..width].copy_from_slice(average);
            }
        });
        sums
    };
    let magnitudes: Vec<f32> = columns.iter().map(|value| value.abs()).collect();
    let (sums, sizes) = (averaged(columns), averaged(&magnitudes));
    let terms = f64::from(2 * p.radius + 1);
    for (y, rows) in bound.chunks_exact_mut(2 * stride).enumerate() {
        for x in 0..stride {
            let at = |values: &[f32]| [0, 1, 2, 3, 4].map(|i| f64::from(values[y * of_row + i * stride + x]));
            [rows[x], rows[stride + x]] = apart(at(&sums), at(&sizes), terms, f64::from(regular));
        }
    }
}

/// The bounds of u and v, from the averages, those of the magnitudes, and how many terms they have: see [`rounding`].
fn apart(averages: [f64; 5], sizes: [f64; 5], terms: f64, regular: f64) -> [f32; 2] {
    const EPSILON: f64 = f32::EPSILON as f64;
    let [g_xx, g_xy, g_yy, h_x, h_y] = averages;
    let [s_xx, s_xy, s_yy, s_hx, s_hy] = sizes;
    let determinant = g_xx * g_yy - g_xy * g_xy + regular;
    let of_determinant = (2.0 * terms + 3.0) * EPSILON * (s_xx * s_yy + s_xy * s_xy + regular);
    let least = determinant - of_determinant;
    let each = [
        (g_yy * h_x - g_xy * h_y, s_yy * s_hx + s_xy * s_hy),
        (g_xx * h_y - g_xy * h_x, s_xx * s_hy + s_xy * s_hx),
    ];
    each.map(|(numerator, size)| {
        let d = (numerator / determinant).abs();
        let of_numerator = (2.0 * terms + 2.0) * EPSILON * size;
        let bound = (of_numerator + d * of_determinant) / least + 4.0 * EPSILON * d;
        let settled = least > 0.0 && d + bound <= f64::from(LARGEST);
        if settled { bound as f32 } else { 2.0 * LARGEST }
    })
}

/// Equations of a model whose two eigenvalues lie between the given bounds, for some displacement up to 8 px.
pub(super) fn cases(size: Size) -> Vec<Case> {
    let params = Params { width: size.width, height: size.height, radius: 6 };
    let window = tables::window_from(&tables::window(13, false), 8);
    let mut cases = each_fill(Fill::NUMBERS, bytemuck::bytes_of(&params), &[2 * size.stride()], size, |fill| {
        vec![equations(size, fill), window.clone()]
    });
    // Determinants near the 10⁻³ that keeps them off zero, where it decides the displacement; products that overflow
    // though the equations themselves do not; and edges all along one direction, which leave the motion along them
    // almost open.
    let scaled = |factor: f32| equations(size, Fill::Textured).iter().map(|value| factor * value).collect();
    for (name, columns) in
        [("weak", scaled(0.01)), ("overflowing", scaled(1e25)), ("edges", edges(size, 1e-3))]
    {
        let (params, outputs) = (bytemuck::bytes_of(&params).to_vec(), vec![2 * size.stride() * size.height as usize]);
        cases.push(Case { name: name.to_owned(), params, inputs: vec![columns, window.clone()], outputs, extent: size });
    }
    cases
}

pub(super) fn equations(size: Size, fill: Fill) -> Vec<f32> {
    made(size, |random| {
        let [angle, p, q] = [(); 3].map(|()| random.next());
        let [p, q] = match fill {
            Fill::Flat => [0.0, 0.0],
            Fill::Extreme if p < 0.5 => [1e6, 1e6],
            Fill::Extreme => [1.0, 2.0],
            _ => [1.0 + 9.0 * p, 1.0 + 9.0 * q],
        };
        (angle * std::f32::consts::TAU, [p, q])
    })
}

/// Equations of edges along one direction: `ratio` is the second eigenvalue relative to the first.
pub(super) fn edges(size: Size, ratio: f32) -> Vec<f32> {
    made(size, |random| {
        let p = 10.0 + 90.0 * random.next();
        (0.6, [p, ratio * p])
    })
}

/// Equations of one displacement a pixel, up to 8 px, each with the angle of the first eigenvector, and both
/// eigenvalues, that are drawn for it.
fn made(size: Size, mut draw: impl FnMut(&mut Random) -> (f32, [f32; 2])) -> Vec<f32> {
    let mut random = Random::new(23);
    let stride = size.stride();
    let mut values = vec![0.0; 5 * stride * size.height as usize];
    for row in values.chunks_exact_mut(5 * stride) {
        for x in 0..size.width as usize {
            let (angle, [p, q]) = draw(&mut random);
            let [u, v] = [(); 2].map(|()| random.next());
            let (sin, cos) = angle.sin_cos();
            let (xx, xy, yy) = (p * cos * cos + q * sin * sin, (p - q) * sin * cos, p * sin * sin + q * cos * cos);
            let (u, v) = (16.0 * u - 8.0, 16.0 * v - 8.0);
            let pixel = [xx, xy, yy, xx * u + xy * v, xy * u + yy * v];
            for (channel, value) in pixel.into_iter().enumerate() {
                row[channel * stride + x] = value;
            }
        }
        for channel in row.chunks_exact_mut(stride) {
            repeat_last(channel, size.width as usize);
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size::new(97, 61);

    /// The kernel's result for the columns, its rounding bound, and the result in `f64`.
    fn solved(columns: &[f32], winsize: u32, gaussian: bool) -> Vec<[f64; 3]> {
        let radius = winsize / 2;
        let window = tables::window(winsize, gaussian);
        let padded = tables::window_from(&window, radius.next_multiple_of(4) as usize);
        let p = Params { width: SIZE.width, height: SIZE.height, radius };
        let (width, _, stride) = dimensions(p.width, p.height);
        let mut flow = vec![0.0; 2 * stride * SIZE.height as usize];
        let mut bound = flow.clone();
        reference(&p, columns, &padded, &mut flow);
        rounding(&p, columns, &padded, &mut bound);
        let mut values = Vec::new();
        for y in 0..SIZE.height as usize {
            for x in 0..width {
                let [g_xx, g_xy, g_yy, h_x, h_y] = [0, 1, 2, 3, 4].map(|channel| {
                    let row = &columns[(5 * y + channel) * stride..][..width];
                    let place = |k: usize| (x + k).saturating_sub(radius as usize).min(width - 1);
                    (0..).zip(&window).map(|(k, w)| f64::from(*w) * f64::from(row[place(k)])).sum::<f64>()
                });
                let determinant = g_xx * g_yy - g_xy * g_xy + f64::from(REGULAR);
                for (i, d) in [g_yy * h_x - g_xy * h_y, g_xx * h_y - g_xy * h_x].into_iter().enumerate() {
                    let at = (2 * y + i) * stride + x;
                    values.push([f64::from(flow[at]), f64::from(bound[at]), d / determinant]);
                }
            }
        }
        values
    }

    /// The reference is one of the two sides, and exact arithmetic stands for the other: from equations as good as they
    /// can be to edges along which rounding decides the motion, where nothing is promised. Elsewhere the roundings take
    /// up a hundredth of the bound at least, so that it is no larger than it need be.
    #[test]
    fn roundings_stay_within_the_bound() {
        for (winsize, gaussian) in [(2, false), (3, true), (13, false), (15, true), (101, false)] {
            for (ratio, open) in [(1.0, false), (1e-2, false), (1e-4, false), (1e-7, true)] {
                let values = solved(&edges(SIZE, ratio), winsize, gaussian);
                let mut share: f64 = 0.0;
                for [found, bound, exact] in &values {
                    assert!((found - exact).abs() <= *bound, "{winsize}, {ratio}: {found}, {exact}, {bound}");
                    share = share.max((found - exact).abs() / bound);
                }
                let widest = values.iter().map(|[_, bound, _]| *bound).fold(0.0, f64::max);
                println!("{winsize} {gaussian}, {ratio}: {share:.4} of the bound, at most {widest:.1e} px");
                assert_eq!(widest == 2e9, open, "{winsize}, {ratio}: {widest}");
                assert!(open || share >= 0.01, "{winsize}, {ratio}: {share}");
            }
        }
    }

    /// Where the eigenvalues' ratio stays below ten the bound leaves a mistake less room than 10⁻⁴ of a pixel and as
    /// much of the displacement.
    #[test]
    fn the_bound_is_tight_where_the_equations_are_good() {
        for (winsize, gaussian) in [(13, false), (15, true), (31, false)] {
            let mut widest: f64 = 0.0;
            for [found, bound, _] in solved(&equations(SIZE, Fill::Textured), winsize, gaussian) {
                widest = widest.max(bound / (1.0 + found.abs()));
            }
            println!("{winsize} {gaussian}: {widest:.1e}");
            assert!(widest <= 1e-4, "{winsize}: {widest:e}");
        }
    }
}
