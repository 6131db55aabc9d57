//! Medians and quantiles. Each is a value that is there, never a mean of two.

/// The values in ascending order; NaN is last.
pub(crate) fn sorted(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The median: of an even count the upper of the two middle values; `None` if there are no values.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    above_share(&sorted(values), 0.5)
}

/// The sorted value with this share of all values before it: the one at index ⌊n · share⌋. `None` if there is no such
/// index.
pub(crate) fn above_share<T: Copy>(sorted: &[T], share: f64) -> Option<T> {
    sorted.get((sorted.len() as f64 * share) as usize).copied()
}

/// The quantile of sorted values by the nearest index, share · (n − 1), so that 0 is the first value and 1 the last
/// one. `None` if there are no values.
pub(crate) fn nearest<T: Copy>(sorted: &[T], share: f64) -> Option<T> {
    sorted.get((sorted.len().saturating_sub(1) as f64 * share).round() as usize).copied()
}

/// The quantile of sorted values by the nearest rank: the smallest value that is not below this many thousandths of
/// all, 0 to 1000. `None` if there are no values.
pub(crate) fn nearest_rank<T: Copy>(sorted: &[T], thousandths: usize) -> Option<T> {
    sorted.get((sorted.len() * thousandths).div_ceil(1000).max(1) - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_a_value_that_is_there() {
        let values = sorted((0..=100).rev().map(f64::from));
        assert_eq!([0.05, 0.0, 1.0].map(|share| nearest(&values, share)), [5.0, 0.0, 100.0].map(Some));
        assert_eq!(
            [0, 50, 990, 1000].map(|rank| nearest_rank(&values, rank)),
            [0.0, 5.0, 99.0, 100.0].map(Some)
        );
        assert_eq!([0.05, 0.5, 0.99].map(|share| above_share(&values, share)), [5.0, 50.0, 99.0].map(Some));
        assert_eq!(nearest(&[3.0], 0.05), Some(3.0));
        assert_eq!((median([4.0, 1.0, 2.0, 3.0]), median([f64::NAN, 7.0, 1.0])), (Some(3.0), Some(7.0)));
        assert_eq!((median([]), nearest::<u8>(&[], 0.5), nearest_rank::<u8>(&[], 500)), (None, None, None));
    }
}
