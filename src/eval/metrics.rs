//! Errors of a flow field against the ground truth, as in Baker et al., "A Database and Evaluation Methodology for
//! Optical Flow", IJCV 92 (2011), section 4.

use super::Tally;
use crate::error::{Error, Result};
use crate::frame::{FlowField, Plane, Size};

/// The errors of an estimated flow field.
///
/// All but [`FlowError::density`] are over the pixels known in both fields and inside the mask. If there are none,
/// they are NaN, so that no bound on them holds by accident. Standard deviations divide by the number of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowError {
    /// Mean endpoint error: the length of the difference, px.
    pub aee_px: f64,
    /// Standard deviation of the endpoint error, px.
    pub aee_std: f64,
    /// Mean angular error: the angle between (u, v, 1) of the truth and of the estimate, degrees.
    pub aae_deg: f64,
    /// Standard deviation of the angular error, degrees.
    pub aae_std_deg: f64,
    /// Root of the mean square endpoint error, px.
    pub rmse_px: f64,
    /// Share of pixels whose endpoint error is over 1 px, 0 to 1.
    pub r1: f64,
    /// Share of pixels whose endpoint error is over 3 px, 0 to 1.
    pub r3: f64,
    /// Pixels known in both, as a share of those known in the truth, 0 to 1; NaN if the truth knows none.
    pub density: f64,
    /// Pixels compared.
    pub pixels: usize,
}

/// Compares an estimated flow field with the ground truth.
///
/// A displacement is unknown if it is NaN or over 1e9 in magnitude ([`FlowField::is_known`]). Pixels unknown in the
/// ground truth, and those where the mask is not over 0.5, are left out; pixels unknown in the estimate lower the
/// density.
///
/// # Errors
/// [`Error::SizeMismatch`] if the sizes differ, and as in [`FlowField::validate`] and [`Plane::validate`].
pub fn flow_error(truth: &FlowField, estimate: &FlowField, mask: Option<&Plane>) -> Result<FlowError> {
    check(truth, estimate)?;
    if let Some(mask) = mask {
        mask.validate()?;
        check_size("mask", mask.size, truth.size)?;
    }
    let mut tally = Tally::default();
    for (i, (&a, &b)) in truth.data.iter().zip(&estimate.data).enumerate() {
        if FlowField::is_known(a) && mask.is_none_or(|mask| mask.data[i] > 0.5) {
            tally.add(a, b);
        }
    }
    Ok(tally.error())
}

/// The endpoint error of every pixel, px; NaN where either field is unknown.
///
/// # Errors
/// [`Error::SizeMismatch`] if the sizes differ, and as in [`FlowField::validate`].
pub fn endpoint_error(a: &FlowField, b: &FlowField) -> Result<Plane> {
    check(a, b)?;
    let error = |(&a, &b): (&[f32; 2], &[f32; 2])| {
        let known = FlowField::is_known(a) && FlowField::is_known(b);
        if known { distance(a, b) as f32 } else { f32::NAN }
    };
    Ok(Plane { size: a.size, data: a.data.iter().zip(&b.data).map(error).collect() })
}

/// The angle between (u, v, 1) of two displacements `[u, v]` in pixels, in degrees from 0 to 180.
///
/// The usual arc cosine of the scalar product loses all digits for small angles; the arc tangent of vector product
/// over scalar product loses none.
pub fn angular_error_deg(a: [f32; 2], b: [f32; 2]) -> f64 {
    let ([u, v], [s, t]) = (a.map(f64::from), b.map(f64::from));
    let cross = (v - t).hypot(s - u).hypot(u * t - v * s);
    cross.atan2(u * s + v * t + 1.0).to_degrees()
}

/// The endpoint error, px.
pub(super) fn distance(a: [f32; 2], b: [f32; 2]) -> f64 {
    (f64::from(a[0]) - f64::from(b[0])).hypot(f64::from(a[1]) - f64::from(b[1]))
}

pub(super) fn check(a: &FlowField, b: &FlowField) -> Result<()> {
    a.validate()?;
    b.validate()?;
    check_size("flow field", b.size, a.size)
}

