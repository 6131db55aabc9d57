//! The endpoint error as colours.

use crate::error::Result;
use crate::frame::{FlowField, Image, PixelFormat};

/// The colours of errors, each with the error in pixels from which the next one begins: RdYlBu of C. Brewer's ColorBrewer
/// (colorbrewer2.org), reversed; blue is good (under ½ px) and yellow to red bad.
pub const ERROR_COLOURS: [(f64, [u8; 3]); 10] = [
    (0.0625, [49, 54, 149]),
    (0.125, [69, 117, 180]),
    (0.25, [116, 173, 209]),
    (0.5, [171, 217, 233]),
    (1.0, [255, 255, 191]),
    (2.0, [254, 224, 144]),
    (4.0, [253, 174, 97]),
    (8.0, [244, 109, 67]),
    (16.0, [215, 48, 39]),
    (f64::INFINITY, [165, 0, 38]),
];
/// The colour of pixels whose truth is unknown.
const UNKNOWN: [u8; 3] = [128, 128, 128];
/// The colour of pixels that the estimate does not know, but the truth does.
const MISSING: [u8; 3] = [0, 0, 0];

/// The endpoint error of an estimate as an image of [`PixelFormat::Rgb8`], in the fixed steps of [`ERROR_COLOURS`]. Gray is
/// unknown in the truth, black unknown in the estimate alone.
///
/// # Errors
/// As in [`endpoint_error`](crate::eval::endpoint_error).
pub fn error_map(truth: &FlowField, estimate: &FlowField) -> Result<Image> {
    let error = crate::eval::endpoint_error(truth, estimate)?;
    let colour = |(error, uv): (&f32, &[f32; 2])| match f64::from(*error) {
        _ if !FlowField::is_known(*uv) => UNKNOWN,
        error if error.is_nan() => MISSING,
        error => ERROR_COLOURS
            .iter()
            .find(|(next, _)| error < *next)
            .map_or(ERROR_COLOURS[9].1, |(_, colour)| *colour),
    };
    let data = error.data.iter().zip(&truth.data).flat_map(colour).collect();
    Ok(Image { size: error.size, format: PixelFormat::Rgb8, data })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::{Size, UNKNOWN_FLOW};

    #[test]
    fn each_step_has_its_colour() {
        let errors = [0.0, 0.0625, 0.49, 0.5, 15.9, 16.0, 1e6];
        let size = Size::new(9, 1);
        let mut truth = FlowField { size, data: vec![[0.0; 2]; 9] };
        let mut estimate = FlowField { size, data: errors.iter().map(|px| [*px, 0.0]).collect() };
        estimate.data.extend([[f32::NAN; 2], [0.0; 2]]);
        truth.data[8] = [UNKNOWN_FLOW; 2];
        let found = error_map(&truth, &estimate).unwrap();
        let steps = [0, 1, 3, 4, 8, 9, 9].map(|step: usize| ERROR_COLOURS[step].1);
        assert_eq!(found.data.as_chunks::<3>().0, [&steps[..], &[MISSING, UNKNOWN]].concat());
    }
}
