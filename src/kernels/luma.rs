//! Brightness of a frame's pixels, as `f32`.
//!
//! White is 255 in every format, and 16-bit samples keep their fractions, because the constants of the equations (the
//! 10⁻³ beside the determinant, the noise of the confidence) are in those gray levels.

use super::parallel_rows::{Split, bands, dimensions, repeat_last};
use crate::frame::{PixelFormat, Size};
use crate::kernel::{Case, Tolerance, kernel, params};

params! {
    /// Shape of the frame.
    struct Params {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// `u32` words from one row to the next.
        row_words: u32,
        /// 0 gray8, 1 gray16, 2 rgb8, 3 rgba8.
        format: u32,
    }
}

kernel!(
    "luma" + ["image"],
    reference(Params; frame) -> (gray),
    cases: cases,
    tolerance: Tolerance { absolute: 0.0, relative: 0.0, of_largest: 0.0, reason: "whole numbers below 2¹⁶ on both sides, and one rounded product" },
);

impl Params {
    /// The parameters for a frame of this size and format.
    pub fn new(size: Size, format: PixelFormat) -> Self {
        let code = match format {
            PixelFormat::Gray8 => 0,
            PixelFormat::Gray16 => 1,
            PixelFormat::Rgb8 => 2,
            PixelFormat::Rgba8 => 3,
        };
        Self { width: size.width, height: size.height, row_words: format.row_words(size.width) as u32, format: code }
    }
}

/// A 16-bit sample's unit in gray levels.
const WIDE: f32 = 1.0 / 257.0;

fn reference(p: &Params, frame: &[f32], gray: &mut [f32]) {
    let (width, _, stride) = dimensions(p.width, p.height);
    let bytes: &[u8] = bytemuck::cast_slice(frame);
    let row_bytes = 4 * p.row_words as usize;
    bands(gray, &mut [], Split::rows_of(stride), #[inline(always)] |band| {
        for (i, out) in band.out.chunks_exact_mut(stride).enumerate() {
            let row = &bytes[(band.y0 + i) * row_bytes..][..row_bytes];
            match p.format {
                0 => convert(&mut out[..width], row, |[v]: [u8; 1]| v as f32),
                1 => convert(&mut out[..width], row, |v| u16::from_ne_bytes(v) as f32 * WIDE),
                2 => convert(&mut out[..width], row, |[r, g, b]| luma(r, g, b)),
                _ => convert(&mut out[..width], row, |[r, g, b, _]| luma(r, g, b)),
            }
            repeat_last(out, width);
        }
    });
}

#[inline(always)]
fn convert<const N: usize>(out: &mut [f32], row: &[u8], value: impl Fn([u8; N]) -> f32) {
    for (o, bytes) in out.iter_mut().zip(row.as_chunks::<N>().0) {
        *o = value(*bytes);
    }
}

/// ITU-R BT.601 weights of 0.299, 0.587, 0.114 in 2⁻¹⁵, rounded to whole gray levels.
#[inline(always)]
fn luma(r: u8, g: u8, b: u8) -> f32 {
    ((9798 * r as u32 + 19235 * g as u32 + 3735 * b as u32 + 16384) >> 15) as f32
}

fn cases(size: Size) -> Vec<Case> {
    [PixelFormat::Gray8, PixelFormat::Gray16, PixelFormat::Rgb8, PixelFormat::Rgba8]
        .into_iter()
        .map(|format| {
            let words = format.row_words(size.width) * size.height as usize;
            let mut state = 1u32;
            let frame = (0..words)
                .map(|_| {
                    state = state.wrapping_mul(0x9e37_79b1).wrapping_add(0x7f4a_7c15);
                    f32::from_bits(state ^ (state >> 15))
                })
                .collect();
            Case {
                name: format.to_string(),
                params: bytemuck::bytes_of(&Params::new(size, format)).to_vec(),
                inputs: vec![frame],
                outputs: vec![size.stride() * size.height as usize],
                extent: size,
            }
        })
        .collect()
}
