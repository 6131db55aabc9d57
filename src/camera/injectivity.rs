//! The radius up to which a lens map is one to one.
//!
//! The derivative of the lens map is symmetric: with p = (p2, p1) it is that of the radial part, whose eigenvalues
//! are g = d(r q)/dr along the radius and q across it, plus 2 (p xᵀ + x pᵀ + (p·x) 1), whose eigenvalues are −6 |p| r
//! at least. If it is positive definite on a disc, the map is the gradient of a strictly convex function there, and
//! so one to one. The disc is therefore the one where
//!
//! q − 6 |p| r > 0, g − 6 |p| r > 0, and the denominator of q is positive.
//!
//! The second bound is sharp in the direction opposite to p. Just before a root of the denominator the formula may
//! rise without bound and stay one to one: then everything further out would be shown in a thin ring. So g may not
//! exceed [`MAX_STRETCH`] either. Multiplied by powers of the denominator, all of these are polynomials in r, and
//! their Bernstein form shows whether one is positive on a whole interval, with no samples that could miss a root
//! between them.

use super::lens::Named;

/// N D + 2 r² (N′ D − N D′) has degree 12 in r, and r D² degree 13.
const TERMS: usize = 14;
/// The most times an interval is halved. What is undecided then touches zero.
const MAX_DEPTH: u32 = 40;
/// The largest angle from the axis that a planar image is analysed to.
const MAX_ANGLE_DEG: f64 = 89.9;

/// How many times further apart than an ideal pinhole a lens may show two points. Strong pincushions reach 2.
const MAX_STRETCH: f64 = 4.0;

/// Coefficients of 1, r, r², …
type Polynomial = [f64; TERMS];

/// Whether the lens is one to one on the disc of this radius.
pub(super) fn is_one_to_one(lens: &Named, radius: f64) -> bool {
    radius.is_finite() && conditions(lens).iter().all(|p| is_positive(p, radius))
}

/// The radius of the largest disc on which the lens is one to one.
pub(super) fn limit(lens: &Named) -> f64 {
    let conditions = conditions(lens);
    largest(|radius| conditions.iter().all(|p| is_positive(p, radius)))
}

fn farthest() -> f64 {
    MAX_ANGLE_DEG.to_radians().tan()
}

/// The largest radius for which a property holds that holds for all smaller ones, too.
fn largest(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut good, mut bad) = (0.0, farthest());
    if holds(bad) {
        return bad;
    }
    // Bisect until no number lies between the two.
    loop {
        let middle = 0.5 * (good + bad);
        if !(good < middle && middle < bad) {
            return good;
        }
        *(if holds(middle) { &mut good } else { &mut bad }) = middle;
    }
}

/// The first root of the denominator within [`MAX_ANGLE_DEG`] of the axis, if there is one.
pub(super) fn denominator_root(lens: &Named) -> Option<f64> {
    let [d, ..] = conditions(lens);
    let root = largest(|radius| is_positive(&d, radius));
    (root < farthest()).then_some(root)
}

fn conditions(lens: &Named) -> [Polynomial; 4] {
    let even = |[a, b, c]: [f64; 3]| place(&[1.0, a, b, c], 2);
    let slope = |[a, b, c]: [f64; 3]| place(&[a, 2.0 * b, 3.0 * c], 2);
    let (n, d) = (even(lens.numerator), even(lens.denominator));
    let turn = minus(&times(&slope(lens.numerator), &d), &times(&n, &slope(lens.denominator)));
    let radial = minus(&times(&n, &d), &times(&turn, &place(&[0.0, -2.0], 2)));
    let tangential = place(&[0.0, 6.0 * lens.p1.hypot(lens.p2)], 1);
    let across = minus(&n, &times(&tangential, &d));
    let d_squared = times(&d, &d);
    let stretch = minus(&times(&d_squared, &place(&[MAX_STRETCH], 1)), &radial);
    [d, across, minus(&radial, &times(&tangential, &d_squared)), stretch]
}

/// A polynomial with the given coefficients at every `step`-th power.
fn place(values: &[f64], step: usize) -> Polynomial {
    let mut result = [0.0; TERMS];
    result.iter_mut().step_by(step).zip(values).for_each(|(r, v)| *r = *v);
    result
}

fn minus(a: &Polynomial, b: &Polynomial) -> Polynomial {
    std::array::from_fn(|i| a[i] - b[i])
}

/// The product. Terms beyond the last power cancel, and are dropped.
fn times(a: &Polynomial, b: &Polynomial) -> Polynomial {
    std::array::from_fn(|i| (0..=i).map(|j| a[j] * b[i - j]).sum())
}

/// Whether a polynomial is positive from 0 to `radius`.
fn is_positive(polynomial: &Polynomial, radius: f64) -> bool {
    let Some(degree) = polynomial.iter().rposition(|c| *c != 0.0) else { return false };
    let mut bernstein = [0.0; TERMS];
    let mut power = 1.0;
    for (i, c) in polynomial[..=degree].iter().enumerate() {
        // (j over i) / (degree over i), from 1 at j = degree down.
        let mut share = 1.0;
        for j in (i..=degree).rev() {
            bernstein[j] += c * power * share;
            share *= (j - i) as f64 / (j as f64).max(1.0);
        }
        power *= radius;
    }
    bernstein_is_positive(&mut bernstein[..=degree], 0)
}

/// Whether a polynomial in Bernstein form is positive. It lies between the smallest and the largest of its
/// coefficients, and the first and the last are its values at the ends. An undecided interval is halved by de
/// Casteljau's algorithm.
fn bernstein_is_positive(coefficients: &mut [f64], depth: u32) -> bool {
    let last = coefficients.len() - 1;
    if coefficients.iter().all(|c| *c > 0.0) {
        return true;
    }
    if !(coefficients[0] > 0.0 && coefficients[last] > 0.0 && depth < MAX_DEPTH) {
        return false;
    }
    let mut left = [0.0; TERMS];
    for (i, left) in left.iter_mut().enumerate().take(last + 1) {
        *left = coefficients[0];
        for j in 0..last - i {
            coefficients[j] = 0.5 * (coefficients[j] + coefficients[j + 1]);
        }
    }
    bernstein_is_positive(&mut left[..=last], depth + 1) && bernstein_is_positive(coefficients, depth + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_positive_up_to_its_first_root() {
        // (1 − r) (2 − r) (3 − r), and (r − 1)² + 10⁻⁶, which comes close to a root.
        let cubic = place(&[6.0, -11.0, 6.0, -1.0], 1);
        assert!(is_positive(&cubic, 0.0) && is_positive(&cubic, 0.999_999));
        assert!(!is_positive(&cubic, 1.0) && !is_positive(&cubic, 2.5) && !is_positive(&cubic, 4.0));
        let near = place(&[1.0 + 1e-6, -2.0, 1.0], 1);
        assert!(is_positive(&near, 5.0) && is_positive(&near, 1e3));
        let touching = place(&[1.0, -2.0, 1.0], 1);
        assert!(is_positive(&touching, 0.9) && !is_positive(&touching, 5.0));
        assert!(!is_positive(&[0.0; TERMS], 1.0) && !is_positive(&[f64::NAN; TERMS], 1.0));
    }
}
