//! Moves the windows of points in the next image until it shows there what the windows hold: Gauss–Newton iterations on
//! one level of the pyramid.
//!
//! B. Lucas and T. Kanade, An iterative image registration technique with an application to stereo vision, IJCAI 1981;
//! J.-Y. Bouguet, Pyramidal implementation of the Lucas Kanade feature tracker, 2001. The rules are those of OpenCV's
//! `calcOpticalFlowPyrLK`: a point whose tensor is too weak on a coarse level keeps its place there; a window that leaves
//! the image ends the iterations; steps to and fro, less than 0.01 px apart, end half-way; and a point is lost only by
//! what happens on the full image.

use super::parallel_rows::{Split, bands, dimensions};
use super::track_points_bound::rounding;
use super::track_points_cases::cases;
use super::window_samples::{Window, lane_sums};
use crate::kernel::{Tolerance, kernel, params};

params! {
    /// Shape of the image and of the window, and the rules.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Columns of the window; it has at most 4096 samples.
        window_width: u32,
        /// Rows of the window.
        window_height: u32,
        /// From pixels of the full image to those of this one: a power of two.
        scale: f32,
        /// The most iterations, 1 to 100.
        iterations: u32,
        /// The squared displacement that ends the iterations, in square pixels of this image.
        epsilon: f32,
        /// The least smaller eigenvalue of the mean structure tensor, in (gray levels per pixel)².
        min_eigenvalue: f32,
        /// Its least determinant.
        min_determinant: f32,
        /// 1 on the full image: only there a point is lost, and the error is computed.
        finest: u32,
    }
}

kernel!(
    "track_points" + ["image", "window_offset", "lane_sum"],
    reference(Params; image, patches, tensors, points) -> (tracked),
    cases: cases,
    tolerance: Tolerance {
        absolute: 1e-30,
        relative: 0.0, of_largest: 0.0,
        reason: "the roundings of samples, sums and Cramer's rule, carried from one iteration to the next; where they \
                 decide whether a rule applies, nothing is promised",
    },
    rounding: rounding,
);

/// The distance in pixels between steps to and fro that ends the iterations.
pub(super) const TO_AND_FRO: f32 = 0.01;

/// What happens to a point: see [`follow`].
pub(super) enum Event<'a> {
    /// An iteration: the place of the window's first sample, the pixels around the samples, their values, the step, and
    /// the step before it.
    Step {
        place: [f32; 2],
        pixels: &'a [f32],
        samples: &'a [f32],
        shift: [f32; 2],
        before: Option<[f32; 2]>,
    },
    /// The window left the image at this place.
    Left { place: [f32; 2] },
    /// The error was computed there.
    End { place: [f32; 2], pixels: &'a [f32], samples: &'a [f32] },
}

/// A point's window in the first image.
#[derive(Clone, Copy)]
pub(super) struct Patch<'a> {
    /// A row for each channel: I, I_x, I_y.
    pub(super) rows: &'a [f32],
    pub(super) area: usize,
    pub(super) tensor: &'a [f32],
}

impl Patch<'_> {
    pub(super) fn channel(&self, k: usize) -> &[f32] {
        &self.rows[k * self.area.next_multiple_of(4)..][..self.area]
    }

    /// The smaller eigenvalue and the determinant of the tensor.
    pub(super) fn clarity(&self) -> [f32; 2] {
        let [xx, xy, yy] = [0, 1, 2].map(|k| self.tensor[k]);
        let difference = xx - yy;
        [0.5 * (xx + yy - (difference * difference + 4.0 * xy * xy).sqrt()), xx * yy - xy * xy]
    }
}

/// The number of scratch values that [`follow`] needs.
pub(super) fn scratch(p: &Params) -> usize {
    ((p.window_width + 1) * (p.window_height + 1) + p.window_width * p.window_height) as usize
}

fn reference(p: &Params, image: &[f32], patches: &[f32], tensors: &[f32], points: &[f32], tracked: &mut [f32]) {
    let area = (p.window_width * p.window_height) as usize;
    let row = 3 * area.next_multiple_of(4);
    let split = Split { scratch: scratch(p), dearer: area * 8, fewest_rows: 4, ..Split::rows_of(4) };
    bands(tracked, &mut [], split, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(4).enumerate() {
            let i = band.y0 + i;
            let patch = Patch { rows: &patches[row * i..][..row], area, tensor: &tensors[4 * i..][..4] };
            out.copy_from_slice(&follow(p, image, patch, &points[4 * i..][..4], band.scratch, |_| {}));
        }
    });
}

