/// The 97.5 % quantile of the standard normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// The 95 % confidence interval of a share of successes (E. B. Wilson, Probable inference, the law of succession, and
/// statistical inference, JASA 22, 1927), `[low, high]` without correction for continuity. Without trials it is 0 to
/// 1.
pub fn wilson(successes: usize, trials: usize) -> [f64; 2] {
    if trials == 0 {
        return [0.0, 1.0];
    }
    let n = trials as f64;
    let share = successes as f64 / n;
    let scale = 1.0 + Z * Z / n;
    let centre = (share + Z * Z / (2.0 * n)) / scale;
    let half = Z / scale * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    // Without and with only successes one end is exact; rounding must not change it.
    [if successes == 0 { 0.0 } else { centre - half }, if successes >= trials { 1.0 } else { centre + half }]
}

/// The mean; `None` if there are no values.
pub(super) fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_wilsons() {
        // R. G. Newcombe, Two-sided confidence intervals for the single proportion, Statistics in Medicine 17, 1998,
        // table I, method 3; it gives four digits.
        for (successes, trials, low, high) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0000, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ] {
            let found = wilson(successes, trials);
            for (found, expected) in found.into_iter().zip([low, high]) {
                assert!((found - expected).abs() <= 0.5e-4, "{successes}/{trials}: {found} {expected}");
            }
            let [other_low, other_high] = wilson(trials - successes, trials);
            assert!(
                (found[0] + other_high - 1.0).abs() < 1e-12 && (found[1] + other_low - 1.0).abs() < 1e-12
            );
        }
        assert_eq!(wilson(0, 0), [0.0, 1.0]);
        assert_eq!(wilson(7, 7)[1], 1.0);
        assert_eq!(wilson(0, 7)[0], 0.0);
    }

    #[test]
    fn the_mean_of_nothing_is_none() {
        assert_eq!((mean(&[]), mean(&[1.0, 2.0])), (None, Some(1.5)));
    }
}
