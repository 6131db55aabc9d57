//! Divergence and nearness as colours.

use crate::error::{Error, Result};
use crate::frame::{Image, PixelFormat, Plane};

/// The divergence shown in full colour, 1/s: that of a wall ahead one second before contact.
pub const FULL_DIVERGENCE_HZ: f64 = 2.0;

/// From the lowest to the highest: RdBu of C. Brewer's ColorBrewer (colorbrewer2.org), reversed, with a white centre.
const COLOURS: [[u8; 3]; 11] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [255, 255, 255],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
    [103, 0, 31],
];
/// The colour of unknown values.
const UNKNOWN: [u8; 3] = [128, 128, 128];

/// A plane as colours, an image of [`PixelFormat::Rgb8`]: 0 is white, `full` and above dark red, −`full` and below
/// dark blue, NaN gray.
///
/// # Errors
/// [`Error::Parameter`] for a `full` that is not a finite number over 0; the errors of [`Plane::validate`].
pub fn diverging(plane: &Plane, full: f64) -> Result<Image> {
    plane.validate()?;
    if !(full > 0.0 && full.is_finite()) {
        return Err(Error::parameter("full", full, "a finite number over 0"));
    }
    let data = plane.data.iter().flat_map(|value| colour(f64::from(*value) / full)).collect();
    Ok(Image { size: plane.size, format: PixelFormat::Rgb8, data })
}

/// The colour of a value from −1 to 1.
pub(super) fn colour(share: f64) -> [u8; 3] {
    if share.is_nan() {
        return UNKNOWN;
    }
    let steps = COLOURS.len() - 1;
    let place = (0.5 * (share.clamp(-1.0, 1.0) + 1.0)) * steps as f64;
    let first = (place as usize).min(steps - 1);
    let part = place - first as f64;
    std::array::from_fn(|i| {
        let [low, high] = [first, first + 1].map(|at| f64::from(COLOURS[at][i]));
        (low + part * (high - low)).round() as u8
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::Size;

    fn plane(data: Vec<f32>) -> Plane {
        Plane { size: Size::new(data.len() as u32, 1), data }
    }

    fn colours(data: Vec<f32>, full: f64) -> Vec<[u8; 3]> {
        diverging(&plane(data), full).unwrap().data.as_chunks::<3>().0.to_vec()
    }

    #[test]
    fn zero_is_white_and_what_comes_nearer_is_red() {
        let found = colours(vec![0.0, 4.0, -4.0, 1e9, f32::NEG_INFINITY, f32::NAN, 2.0, 0.4], 4.0);
        let (red, blue) = ([103, 0, 31], [5, 48, 97]);
        // 0.5 lies between two colours, a tenth of the way to the first one.
        let half = [229, 131, 104];
        assert_eq!(found, [[255; 3], red, blue, red, blue, UNKNOWN, half, [254, 237, 227]]);
    }

    #[test]
    fn what_cannot_be_shown_is_refused() {
        for full in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(diverging(&plane(vec![1.0]), full).unwrap_err().to_string().contains("full"));
        }
        assert!(diverging(&Plane { size: Size::new(2, 1), data: vec![0.0] }, 1.0).is_err());
    }
}
