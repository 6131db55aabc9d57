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
    let [pixels, block] = [3, 1].map(|more| ((p.window_width + more) * (p.window_height + more)) as usize);
    let scratch = pixels + 3 * block;
    let split = Split { second_row: 4, scratch, dearer: 8, fewest_rows: 4, ..Split::rows_of(3 * padded) };
    bands(patches, tensors, split, #[inline(always)] |band| {
        let Band { y0, out, second, scratch, .. } = band;
        let (pixels, blocks) = scratch.split_at_mut(pixels);
        for (i, (patch, tensor)) in out.chunks_exact_mut(3 * padded).zip(second.chunks_exact_mut(4)).enumerate() {
            let point = &points[4 * (y0 + i)..][..4];
            let place = [0, 1].map(|k| point[k] * p.scale - 0.5 * (window[k] as f32 - 1.0));
            patch.fill(0.0);
            tensor.fill(0.0);
            let Some(window) = Window::at(place, window, [width, height]).filter(|_| point[2] > 0.0) else { continue };
            window.pixels(image, [width, height, stride], 1, pixels);
            gradients(&window, pixels, [width, height], blocks);
            for (block, channel) in blocks.chunks_exact(block).zip(patch.chunks_exact_mut(padded)) {
                window.sample(block, &mut channel[..area]);
                let last = channel[area - 1];
                channel[area..].fill(last);
            }
            let [i_x, i_y] = [1, 2].map(|k| &patch[k * padded..][..area]);
            let sums = lane_sums([i_x, i_y], #[inline(always)] |[i_x, i_y]| [i_x * i_x, i_x * i_y, i_y * i_y]);
            tensor[..3].copy_from_slice(&sums.map(|sum| sum / area as f32));
            tensor[3] = 1.0;
        }
    });
}

/// Gray level and gradient of the pixels that a window's samples lie between, from those and one more on every side. There
/// is no gradient outside an image of this width and height.
#[inline(always)]
fn gradients(window: &Window, pixels: &[f32], [width, height]: [usize; 2], blocks: &mut [f32]) {
    let [columns, rows] = [window.columns + 1, window.rows + 1];
    let (gray, rest) = blocks.split_at_mut(columns * rows);
    let (i_x, i_y) = rest.split_at_mut(columns * rows);
    let within = |at: isize, side: usize| at >= 0 && at < side as isize;
    for row in 0..rows {
        let [a, b, c]: [&[f32]; 3] = std::array::from_fn(|j| &pixels[(row + j) * (columns + 2)..][..columns + 2]);
        let [gray, i_x, i_y] = [&mut *gray, &mut *i_x, &mut *i_y].map(|block| &mut block[row * columns..][..columns]);
        gray.copy_from_slice(&b[1..=columns]);
        if !within(window.corner[1] + row as isize, height) {
            [i_x, i_y].into_iter().for_each(|row| row.fill(0.0));
            continue;
        }
        for x in 0..columns {
            i_x[x] = 0.03125 * (3.0 * ((a[x + 2] - a[x]) + (c[x + 2] - c[x])) + 10.0 * (b[x + 2] - b[x]));
            i_y[x] = 0.03125 * (3.0 * ((c[x] - a[x]) + (c[x + 2] - a[x + 2])) + 10.0 * (c[x + 1] - a[x + 1]));
        }
        for x in (0..columns).filter(|x| !within(window.corner[0] + *x as isize, width)) {
            (i_x[x], i_y[x]) = (0.0, 0.0);
        }
    }
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
