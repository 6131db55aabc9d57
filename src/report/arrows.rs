//! Flow as arrows over its image.

use super::draw::{gray, line};
use crate::error::{Error, Result};
use crate::frame::{FlowField, Frame, Image, Size};

/// A colour that stands out from gray images, dark and bright.
const COLOUR: [u8; 3] = [255, 160, 0];
/// The length of a head relative to its arrow, at most [`MAX_HEAD`] pixels.
const HEAD: f64 = 0.3;
const MAX_HEAD: f64 = 6.0;

/// Draws the flow as arrows: the frame in gray as [`PixelFormat::Rgb8`](crate::frame::PixelFormat::Rgb8), with an
/// arrow every `step` pixels in both directions.
///
/// An arrow starts at its pixel and is `gain` times as long as the displacement there. Where the displacement is
/// unknown there is no arrow; where it is shorter than half a pixel after `gain`, a dot.
///
/// # Errors
/// [`Error::Parameter`] for a `step` of 0 or a `gain` that is not a finite number over 0, [`Error::SizeMismatch`] if
/// frame and flow differ in size, and as in [`FlowField::validate`].
pub fn arrows(frame: &Frame<'_>, flow: &FlowField, step: u32, gain: f32) -> Result<Image> {
    flow.validate()?;
    if flow.size != frame.size() {
        return Err(Error::SizeMismatch {
            what: "flow field".to_owned(),
            found: flow.size,
            expected: frame.size(),
        });
    }
    if step == 0 {
        return Err(Error::parameter("step", step, "at least 1 px"));
    }
    if !(gain.is_finite() && gain > 0.0) {
        return Err(Error::parameter("gain", gain, "a finite number over 0"));
    }
    let mut image = gray(frame);
    let Size { width, height } = frame.size();
    for y in (step / 2..height).step_by(step as usize) {
        for x in (step / 2..width).step_by(step as usize) {
            let uv = flow.data[y as usize * width as usize + x as usize];
            if FlowField::is_known(uv) {
                let [u, v] = uv.map(|c| f64::from(c) * f64::from(gain));
                arrow(&mut image, [f64::from(x), f64::from(y)], [u, v]);
            }
        }
    }
    Ok(image)
}

fn arrow(image: &mut Image, from: [f64; 2], [u, v]: [f64; 2]) {
    let length = u.hypot(v);
    if length < 0.5 {
        return line(image, from, from, COLOUR);
    }
    let tip = [from[0] + u, from[1] + v];
    line(image, from, tip, COLOUR);
    let head = (length * HEAD).min(MAX_HEAD);
    let (along, across) = ([u / length, v / length], [-v / length, u / length]);
    for side in [-0.5, 0.5] {
        let end = std::array::from_fn(|i| tip[i] - head * (along[i] + side * across[i]));
        line(image, tip, end, COLOUR);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::{PixelFormat, UNKNOWN_FLOW};

    fn drawn(size: Size, uv: [f32; 2], step: u32, gain: f32) -> Vec<(usize, usize)> {
        let data = vec![40; size.pixels()];
        let frame = Frame::new(size, PixelFormat::Gray8, &data).unwrap();
        let flow = FlowField { size, data: vec![uv; size.pixels()] };
        let image = arrows(&frame, &flow, step, gain).unwrap();
        let width = size.width as usize;
        let pixels = image.data.as_chunks::<3>().0.iter().enumerate();
        assert!(image.data.as_chunks::<3>().0.iter().all(|p| [COLOUR, [40; 3]].contains(p)));
        pixels.filter(|(_, p)| **p == COLOUR).map(|(i, _)| (i % width, i / width)).collect()
    }

    #[test]
    fn an_arrow_reaches_gain_times_the_displacement() {
        let pixels = drawn(Size::new(21, 21), [4.0, 0.0], 20, 2.0);
        assert!(pixels.contains(&(10, 10)) && pixels.contains(&(18, 10)), "{pixels:?}");
        assert!(pixels.iter().all(|&(x, _)| (10..=18).contains(&x)), "{pixels:?}");
    }

    #[test]
    fn no_arrow_where_unknown_and_a_dot_where_still() {
        assert!(drawn(Size::new(9, 9), [UNKNOWN_FLOW; 2], 2, 1.0).is_empty());
        assert_eq!(drawn(Size::new(9, 9), [0.0, 0.0], 8, 1.0), [(4, 4)]);
    }

    #[test]
    fn a_huge_displacement_ends_at_the_border() {
        let pixels = drawn(Size::new(9, 9), [1e9, 0.0], 8, 1e9);
        assert_eq!(pixels, (4..9).map(|x| (x, 4)).collect::<Vec<_>>());
        drawn(Size::new(1, 1), [-1e9, 1e9], 1, f32::MAX);
    }

    #[test]
    fn wrong_settings_are_refused() {
        let size = Size::new(2, 2);
        let frame = Frame::new(size, PixelFormat::Gray8, &[0; 4]).unwrap();
        let flow = FlowField { size, data: vec![[0.0; 2]; 4] };
        assert!(arrows(&frame, &flow, 0, 1.0).is_err());
        assert!(arrows(&frame, &flow, 1, f32::NAN).is_err());
        let other = FlowField { size: Size::new(4, 1), data: vec![[0.0; 2]; 4] };
        assert!(matches!(arrows(&frame, &other, 1, 1.0), Err(Error::SizeMismatch { .. })));
    }
}
