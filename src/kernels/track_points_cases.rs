//! The cases of [`track_points`](super::track_points): windows of one image, to be found in another one.

use super::patches;
use super::test_inputs::{Fill, planes};
use super::track_points::Params;
use crate::frame::Size;
use crate::kernel::Case;
use crate::plan::pack;

/// The points of a case.
const POINTS: usize = 37;

pub(super) fn cases(size: Size) -> Vec<Case> {
    let moved = |shift: [f32; 2]| texture(size, shift);
    let random = |seed: u32| planes(size, 1, Fill::Textured, [0.0, 255.0], seed);
    // Name, images, window, scale, iterations, on the full image.
    let all = [
        ("a texture that moves", [moved([0.0; 2]), moved([1.3, -0.7])], [21, 21], 1.0, 10, 1),
        ("the same on a coarse level", [moved([0.0; 2]), moved([-0.6, 0.9])], [9, 6], 0.5, 10, 0),
        ("one step", [moved([0.0; 2]), moved([2.0, 1.0])], [13, 15], 1.0, 1, 1),
        ("random images, one step", [random(5), random(6)], [7, 7], 1.0, 1, 1),
        ("random images", [random(5), random(6)], [7, 7], 1.0, 3, 1),
        ("no texture", [planes(size, 1, Fill::Flat, [0.0, 255.0], 1), random(6)], [7, 5], 1.0, 3, 1),
    ];
    let case = |(name, [first, second], window, scale, iterations, finest): (
        &str,
        [Vec<f32>; 2],
        [u32; 2],
        f32,
        u32,
        u32,
    )| {
        let [window_width, window_height] = window;
        let full = Size::new((size.width as f32 / scale) as u32, (size.height as f32 / scale) as u32);
        let points = patches::points(full, POINTS);
        let samples = ((window_width * window_height) as usize).next_multiple_of(4);
        let [mut patches, mut tensors] = [vec![0.0; 3 * samples * POINTS], vec![0.0; 4 * POINTS]];
        let params =
            patches::Params { width: size.width, height: size.height, window_width, window_height, scale };
        let outputs = &mut [patches.as_mut_slice(), tensors.as_mut_slice()];
        (patches::KERNEL.reference)(bytemuck::bytes_of(&params), &[&first, &points], outputs);
        let params = Params {
            width: size.width,
            height: size.height,
            window_width,
            window_height,
            scale,
            iterations,
            // Small enough for steps to and fro to come first.
            epsilon: if iterations == 10 { 1e-6 } else { 1e-4 },
            min_eigenvalue: 0.1,
            min_determinant: 1e-6,
            finest,
        };
        Case {
            name: name.to_owned(),
            params: bytemuck::bytes_of(&params).to_vec(),
            inputs: vec![second, patches, tensors, points],
            outputs: vec![4 * POINTS],
            extent: Size::new(4, POINTS as u32),
        }
    };
    all.into_iter().map(case).collect()
}

/// Waves along different directions, moved by a displacement in pixels.
fn texture(size: Size, [u, v]: [f32; 2]) -> Vec<f32> {
    const WAVES: [[f32; 3]; 5] =
        [[0.31, 0.12, 0.4], [-0.17, 0.43, 1.9], [0.52, -0.36, 0.8], [0.07, 0.21, 2.6], [-0.62, -0.28, 0.1]];
    pack::padded_groups(size, |x, y| {
        let (x, y) = (x as f32 - u, y as f32 - v);
        [WAVES.iter().fold(128.0, |sum, [a, b, phase]| sum + 22.0 * (a * x + b * y + phase).sin())]
    })
}