pub(super) fn check_size(what: &str, found: Size, expected: Size) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    Err(Error::SizeMismatch { what: what.to_owned(), found, expected })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::UNKNOWN_FLOW;

    fn row(data: Vec<[f32; 2]>) -> FlowField {
        FlowField { size: Size::new(data.len() as u32, 1), data }
    }

    #[track_caller]
    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() <= 1e-9, "{found} against {expected}");
    }

    #[test]
    fn figures_worked_out_by_hand() {
        let truth = row(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [2.0, 2.0]]);
        let estimate = row(vec![[3.0, 4.0], [0.0, 0.0], [0.0, 2.0], [2.0, 2.0]]);
        let e = flow_error(&truth, &estimate, None).unwrap();
        // Endpoint errors 5, 1, 2, 0.
        close(e.aee_px, 2.0);
        close(e.aee_std, 3.5_f64.sqrt());
        close(e.rmse_px, 7.5_f64.sqrt());
        // Exactly 1 px is not over 1 px.
        close(e.r1, 0.5);
        close(e.r3, 0.25);
        let angles = [5_f64.atan().to_degrees(), 45.0, 2_f64.atan().to_degrees(), 0.0];
        let mean = angles.iter().sum::<f64>() / 4.0;
        close(e.aae_deg, mean);
        close(e.aae_std_deg, (angles.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / 4.0).sqrt());
        assert_eq!((e.density, e.pixels), (1.0, 4));
    }

    #[test]
    fn unknown_in_the_truth_is_left_out_and_in_the_estimate_lowers_the_density() {
        let truth = row(vec![[UNKNOWN_FLOW; 2], [f32::NAN, 0.0], [1.0, 1.0], [1.0, 1.0], [0.0; 2]]);
        let estimate = row(vec![[0.0; 2], [0.0; 2], [0.0, f32::NAN], [UNKNOWN_FLOW; 2], [0.0, 3.5]]);
        let e = flow_error(&truth, &estimate, None).unwrap();
        assert_eq!((e.pixels, e.aee_px, e.r3), (1, 3.5, 1.0));
        close(e.density, 1.0 / 3.0);
        let error = endpoint_error(&truth, &estimate).unwrap();
        assert!(error.data[..4].iter().all(|e| e.is_nan()));
        assert_eq!(error.data[4], 3.5);
    }

    #[test]
    fn the_mask_takes_what_is_over_a_half() {
        let (truth, estimate) = (row(vec![[0.0; 2]; 3]), row(vec![[1.0, 0.0], [2.0, 0.0], [4.0, 0.0]]));
        let mask = Plane { size: truth.size, data: vec![0.5, 1.0, f32::NAN] };
        let e = flow_error(&truth, &estimate, Some(&mask)).unwrap();
        assert_eq!((e.pixels, e.aee_px, e.density), (1, 2.0, 1.0));
    }

    #[test]
    fn nothing_to_compare_is_nan_and_passes_no_bound() {
        let (truth, estimate) = (row(vec![[0.0; 2]; 2]), row(vec![[f32::NAN; 2]; 2]));
        let e = flow_error(&truth, &estimate, None).unwrap();
        for figure in [e.aee_px, e.aee_std, e.aae_deg, e.aae_std_deg, e.rmse_px, e.r1, e.r3] {
            assert!(figure.is_nan());
        }
        assert_eq!((e.density, e.pixels), (0.0, 0));
        assert!(flow_error(&estimate, &truth, None).unwrap().density.is_nan());
    }

    #[test]
    fn small_and_large_angles_keep_their_digits() {
        close(angular_error_deg([0.0; 2], [1e-9, 0.0]) * 1e9, 1_f64.to_degrees() * f64::from(1e-9_f32) * 1e9);
        close(angular_error_deg([3.0, -2.0], [3.0, -2.0]), 0.0);
        close(angular_error_deg([1.0, 0.0], [-1.0, 0.0]), 90.0);
        assert!(angular_error_deg([1e9, 0.0], [-1e9, 0.0]) > 179.99);
    }

    #[test]
    fn sizes_must_agree() {
        let (a, b) = (row(vec![[0.0; 2]; 2]), row(vec![[0.0; 2]; 3]));
        assert!(matches!(flow_error(&a, &b, None), Err(Error::SizeMismatch { .. })));
        assert!(matches!(endpoint_error(&a, &b), Err(Error::SizeMismatch { .. })));
        let mask = Plane { size: b.size, data: vec![1.0; 3] };
        let text = flow_error(&a, &a, Some(&mask)).unwrap_err().to_string();
        assert_eq!(text, "mask is 3×1, expected 2×1");
    }
}
