//! Where an image has texture.

use crate::frame::{Frame, PixelFormat};

/// The root mean square gradient, gray levels per pixel, under which an image is flat. Sensor noise of two gray levels
/// alone has two.
const FLAT: f32 = 3.0;
/// The radius of the square over which it is taken, in pixels.
const RADIUS: usize = 3;

/// Whether each pixel has texture: the root mean square of the gradient (central differences) over 7 × 7 pixels is not
/// under [`FLAT`].
pub(super) fn textured(frame: &Frame<'_>) -> Vec<bool> {
    let (width, height) = (frame.size().width as usize, frame.size().height as usize);
    let gray = gray_levels(frame);
    let at = |x: usize, y: usize| gray[y.min(height - 1) * width + x.min(width - 1)];
    let slope = |i: usize| {
        let (x, y) = (i % width, i / width);
        let across = 0.5 * (at(x + 1, y) - at(x.saturating_sub(1), y));
        let down = 0.5 * (at(x, y + 1) - at(x, y.saturating_sub(1)));
        across * across + down * down
    };
    let squares: Vec<f32> = (0..gray.len()).map(slope).collect();
    let mean = |values: &[f32], place: usize, count: usize, step: usize, i: usize| {
        let [low, high] = [place.saturating_sub(RADIUS), (place + RADIUS).min(count - 1)];
        let sum: f32 = (low..=high).map(|other| values[i + other * step - place * step]).sum();
        sum / (high - low + 1) as f32
    };
    let rows: Vec<f32> = (0..gray.len()).map(|i| mean(&squares, i % width, width, 1, i)).collect();
    (0..gray.len()).map(|i| mean(&rows, i / width, height, width, i) >= FLAT * FLAT).collect()
}

/// Gray levels, 0 to 255, with the weights of red, green and blue of ITU-R BT.601.
pub(crate) fn gray_levels(frame: &Frame<'_>) -> Vec<f32> {
    let format = frame.format();
    let gray = |pixel: &[u8]| match format {
        PixelFormat::Gray8 => f32::from(pixel[0]),
        PixelFormat::Gray16 => f32::from(u16::from_ne_bytes([pixel[0], pixel[1]])) / 257.0,
        PixelFormat::Rgb8 | PixelFormat::Rgba8 => {
            0.299 * f32::from(pixel[0]) + 0.587 * f32::from(pixel[1]) + 0.114 * f32::from(pixel[2])
        }
    };
    (0..frame.size().height).flat_map(|y| frame.row(y).chunks_exact(format.bytes()).map(gray)).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::Size;

    #[test]
    fn a_ramp_is_textured_from_its_slope_on() {
        for (slope, expected) in [(2_u8, false), (4, true)] {
            for down in [false, true] {
                let pixels = (0..20 * 20)
                    .map(|i| slope * if down { i / 20 } else { i % 20 } as u8)
                    .collect::<Vec<_>>();
                let frame = Frame::new(Size::new(20, 20), PixelFormat::Gray8, &pixels).unwrap();
                let found = textured(&frame);
                let inside = |i: usize| (5..15).contains(&(i % 20)) && (5..15).contains(&(i / 20));
                assert!((0..400).filter(|i| inside(*i)).all(|i| found[i] == expected), "{slope} {down}");
            }
        }
    }

    #[test]
    fn every_format_has_the_same_gray_levels() {
        let wide: Vec<u8> = 25700_u16.to_ne_bytes().to_vec();
        for (format, data) in [
            (PixelFormat::Gray8, vec![100]),
            (PixelFormat::Gray16, wide),
            (PixelFormat::Rgb8, vec![100; 3]),
            (PixelFormat::Rgba8, vec![100, 100, 100, 0]),
        ] {
            let levels = gray_levels(&Frame::new(Size::new(1, 1), format, &data).unwrap());
            assert!((levels[0] - 100.0).abs() < 1e-4, "{format}: {levels:?}");
        }
    }
}
