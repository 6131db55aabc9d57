//! Halves an image: smooths it by [1 4 6 4 1]/16 in both directions, mirrored at the border, and keeps every other
//! pixel. Burt and Adelson, The Laplacian pyramid as a compact image code, IEEE Transactions on Communications 1983;
//! OpenCV's `pyrDown`, which rounds levels of 8-bit images to whole gray levels.

use super::parallel_rows::{Split, bands, dimensions, reflect_101, repeat_last};
use super::test_inputs::{Fill, gray_cases};
use crate::frame::Size;
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of both images.
    struct Params {
        /// Pixels in a row of the result, half of the image's, rounded up.
        width: u32,
        /// Rows of the result, half of the image's, rounded up.
        height: u32,
        /// Pixels in a row of the image.
        in_width: u32,
        /// Rows of the image.
        in_height: u32,
        /// 1 to round to whole gray levels.
        whole: u32,
    }
}

kernel!(
    "pyr_down" + ["image"],
    reference(Params; image) -> (half),
    cases: cases,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 8.0 * f32::EPSILON, of_largest: 0.0,
        reason: "sums of 25 positive products in two steps, fused or not; of whole numbers below 2¹⁶ they are exact, and so \
                 is what is rounded",
    },
);

impl Params {
    /// The parameters for an image of this size.
    pub fn new(size: Size, whole: bool) -> Self {
        let Size { width, height } = halved(size);
        Self { width, height, in_width: size.width, in_height: size.height, whole: u32::from(whole) }
    }
}

/// The size of the halved image: both sides are rounded up.
pub fn halved(size: Size) -> Size {
    Size::new(size.width.div_ceil(2), size.height.div_ceil(2))
}

const WEIGHTS: [f32; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];

fn reference(p: &Params, image: &[f32], half: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let (in_width, in_height, in_stride) = dimensions(p.in_width, p.in_height);
    let split = Split { scratch: in_width, dearer: 4, ..Split::rows_of(stride) };
    bands(half, &mut [], split, #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let y = 2 * (band.y0 + i) as isize;
            let row = |k: isize| &image[reflect_101(y + k, in_height) * in_stride..][..in_width];
            let [a, b, c, d, e] = [row(-2), row(-1), row(0), row(1), row(2)];
            for x in 0..in_width {
                band.scratch[x] = a[x] + 4.0 * b[x] + 6.0 * c[x] + 4.0 * d[x] + e[x];
            }
            for (x, out) in out[..width].iter_mut().enumerate() {
                let column = |k: usize| band.scratch[reflect_101((2 * x + k) as isize - 2, in_width)];
                let sum = (0..5).fold(0.0, |sum, k| sum + WEIGHTS[k] * column(k));
                let value = sum * (1.0 / 256.0);
                *out = if p.whole == 1 { (value + 0.5).floor() } else { value };
            }
            repeat_last(out, width);
        }
    });
}

fn cases(size: Size) -> Vec<Case> {
    let half = halved(size);
    let params = Params::new(size, false);
    let mut cases = gray_cases(size, Fill::ALL, bytemuck::bytes_of(&params), &[], &[half.stride()], half);
    // Gray levels of 8 bits, which have whole sums.
    let whole = cases.iter().take(3).map(|case| Case {
        name: format!("{}, whole", case.name),
        params: bytemuck::bytes_of(&Params::new(size, true)).to_vec(),
        inputs: vec![case.inputs[0].iter().map(|value| (value / 257.0).round()).collect()],
        ..case.clone()
    });
    let whole: Vec<Case> = whole.collect();
    cases.extend(whole);
    cases
}
