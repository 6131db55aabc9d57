//! Flow as colour: the wheel of Baker et al., "A Database and Evaluation Methodology for Optical Flow", IJCV 92 (2011),
//! as in their `colorcode.cpp`. The hue is the direction, the saturation the length.

use crate::error::{Error, Result};
use crate::frame::{FlowField, Image, PixelFormat};

const COLOURS: usize = 55;
/// The wheel's sections: steps from red to yellow, yellow to green, green to cyan, cyan to blue, blue to magenta and
/// magenta to red, chosen so that the steps look alike.
const STEPS: [usize; 6] = [15, 6, 4, 11, 13, 6];
const CORNERS: [[usize; 3]; 7] =
    [[255, 0, 0], [255, 255, 0], [0, 255, 0], [0, 255, 255], [0, 0, 255], [255, 0, 255], [255, 0, 0]];

/// Draws a flow field as colours: an image of [`PixelFormat::Rgb8`], and the length in pixels shown in full colour.
///
/// No motion is white, `scale` pixels are fully saturated, longer displacements are darkened, and unknown ones are
/// black. Without a `scale`, the largest known length is used (1 px if nothing moves).
///
/// # Errors
/// [`Error::Parameter`] for a `scale` that is not a finite number over 0; [`Error::Parameter`] or [`Error::Length`]
/// if size and data contradict each other.
pub fn colour_wheel(flow: &FlowField, scale: Option<f32>) -> Result<(Image, f32)> {
    flow.validate()?;
    let scale = match scale {
        Some(scale) if scale.is_finite() && scale > 0.0 => scale,
        Some(scale) => return Err(Error::parameter("scale", scale, "a finite length over 0 px")),
        None => largest(flow),
    };
    let wheel = wheel();
    let data = flow.data.iter().flat_map(|&uv| colour(&wheel, uv, scale)).collect();
    Ok((Image { size: flow.size, format: PixelFormat::Rgb8, data }, scale))
}

fn largest(flow: &FlowField) -> f32 {
    let known = flow.data.iter().filter(|&&uv| FlowField::is_known(uv));
    let longest = known.map(|&[u, v]| u.hypot(v)).fold(0.0, f32::max);
    if longest > 0.0 { longest } else { 1.0 }
}

fn wheel() -> [[f32; 3]; COLOURS] {
    let mut wheel = [[0.0; 3]; COLOURS];
    let mut k = 0;
    for (part, &steps) in STEPS.iter().enumerate() {
        let (from, to) = (CORNERS[part], CORNERS[part + 1]);
        for i in 0..steps {
            for channel in 0..3 {
                // Integer division first, as in the original, which drops the remainder.
                let rise = 255 * i / steps;
                let value = match (from[channel], to[channel]) {
                    (0, 255) => rise,
                    (255, 0) => 255 - rise,
                    (same, _) => same,
                };
                wheel[k][channel] = value as f32 / 255.0;
            }
            k += 1;
        }
    }
    wheel
}

fn colour(wheel: &[[f32; 3]; COLOURS], [u, v]: [f32; 2], scale: f32) -> [u8; 3] {
    if !FlowField::is_known([u, v]) {
        return [0; 3];
    }
    let (u, v) = (u / scale, v / scale);
    let length = u.hypot(v);
    let angle = (-v).atan2(-u) / std::f32::consts::PI;
    let place = (angle + 1.0) / 2.0 * (COLOURS - 1) as f32;
    let first = (place as usize).min(COLOURS - 1);
    let second = (first + 1) % COLOURS;
    let part = place - first as f32;
    std::array::from_fn(|channel| {
        let hue = (1.0 - part) * wheel[first][channel] + part * wheel[second][channel];
        let shown = if length <= 1.0 { 1.0 - length * (1.0 - hue) } else { hue * 0.75 };
        (255.0 * shown) as u8
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::{Size, UNKNOWN_FLOW};

    fn show(data: Vec<[f32; 2]>, scale: Option<f32>) -> (Vec<[u8; 3]>, f32) {
        let flow = FlowField { size: Size::new(data.len() as u32, 1), data };
        let (image, scale) = colour_wheel(&flow, scale).unwrap();
        (image.data.as_chunks::<3>().0.to_vec(), scale)
    }

    #[test]
    fn the_wheel_has_55_colours_and_begins_with_red() {
        let wheel = wheel();
        assert_eq!(STEPS.iter().sum::<usize>(), COLOURS);
        assert_eq!(wheel[0], [1.0, 0.0, 0.0]);
        assert_eq!(wheel[1].map(|c| (c * 255.0).round()), [255.0, 17.0, 0.0]);
        assert_eq!(wheel[15], [1.0, 1.0, 0.0]);
        assert_eq!(wheel[54].map(|c| (c * 255.0).round()), [255.0, 0.0, 43.0]);
    }

    /// Right is red, down is yellow, left is cyan to blue, up is violet, as in the paper's key.
    #[test]
    fn directions_have_the_colours_of_the_paper() {
        let (colours, scale) = show(vec![[2.0, 0.0], [0.0, 2.0], [-2.0, 0.0], [0.0, -2.0], [0.0; 2]], None);
        assert_eq!(scale, 2.0);
        let [right, down, left, up, still] = colours[..] else { panic!("{colours:?}") };
        assert!(right[0] == 255 && right[1] < 20 && right[2] < 60, "right {right:?}");
        assert!(down[0] > 200 && down[1] > 200 && down[2] < 50, "down {down:?}");
        assert!(left[0] < 20 && left[1] > 150 && left[2] > 200, "left {left:?}");
        assert!(up[0] > 80 && up[1] < 50 && up[2] > 200, "up {up:?}");
        assert_eq!(still, [255; 3]);
    }

    #[test]
    fn unknown_is_black_and_does_not_set_the_scale() {
        let (colours, scale) = show(vec![[UNKNOWN_FLOW; 2], [f32::NAN, 0.0], [0.0, 3.0]], None);
        assert_eq!((colours[0], colours[1], scale), ([0; 3], [0; 3], 3.0));
    }

    #[test]
    fn longer_than_the_scale_is_darker() {
        let (colours, _) = show(vec![[1.0, 0.0], [1.5, 0.0]], Some(1.0));
        assert_eq!((colours[0][0], colours[1][0]), (255, 191));
    }

    #[test]
    fn a_scale_that_cannot_divide_is_refused() {
        let flow = FlowField { size: Size::new(1, 1), data: vec![[0.0; 2]] };
        for scale in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(colour_wheel(&flow, Some(scale)).is_err(), "{scale}");
        }
    }
}
