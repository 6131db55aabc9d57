//! The lens: Brown's model with the rational extension, and its inverse.

use super::injectivity;
use crate::error::{Error, Result};

/// The accepted residual of an inverse, mapped forward again, relative to 1 + the distance from the axis. At a focal
/// length of 1000 pixels it is 10⁻⁹ px; rounding alone is a thousandth of it.
const RESIDUAL: f64 = 1e-12;
/// The most steps. Newton's method squares the error with each; one that needs more is not converging.
const MAX_STEPS: usize = 40;
/// The most times a step that does not reduce the residual is halved.
const MAX_HALVINGS: usize = 40;

/// Lens distortion: where a lens shows the points of an ideal pinhole (Brown 1971, with OpenCV's rational radial
/// factor).
///
/// With x = X/Z, y = Y/Z and r² = x² + y²:
///
/// q = (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶),
/// x′ = x q + 2 p1 x y + p2 (r² + 2x²), y′ = y q + p1 (r² + 2y²) + 2 p2 x y.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Lens {
    /// k1 k2 p1 p2 k3 k4 k5 k6; unused ones are 0.
    pub coefficients: [f64; 8],
}

/// The coefficients by name instead of by index.
pub(super) struct Named {
    /// The factors of r², r⁴ and r⁶ in the numerator.
    pub(super) numerator: [f64; 3],
    /// The factors of r², r⁴ and r⁶ in the denominator.
    pub(super) denominator: [f64; 3],
    pub(super) p1: f64,
    pub(super) p2: f64,
}

impl Lens {
    /// No distortion.
    pub const NONE: Self = Self { coefficients: [0.0; 8] };

    /// A lens with 0, 4, 5 or 8 coefficients, in the order k1 k2 p1 p2 k3 k4 k5 k6.
    ///
    /// # Errors
    /// [`Error::Parameter`] for another number of coefficients, or for one that is not finite.
    pub fn new(coefficients: &[f64]) -> Result<Self> {
        if ![0, 4, 5, 8].contains(&coefficients.len()) {
            let expected = "0, 4, 5 or 8, in the order k1 k2 p1 p2 k3 k4 k5 k6";
            return Err(Error::parameter("number of lens coefficients", coefficients.len(), expected));
        }
        if let Some(value) = coefficients.iter().find(|value| !value.is_finite()) {
            return Err(Error::parameter("lens coefficient", value, "a finite number"));
        }
        let mut all = [0.0; 8];
        all[..coefficients.len()].copy_from_slice(coefficients);
        Ok(Self { coefficients: all })
    }

    /// The coefficients to write to a file, in the order k1 k2 p1 p2 k3 k4 k5 k6: 5, or all 8 if one of the last
    /// three is not 0.
    pub fn shortest(&self) -> &[f64] {
        let rational = self.coefficients[5..].iter().any(|c| *c != 0.0);
        &self.coefficients[..if rational { 8 } else { 5 }]
    }

    /// The distorted position of the point that an ideal pinhole shows at `ideal`; both at focal length 1.
    ///
    /// The formula alone: beyond [`Lens::radius_limit`] its results have no meaning.
    pub fn distort(&self, ideal: [f64; 2]) -> [f64; 2] {
        self.with_jacobian(ideal).0
    }

    /// The undistorted position of the point that the lens shows at `distorted`; both at focal length 1. The inverse
    /// of [`Lens::distort`], to a residual of 10⁻¹² (1 + |distorted|).
    ///
    /// `None` if there is no such position within [`Lens::radius_limit`], where it is unique.
    pub fn undistort(&self, distorted: [f64; 2]) -> Option<[f64; 2]> {
        if *self == Self::NONE {
            return distorted.iter().all(|c| c.is_finite()).then_some(distorted);
        }
        // The first search nearly always succeeds. Where it has ended beyond a fold, the second one is kept inside.
        self.search(distorted, distorted, f64::INFINITY)
            .or_else(|| self.search(distorted, [0.0; 2], self.radius_limit()))
    }

    /// Whether the lens map is sound up to this distance from the axis: it shows no two points at the same position
    /// and mirrors none, and the denominator of q stays positive and so far from a root that the formula stretches
    /// the image at most four times. `false` for a radius that is not finite.
    pub fn is_one_to_one_to(&self, radius: f64) -> bool {
        *self == Self::NONE && radius.is_finite() || injectivity::is_one_to_one(&self.named(), radius)
    }

