//! Gray images to draw on, and lines.

use crate::frame::{Frame, Image, PixelFormat, Size};

/// The frame's luma, one byte per pixel, row by row.
pub(super) fn luma(frame: &Frame<'_>) -> Vec<u8> {
    let size = frame.size();
    let mut data = Vec::with_capacity(size.pixels());
    for y in 0..size.height {
        data.extend(frame.row(y).chunks_exact(frame.format().bytes()).map(|pixel| match *pixel {
            [gray] => gray,
            [low, high] => (u16::from_ne_bytes([low, high]) >> 8) as u8,
            // BT.601, in 1/256.
            [r, g, b, ..] => ((77 * u32::from(r) + 150 * u32::from(g) + 29 * u32::from(b)) >> 8) as u8,
            [] => 0,
        }));
    }
    data
}

/// The frame in gray as [`PixelFormat::Rgb8`].
pub(super) fn gray(frame: &Frame<'_>) -> Image {
    let data = luma(frame).into_iter().flat_map(|gray| [gray; 3]).collect();
    Image { size: frame.size(), format: PixelFormat::Rgb8, data }
}

/// Draws a line in an image of [`PixelFormat::Rgb8`], clipped to it.
pub(super) fn line(image: &mut Image, from: [f64; 2], to: [f64; 2], colour: [u8; 3]) {
    let Some([from, to]) = clip(image.size, from, to) else { return };
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let steps = dx.abs().max(dy.abs()).ceil().max(1.0);
    for i in 0..=steps as u32 {
        let part = f64::from(i) / steps;
        let (x, y) = ((from[0] + part * dx).round() as usize, (from[1] + part * dy).round() as usize);
        let at = 3 * (y * image.size.width as usize + x);
        if let Some(pixel) = image.data.get_mut(at..at + 3) {
            pixel.copy_from_slice(&colour);
        }
    }
}

/// Clips a line to the image (Liang and Barsky 1984). Without it, a displacement of a million pixels would be drawn
/// pixel by pixel.
fn clip(size: Size, from: [f64; 2], to: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let most = [f64::from(size.width - 1), f64::from(size.height - 1)];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for i in 0..2 {
        let slope = to[i] - from[i];
        for (p, q) in [(-slope, from[i]), (slope, most[i] - from[i])] {
            if p == 0.0 && q < 0.0 {
                return None;
            }
            if p < 0.0 {
                enter = enter.max(q / p);
            } else if p > 0.0 {
                leave = leave.min(q / p);
            }
        }
    }
    if enter > leave {
        return None;
    }
    // Rounding can leave the image slightly.
    let at = |part: f64| std::array::from_fn(|i| (from[i] + part * (to[i] - from[i])).clamp(0.0, most[i]));
    Some([at(enter), at(leave)])
}
