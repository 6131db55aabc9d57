//! The measured divergence beside the true one.

use super::canvas::Canvas;
use super::colours::{DIM, FRAME, TEXT};
use super::divergence::{FULL_DIVERGENCE_HZ, colour, diverging};
use crate::error::{Error, Result};
use crate::frame::{Image, PixelFormat, Size};
use crate::sim::flight::Divergences;

/// The gap between the two images, and the height of the scale below them, in pixels.
const GAP: usize = 8;
const SCALE: usize = 30;

/// Draws the measured divergence beside the true one, with [`FULL_DIVERGENCE_HZ`] in full colour: each cell `side`
/// pixels wide, with a colour scale below.
///
/// # Errors
/// [`Error::Parameter`] for a `side` that is not 1 to 64, or an image above the largest size; [`Error::SizeMismatch`]
/// for planes of different sizes; the errors of [`Plane::validate`](crate::frame::Plane::validate).
pub fn divergence_strip(divergences: &Divergences, side: u32, time_s: f64) -> Result<Image> {
    let Divergences { measured_hz, true_hz } = divergences;
    let cells = measured_hz.size;
    if !(1..=64).contains(&side) {
        return Err(Error::parameter("side", side, "1 to 64"));
    }
    if true_hz.size != cells {
        let what = "true divergence".to_owned();
        return Err(Error::SizeMismatch { what, found: true_hz.size, expected: cells });
    }
    let (side, columns) = (side as usize, cells.width as usize);
    let [panel_width, panel_height] = [columns * side, cells.height as usize * side];
    let size = Size::new((2 * panel_width + GAP) as u32, (panel_height + SCALE) as u32).validate()?;
    let width = size.width as usize;
    let mut image = Image { size, format: PixelFormat::Rgb8, data: FRAME.repeat(size.pixels()) };
    for (plane, left) in [(measured_hz, 0), (true_hz, panel_width + GAP)] {
        let colours = diverging(plane, FULL_DIVERGENCE_HZ)?.data;
        for (y, row) in image.data.chunks_exact_mut(3 * width).take(panel_height).enumerate() {
            for x in 0..panel_width {
                let cell = 3 * (y / side * columns + x / side);
                row[3 * (left + x)..][..3].copy_from_slice(&colours[cell..cell + 3]);
            }
        }
    }
    let bar = [0.25, 0.75].map(|part| (part * width as f64) as usize);
    for row in image.data.chunks_exact_mut(3 * width).skip(panel_height + 4).take(SCALE - 20) {
        for x in bar[0]..bar[1] {
            let share = 2.0 * (x - bar[0]) as f64 / (bar[1] - bar[0]) as f64 - 1.0;
            row[3 * x..][..3].copy_from_slice(&colour(share));
        }
    }
    let mut canvas = Canvas::new(&mut image, [0, 0], [width, size.height as usize]);
    let below = (panel_height + SCALE - 15) as f64;
    canvas.text([4.0, 4.0], "measured", TEXT, 2);
    canvas.text([(panel_width + GAP + 4) as f64, 4.0], "true", TEXT, 2);
    canvas.text([bar[0] as f64, below], &format!("-{FULL_DIVERGENCE_HZ}/s"), DIM, 2);
    canvas.text([0.5 * width as f64 - 4.5, below], "0", DIM, 2);
    canvas.text([bar[1] as f64 - 30.0, below], &format!("+{FULL_DIVERGENCE_HZ}/s"), DIM, 2);
    canvas.text([4.0, below], &format!("{time_s:.2} s"), DIM, 2);
    Ok(image)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::Plane;

    #[test]
    fn a_strip_has_the_measured_beside_the_true_one() {
        let of = |value: f32| Plane { size: Size::new(20, 10), data: vec![value; 200] };
        let strip = divergence_strip(&Divergences { measured_hz: of(9.0), true_hz: of(-9.0) }, 4, 1.5);
        let strip = strip.unwrap();
        assert_eq!(strip.size, Size::new(168, 70));
        let at = |x: usize, y: usize| strip.data[3 * (168 * y + x)..][..3].to_vec();
        assert_eq!((at(79, 39), at(88, 39)), (vec![103, 0, 31], vec![5, 48, 97]));
        assert_eq!((at(84, 20), at(84, 46)), (FRAME.to_vec(), vec![255; 3]));
        let unknown = Divergences { measured_hz: of(0.0), true_hz: of(0.0) };
        assert!(divergence_strip(&unknown, 0, 1.5).is_err());
        assert!(
            divergence_strip(
                &Divergences { true_hz: Plane { size: Size::new(1, 1), data: vec![0.0] }, ..unknown },
                4,
                1.5
            )
            .is_err()
        );
    }
}