/// Follows a point (x, y, status, error), and tells `observe` what happens. Returns the point in the next image.
#[inline(always)]
pub(super) fn follow(
    p: &Params,
    image: &[f32],
    patch: Patch<'_>,
    point: &[f32],
    scratch: &mut [f32],
    mut observe: impl FnMut(Event<'_>),
) -> [f32; 4] {
    let [width, height, stride] = <[usize; 3]>::from(dimensions(p.width, p.height));
    let window = [p.window_width, p.window_height];
    let half = window.map(|side| 0.5 * (side as f32 - 1.0));
    let (pixels, samples) = scratch.split_at_mut(((window[0] + 1) * (window[1] + 1)) as usize);
    let [xx, xy, yy] = [0, 1, 2].map(|k| patch.tensor[k]);
    let [eigenvalue, determinant] = patch.clarity();
    let clear = point[2] > 0.0
        && patch.tensor[3] > 0.0
        && eigenvalue >= p.min_eigenvalue
        && determinant >= p.min_determinant;
    if !clear {
        let status = if p.finest == 1 { 0.0 } else { point[2] };
        return [point[0], point[1], status, 0.0];
    }
    let inverse = 1.0 / determinant;
    let mut found: [f32; 2] = std::array::from_fn(|k| point[k] * p.scale);
    let mut place: [f32; 2] = std::array::from_fn(|k| found[k] - half[k]);
    let mut before = None::<[f32; 2]>;
    for _ in 0..p.iterations {
        let Some(at) = Window::at(place, window, [width, height]) else {
            observe(Event::Left { place });
            break;
        };
        let [b_x, b_y, _] = misfit(image, [width, height, stride], at, patch, pixels, samples);
        let shift = [inverse * (xy * b_y - yy * b_x), inverse * (xy * b_x - xx * b_y)];
        observe(Event::Step { place, pixels, samples, shift, before });
        place = [place[0] + shift[0], place[1] + shift[1]];
        found = [place[0] + half[0], place[1] + half[1]];
        if shift[0] * shift[0] + shift[1] * shift[1] <= p.epsilon {
            break;
        }
        let to_and_fro = |k: usize, before: [f32; 2]| (shift[k] + before[k]).abs() < TO_AND_FRO;
        if before.is_some_and(|before| to_and_fro(0, before) && to_and_fro(1, before)) {
            found = [found[0] - 0.5 * shift[0], found[1] - 0.5 * shift[1]];
            break;
        }
        before = Some(shift);
    }
    let (mut status, mut error) = (point[2], 0.0);
    if p.finest == 1 {
        let end = [found[0] - half[0], found[1] - half[1]];
        match Window::at(end, window, [width, height]) {
            Some(at) => {
                let [.., mean] = misfit(image, [width, height, stride], at, patch, pixels, samples);
                observe(Event::End { place: end, pixels, samples });
                error = mean;
            }
            None => {
                observe(Event::Left { place: end });
                status = 0.0;
            }
        }
    }
    [found[0] / p.scale, found[1] / p.scale, status, error]
}

/// The means over a window of I_x d, I_y d and |d|, with d the difference of the image from the patch.
#[inline(always)]
fn misfit(
    image: &[f32],
    dimensions: [usize; 3],
    window: Window,
    patch: Patch<'_>,
    pixels: &mut [f32],
    samples: &mut [f32],
) -> [f32; 3] {
    window.pixels(image, dimensions, 0, pixels);
    window.sample(pixels, samples);
    let [gray, i_x, i_y] = [0, 1, 2].map(|k| patch.channel(k));
    let sums = lane_sums([&samples[..patch.area], gray, i_x, i_y], #[inline(always)] |[sample, gray, i_x, i_y]| {
        let d = sample - gray;
        [i_x * d, i_y * d, d.abs()]
    });
    sums.map(|sum| sum / patch.area as f32)
}