    /// The distance from the axis (the tangent of the angle to it) up to which the lens is one to one, at most that
    /// of 89.9°.
    pub fn radius_limit(&self) -> f64 {
        injectivity::limit(&self.named())
    }

    /// The distance from the axis of the denominator's first root, if there is one within 89.9°.
    pub(super) fn denominator_root(&self) -> Option<f64> {
        injectivity::denominator_root(&self.named())
    }

    pub(super) fn named(&self) -> Named {
        let [k1, k2, p1, p2, k3, k4, k5, k6] = self.coefficients;
        Named { numerator: [k1, k2, k3], denominator: [k4, k5, k6], p1, p2 }
    }

    /// The distorted position of `ideal`, and the derivative there: its elements xx, xy = yx, yy.
    pub fn with_jacobian(&self, ideal: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        let Named { numerator, denominator, p1, p2 } = self.named();
        let [x, y] = ideal;
        let s = x * x + y * y;
        let value = |[a, b, c]: [f64; 3]| 1.0 + s * (a + s * (b + s * c));
        let slope = |[a, b, c]: [f64; 3]| a + s * (2.0 * b + s * 3.0 * c);
        let (n, d) = (value(numerator), value(denominator));
        let q = n / d;
        // The derivative of q by r², twice: it comes with ∂r²/∂x = 2x.
        let q_s = 2.0 * (slope(numerator) - q * slope(denominator)) / d;
        let distorted = [
            x * q + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x),
            y * q + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y,
        ];
        let jacobian = [
            q + q_s * x * x + 2.0 * p1 * y + 6.0 * p2 * x,
            q_s * x * y + 2.0 * p1 * x + 2.0 * p2 * y,
            q + q_s * y * y + 6.0 * p1 * y + 2.0 * p2 * x,
        ];
        (distorted, jacobian)
    }

    /// Newton's method from `start`, clamped to within `limit` of the axis.
    fn search(&self, distorted: [f64; 2], start: [f64; 2], limit: f64) -> Option<[f64; 2]> {
        let enough = RESIDUAL * (1.0 + distorted[0].hypot(distorted[1]));
        if !enough.is_finite() {
            return None;
        }
        let mut at = start;
        let mut value = self.with_jacobian(at);
        let mut residual = distance(value.0, distorted);
        for _ in 0..MAX_STEPS {
            // Rounding reaches a thousandth of the accepted residual.
            if residual <= 1e-3 * enough {
                break;
            }
            let ([u, v], [xx, xy, yy]) = value;
            let determinant = xx * yy - xy * xy;
            if !(determinant > 0.0) {
                return None;
            }
            let (du, dv) = (distorted[0] - u, distorted[1] - v);
            let step = [(yy * du - xy * dv) / determinant, (xx * dv - xy * du) / determinant];
            let mut share = 1.0;
            let mut closer = None;
            for _ in 0..MAX_HALVINGS {
                let next = [at[0] + share * step[0], at[1] + share * step[1]];
                let there = self.with_jacobian(next);
                let left = distance(there.0, distorted);
                if next[0].hypot(next[1]) < limit && left < residual {
                    closer = Some((next, there, left));
                    break;
                }
                share *= 0.5;
            }
            // No step reduces the residual: only rounding is left, or there is no solution.
            let Some(found) = closer else { break };
            (at, value, residual) = found;
        }
        (residual <= enough && self.is_one_to_one_to(at[0].hypot(at[1]))).then_some(at)
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const STRONG: [f64; 8] = [-0.3, 0.12, 1.5e-3, -2e-3, -0.02, 0.05, 0.01, 0.002];

    #[test]
    fn the_jacobian_is_the_derivative() {
        let lens = Lens::new(&STRONG).unwrap();
        let h = 1e-6;
        for [x, y] in [[0.0, 0.0], [0.3, -0.2], [-0.7, 0.5], [1.0, 1.0]] {
            let [xx, xy, yy] = lens.with_jacobian([x, y]).1;
            let along = |dx: f64, dy: f64| {
                let (a, b) = (lens.distort([x + dx, y + dy]), lens.distort([x - dx, y - dy]));
                [(a[0] - b[0]) / (2.0 * h), (a[1] - b[1]) / (2.0 * h)]
            };
            let found = [along(h, 0.0), along(0.0, h)].concat();
            for (found, expected) in found.into_iter().zip([xx, xy, xy, yy]) {
                // Central differences: rounding of 10⁻¹⁶/10⁻⁶.
                assert!((found - expected).abs() <= 1e-9, "{x} {y}: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_inverse_is_one() {
        let lens = Lens::new(&STRONG).unwrap();
        let limit = lens.radius_limit();
        for i in 0..40 {
            for j in 0..24 {
                let r = 0.999 * limit.min(3.0) * f64::from(i) / 39.0;
                let angle = f64::from(j).to_radians() * 15.0;
                let ideal = [r * angle.cos(), r * angle.sin()];
                let back = lens.undistort(lens.distort(ideal)).unwrap();
                // The residual over the smallest slope, which is small near the fold.
                assert!(distance(back, ideal) <= 1e-8, "{ideal:?} {back:?}");
            }
        }
    }

    /// x′ = x (1 − r²/3) folds back at r = 1, where it shows 2/3: nothing is shown beyond.
    #[test]
    fn beyond_the_fold_there_is_nothing() {
        let lens = Lens::new(&[-1.0 / 3.0, 0.0, 0.0, 0.0]).unwrap();
        assert!((lens.radius_limit() - 1.0).abs() <= 1e-9);
        for angle in [0.0_f64, 1.0, 2.5, 4.0] {
            let at = |r: f64| [r * angle.cos(), r * angle.sin()];
            assert!(lens.undistort(at(0.6666)).is_some());
            for r in [0.6667, 0.7, 1.0, 2.0, 100.0] {
                assert_eq!(lens.undistort(at(r)), None, "{r}");
            }
            assert!(lens.is_one_to_one_to(0.999) && !lens.is_one_to_one_to(1.001));
        }
    }

    /// A map that folds and rises again also shows points beyond the fold; the answer must be the one before it.
    #[test]
    fn the_answer_lies_before_the_first_fold() {
        let lens = Lens::new(&[-1.0, 0.0, 0.0, 0.0, 0.4]).unwrap();
        let limit = lens.radius_limit();
        let most = lens.distort([limit, 0.0])[0];
        assert!(lens.distort([1.6, 0.0])[0] > most, "it rises again");
        for i in 1..100 {
            let ideal = [limit * f64::from(i) / 100.0, 0.0];
            let back = lens.undistort(lens.distort(ideal)).unwrap();
            assert!(distance(back, ideal) <= 1e-8, "{ideal:?} {back:?}");
        }
        for beyond in [1.01 * most, 2.0 * most, 10.0] {
            assert_eq!(lens.undistort([0.0, beyond]), None);
        }
    }

    #[test]
    fn wrong_coefficients_are_refused() {
        for count in [1, 2, 3, 6, 7, 9, 12, 14] {
            let text = Lens::new(&vec![0.0; count]).unwrap_err().to_string();
            assert!(text.starts_with(&format!("number of lens coefficients is {count}, expected 0, 4,")));
        }
        assert!(Lens::new(&[f64::NAN, 0.0, 0.0, 0.0]).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// For any lens, a point shown up to its limit is found again, and a point found is shown there.
        #[test]
        fn no_answer_is_wrong(
            radial in prop::array::uniform6(-1.0..1.0_f64),
            tangential in prop::array::uniform2(-0.05..0.05_f64),
            places in prop::collection::vec((0.0..0.99_f64, 0.0..6.3_f64), 20),
            others in prop::collection::vec((-3.0..3.0_f64, -3.0..3.0_f64), 20),
        ) {
            let [k1, k2, k3, k4, k5, k6] = radial;
            let lens = Lens::new(&[k1, k2, tangential[0], tangential[1], k3, k4, k5, k6]).unwrap();
            let limit = lens.radius_limit();
            for (share, angle) in places {
                let r = share * limit.min(10.0);
                let ideal = [r * angle.cos(), r * angle.sin()];
                let back = lens.undistort(lens.distort(ideal));
                // The residual, over the slope near the fold.
                let far = |back| distance(back, ideal) > 1e-6 * (1.0 + r);
                prop_assert!(!back.is_none_or(far), "{lens:?} {limit} {ideal:?} {back:?}");
            }
            for (x, y) in others {
                if let Some(ideal) = lens.undistort([x, y]) {
                    prop_assert!(distance(lens.distort(ideal), [x, y]) <= 1e-11, "{lens:?} {x} {y} {ideal:?}");
                    prop_assert!(ideal[0].hypot(ideal[1]) <= limit.max(1e-12), "{lens:?} {x} {y} {ideal:?}");
                }
            }
        }
    }
}
