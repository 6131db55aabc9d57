//! Comparison of two results: of the two sides of a kernel, and of the two executors of a plan.

use crate::kernel::Bound;
use crate::quantile::nearest_rank;

/// The value that fills outputs before a kernel runs: a recognisable NaN, so that a value that was never written is
/// found even where NaN is the right answer.
pub const POISON: f32 = f32::from_bits(0x7fc0_dead);

/// The differences between two results.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    /// The largest difference; infinite if one value is NaN or infinite and the other is not the same.
    pub max: f32,
    /// The 99.9th percentile (nearest rank).
    pub p999: f32,
    /// The mean.
    pub mean: f64,
    /// Number of compared values.
    pub count: usize,
    /// The largest ratio of a difference to its bound: 1 is the bound itself.
    pub share: f32,
    /// Number of values beyond their bound.
    pub breaches: usize,
    /// The value that is furthest beyond its bound.
    pub worst: Option<Breach>,
}

/// A value beyond its bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breach {
    /// The index in the buffer.
    pub index: usize,
    /// The reference's value.
    pub expected: f32,
    /// The value found.
    pub found: f32,
    /// The bound of their difference.
    pub bound: f32,
}

/// Compares `found` with `expected`, value by value.
///
/// Values agree if their difference is within the bound, or if both are the same infinity, or if both are NaN. A
/// [`POISON`] agrees with nothing. A value that only one side has is beyond every bound, and every value is beyond a
/// bound that is NaN.
pub fn compare(expected: &[f32], found: &[f32], within: &Bound) -> Difference {
    let count = expected.len().max(found.len());
    let mut result = Difference { count, ..Difference::default() };
    let mut differences = Vec::with_capacity(count);
    let mut furthest = 0.0;
    for index in 0..count {
        let value = |side: &[f32]| side.get(index).copied().unwrap_or(POISON);
        let (expected, found) = (value(expected), value(found));
        let difference = difference(expected, found);
        let bound = within.at(index, expected);
        if difference > 0.0 {
            result.share = result.share.max(difference / bound);
        }
        if !(difference <= bound && difference < f32::INFINITY) {
            result.breaches += 1;
            let excess = difference - bound;
            if result.worst.is_none() || excess > furthest {
                furthest = excess;
                result.worst = Some(Breach { index, expected, found, bound });
            }
        }
        differences.push(difference);
    }
    differences.sort_unstable_by(f32::total_cmp);
    if let Some(max) = differences.last() {
        result.max = *max;
        result.p999 = nearest_rank(&differences, 999).unwrap_or(*max);
        result.mean = differences.iter().map(|d| f64::from(*d)).sum::<f64>() / count as f64;
    }
    result
}

fn difference(expected: f32, found: f32) -> f32 {
    let poisoned = |v: f32| v.to_bits() == POISON.to_bits();
    if poisoned(expected) || poisoned(found) {
        f32::INFINITY
    } else if expected == found || (expected.is_nan() && found.is_nan()) {
        0.0
    } else {
        let difference = (expected - found).abs();
        if difference.is_nan() { f32::INFINITY } else { difference }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUND: Bound = Bound { absolute: 0.5, relative: 0.1, own: Vec::new() };

    fn breaches(expected: &[f32], found: &[f32]) -> usize {
        compare(expected, found, &BOUND).breaches
    }

    fn breaches_of_own(expected: &[f32], found: &[f32], own: &[f32]) -> usize {
        compare(expected, found, &Bound { own: own.to_vec(), ..BOUND }).breaches
    }

    #[test]
    fn accepts_what_is_within_the_bound() {
        assert_eq!(breaches(&[10.0, -10.0, 0.0], &[11.5, -8.5, 0.5]), 0);
        assert_eq!(breaches(&[f32::NAN, f32::INFINITY], &[-f32::NAN, f32::INFINITY]), 0);
        assert_eq!(breaches(&[], &[]), 0);
    }

    #[test]
    fn refuses_what_is_beyond_it() {
        assert_eq!(breaches(&[10.0], &[11.6]), 1);
        assert_eq!(breaches(&[10.0], &[8.4]), 1);
        assert_eq!(breaches(&[0.0; 1000], &[[0.0; 999].as_slice(), &[0.6]].concat()), 1);
    }

    #[test]
    fn refuses_not_a_number_against_a_number_either_way_round() {
        assert_eq!(breaches(&[1.0], &[f32::NAN]), 1);
        assert_eq!(breaches(&[f32::NAN], &[1.0]), 1);
        assert_eq!(breaches(&[f32::INFINITY], &[f32::MAX]), 1);
        assert_eq!(breaches(&[f32::INFINITY], &[f32::NEG_INFINITY]), 1);
    }

    #[test]
    fn refuses_what_was_never_written_even_where_not_a_number_is_right() {
        assert_eq!(breaches(&[f32::NAN], &[POISON]), 1);
        assert_eq!(breaches(&[POISON], &[POISON]), 1);
    }

    #[test]
    fn refuses_differing_lengths() {
        assert_eq!(breaches(&[1.0, 2.0], &[1.0]), 1);
        assert_eq!(breaches(&[1.0], &[1.0, 2.0]), 1);
    }

    #[test]
    fn names_the_worst_place() {
        let found = compare(&[0.0; 4], &[0.6, 9.0, 0.7, 0.0], &BOUND);
        let worst = found.worst.expect("three are beyond the bound");
        assert_eq!((worst.index, worst.found, found.breaches, found.max), (1, 9.0, 3, 9.0));
    }

    #[test]
    fn gives_each_value_its_own_bound() {
        assert_eq!(breaches_of_own(&[0.0; 3], &[0.5, 2.5, 1.5], &[0.0, 2.0, 1.0]), 0);
        assert_eq!(breaches_of_own(&[0.0; 3], &[2.5, 0.5, 1.5], &[0.0, 2.0, 1.0]), 1);
        assert_eq!(breaches_of_own(&[10.0], &[11.7], &[0.1]), 1);
        let found = compare(&[0.0; 2], &[0.4, 9.0], &Bound { own: vec![0.0, 9.5], ..BOUND });
        assert_eq!((found.share, found.breaches), (0.9, 0));
    }

    #[test]
    fn refuses_what_is_wrong_in_kind_under_the_widest_bound_of_its_own() {
        for widest in [f32::MAX, f32::INFINITY] {
            assert_eq!(breaches_of_own(&[1.0, f32::NAN], &[f32::NAN, 1.0], &[widest; 2]), 2);
            assert_eq!(breaches_of_own(&[f32::INFINITY], &[f32::NEG_INFINITY], &[widest]), 1);
            assert_eq!(breaches_of_own(&[1.0, f32::NAN], &[POISON; 2], &[widest; 2]), 2);
            assert_eq!(breaches_of_own(&[1.0], &[1.0, 2.0], &[widest; 2]), 1);
        }
    }

    #[test]
    fn refuses_everything_within_a_bound_that_is_not_a_number_or_not_there() {
        assert_eq!(breaches_of_own(&[1.0], &[1.0], &[f32::NAN]), 1);
        assert_eq!(breaches_of_own(&[1.0, 1.0], &[1.0, 1.0], &[9.0]), 1);
    }

    #[test]
    fn asks_for_the_same_bits_where_the_factor_is_0() {
        let none = Bound { own: vec![f32::MAX; 2], ..BOUND }.times(0.0);
        assert_eq!(compare(&[1.0, -2.0], &[1.0, -2.0], &none).breaches, 0);
        assert_eq!(compare(&[1.0, -2.0], &[1.0, -2.000_000_2], &none).breaches, 1);
    }
}
