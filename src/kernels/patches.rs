//! The windows around points of an image, sampled bilinearly: gray level and gradient of each sample, and the mean of the
//! gradients' structure tensor.
//!
//! J.-Y. Bouguet, Pyramidal implementation of the Lucas Kanade feature tracker, 2001. The gradient is Scharr's of 3 × 3
//! pixels over 32, in gray levels per pixel. As in OpenCV's `calcOpticalFlowPyrLK` the image continues mirrored beyond its
//! border, and the gradient is 0 there; a window that lies outside altogether has no samples.

use super::parallel_rows::{Band, Split, bands, dimensions};
use super::test_inputs::{Fill, Random, planes};
use super::window_samples::{Window, lane_sums};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the image and of the window.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Columns of the window; it has at most 4096 samples.
        window_width: u32,
        /// Rows of the window.
        window_height: u32,
        /// From pixels of the full image to those of this one.
        scale: f32,
    }
}

kernel!(
    "patches" + ["image", "window_offset", "lane_sum"],
    reference(Params; image, points) -> (patches, tensors),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 0.0,
        of_largest: 16.0 * f32::EPSILON,
        reason: "weights and the sums of four products, 32 for a gradient; means are summed in the same order, and have \
                 the roundings of a product of two gradients. Places are the same on both sides: their products are exact",
    },
);

/// The largest number of a window's samples.
pub const MAX_SAMPLES: usize = 4096;

fn reference(p: &Params, image: &[f32], points: &[f32], patches: &mut [f32], tensors: &mut [f32]) {
    let [width, height, stride] = <[usize; 3]>::from(dimensions(p.width, p.height));
    let window = [p.window_width, p.window_height];
    let area = (p.window_width * p.window_height) as usize;
    let padded = area.next_multiple_of(4);
    let pixels = (p.window_width + 3) as usize * (p.window_height + 3) as usize;
    let split = Split { second_row: 4, scratch: pixels, dearer: 8, fewest_rows: 4, ..Split::rows_of(3 * padded) };
    bands(patches, tensors, split, #[inline(always)] |band| {
        let Band { y0, out, second, scratch, .. } = band;
        for (i, (patch, tensor)) in out.chunks_exact_mut(3 * padded).zip(second.chunks_exact_mut(4)).enumerate() {
            let point = &points[4 * (y0 + i)..][..4];
            let place = [0, 1].map(|k| point[k] * p.scale - 0.5 * (window[k] as f32 - 1.0));
            patch.fill(0.0);
            tensor.fill(0.0);
            let Some(window) = Window::at(place, window, [width, height]).filter(|_| point[2] > 0.0) else { continue };
            let side = window.pixels(image, [width, height, stride], 1, scratch);
            let (gray, rest) = patch.split_at_mut(padded);
            let (i_x, i_y) = rest.split_at_mut(padded);
            for row in 0..window.rows {
                for column in 0..window.columns {
                    let k = row * window.columns + column;
                    let rows: [&[f32]; 4] = std::array::from_fn(|j| &scratch[(row + j) * side + column..][..4]);
                    let pixel = [window.corner[0] + column as isize, window.corner[1] + row as isize];
                    [gray[k], i_x[k], i_y[k]] = sampled(rows, window.part, pixel, [width, height]);
                }
            }
            for channel in [&mut *gray, &mut *i_x, &mut *i_y] {
                let last = channel[area - 1];
                channel[area..].fill(last);
            }
            let sums = lane_sums([&i_x[..area], &i_y[..area]], #[inline(always)] |[i_x, i_y]| [i_x * i_x, i_x * i_y, i_y * i_y]);
            tensor[..3].copy_from_slice(&sums.map(|sum| sum / area as f32));
            tensor[3] = 1.0;
        }
    });
}

/// Gray level and gradient between the four pixels in the middle of 4 × 4, the first of which is `pixel`.
#[inline(always)]
fn sampled([a, b, c, d]: [&[f32]; 4], [x, y]: [f32; 2], pixel: [isize; 2], size: [usize; 2]) -> [f32; 3] {
    let within = |k: usize, at: isize| if at >= 0 && at < size[k] as isize { 1.0 } else { 0.0 };
    let (across, down) = ([1.0 - x, x], [1.0 - y, y]);
    let across_within: [f32; 2] = std::array::from_fn(|k| within(0, pixel[0] + k as isize) * across[k]);
    let down_within: [f32; 2] = std::array::from_fn(|k| within(1, pixel[1] + k as isize) * down[k]);
    let gradient_x = |[a, b, c]: [&[f32]; 3], k: usize| {
        3.0 * ((a[k + 2] - a[k]) + (c[k + 2] - c[k])) + 10.0 * (b[k + 2] - b[k])
    };
    let gradient_y =
        |a: &[f32], c: &[f32], k: usize| 3.0 * ((c[k] - a[k]) + (c[k + 2] - a[k + 2])) + 10.0 * (c[k + 1] - a[k + 1]);
    let mix = |upper: [f32; 2], lower: [f32; 2]| {
        let [upper, lower] = [upper, lower].map(|of| across_within[0] * of[0] + across_within[1] * of[1]);
        0.03125 * (down_within[0] * upper + down_within[1] * lower)
    };
    [
        down[0] * (across[0] * b[1] + across[1] * b[2]) + down[1] * (across[0] * c[1] + across[1] * c[2]),
        mix([0, 1].map(|k| gradient_x([a, b, c], k)), [0, 1].map(|k| gradient_x([b, c, d], k))),
        mix([0, 1].map(|k| gradient_y(a, c, k)), [0, 1].map(|k| gradient_y(b, d, k))),
    ]
}

/// Points of an image: most inside, some near its border and beyond, the last one absent.
pub(super) fn points(size: Size, count: usize) -> Vec<f32> {
    let mut random = Random::new(11);
    let mut points = Vec::new();
    for i in 0..count {
        let mut along = |side: u32| {
            let place = (side as f32 + 12.0) * random.next() - 6.0;
            // Whole places and halves, where the samples' parts are 0.
            if i % 3 == 0 { place.floor() } else { place }
        };
        let (x, y) = (along(size.width), along(size.height));
        points.extend([x, y, if i + 1 < count { 1.0 } else { 0.0 }, 0.0]);
    }
    points[0] = -1e3;
    points
}

fn cases(size: Size) -> Vec<Case> {
    let window = [[7, 5], [21, 21], [2, 10]];
    let all = Fill::NUMBERS.iter().zip(window).zip([1.0, 0.5, 0.25]);
    all.map(|((&fill, [window_width, window_height]), scale)| {
        let params = Params { width: size.width, height: size.height, window_width, window_height, scale };
        let full = Size::new((size.width as f32 / scale) as u32, (size.height as f32 / scale) as u32);
        let (count, samples) = (37, ((window_width * window_height) as usize).next_multiple_of(4));
        Case {
            name: format!("{fill:?}, {window_width}×{window_height}").to_lowercase(),
            params: bytemuck::bytes_of(&params).to_vec(),
            inputs: vec![planes(size, 1, fill, [0.0, 255.0], 7), points(full, count)],
            outputs: vec![3 * samples * count, 4 * count],
            extent: Size::new(samples as u32, count as u32),
        }
    })
    .collect()
}
