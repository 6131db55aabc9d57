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

/// The 95 % confidence interval of the difference of two shares of successes in the same trials, the second minus the
/// first, `[low, high]`: method 10 of R. G. Newcombe, Improved confidence intervals for the difference between binomial
/// proportions based on paired data, Statistics in Medicine 17, 1998. It joins the intervals of both shares
/// ([`wilson`]) by their correlation.
///
/// `counts` are the trials in which both succeeded, only the first, only the second, and neither. Without trials the
/// interval is −1 to 1.
pub fn paired_interval(counts: [usize; 4]) -> [f64; 2] {
    let n = counts.iter().sum::<usize>();
    if n == 0 {
        return [-1.0, 1.0];
    }
    let [both, first, second, neither] = counts.map(|count| count as f64);
    let successes = [counts[0] + counts[1], counts[0] + counts[2]];
    let shares = successes.map(|count| count as f64 / n as f64);
    let ends = successes.map(|count| wilson(count, n));
    let product = both * neither - first * second;
    let margins = (both + first) * (second + neither) * (both + second) * (first + neither);
    // Corrected for continuity where it is positive.
    let corrected = if product > 0.0 { (product - n as f64 / 2.0).max(0.0) } else { product };
    let correlation = if margins > 0.0 { corrected / margins.sqrt() } else { 0.0 };
    let joined = |a: f64, b: f64| (a * a - 2.0 * correlation * a * b + b * b).max(0.0).sqrt();
    let difference = (second - first) / n as f64;
    let [below, above] = [0, 1].map(|end| [0, 1].map(|which| (shares[which] - ends[which][end]).abs()));
    [difference - joined(below[1], above[0]), difference + joined(above[1], below[0])]
}

/// The exact test of McNemar (Q. McNemar, Note on the sampling error of the difference between correlated proportions or
/// percentages, Psychometrika 12, 1947): the probability, from both sides, of a split of the trials in which only one
/// of two succeeded that is at least as uneven as this one, if each were as likely to be the one.
pub fn mcnemar(only: [usize; 2]) -> f64 {
    let (n, least) = (only[0] + only[1], only[0].min(only[1]));
    // The binomial probability of k of n, from that of k − 1.
    let mut probability = 0.5_f64.powi(i32::try_from(n).unwrap_or(i32::MAX));
    let mut sum = probability;
    for k in 1..=least {
        probability *= (n - k + 1) as f64 / k as f64;
        sum += probability;
    }
    (2.0 * sum).min(1.0)
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
    fn an_even_split_says_nothing_and_an_uneven_one_does() {
        assert_eq!([mcnemar([0, 0]), mcnemar([3, 3])], [1.0, 1.0]);
        // 2 · (1 + 10 + 45) / 1024, and 2 / 64.
        assert!((mcnemar([2, 8]) - 112.0 / 1024.0).abs() < 1e-15 && mcnemar([8, 2]) == mcnemar([2, 8]));
        assert!((mcnemar([6, 0]) - 2.0 / 64.0).abs() < 1e-15);
    }

    #[test]
    fn paired_intervals_have_their_limits() {
        assert_eq!(paired_interval([0; 4]), [-1.0, 1.0]);
        for counts in [[7, 0, 0, 0], [3, 2, 5, 1], [0, 9, 0, 0], [0, 0, 9, 3], [20, 1, 4, 5]] {
            let [both, first, second, neither] = counts;
            let [low, high] = paired_interval(counts);
            let difference = (second as f64 - first as f64) / counts.iter().sum::<usize>() as f64;
            assert!(-1.0 - 1e-12 <= low && low <= difference && difference <= high && high <= 1.0 + 1e-12);
            let [other_low, other_high] = paired_interval([both, second, first, neither]);
            assert!((low + other_high).abs() < 1e-12 && (high + other_low).abs() < 1e-12, "{counts:?}");
        }
    }

    /// Of all outcomes of 25 trials, weighted by their probability, the interval holds the true difference in about
    /// 95 of 100.
    #[test]
    fn paired_intervals_cover_the_difference() {
        const N: usize = 25;
        let mut factorials = [1.0_f64; N + 1];
        (1..=N).for_each(|n| factorials[n] = factorials[n - 1] * n as f64);
        for shares in [[0.7, 0.1, 0.15, 0.05], [0.5, 0.05, 0.3, 0.15], [0.25, 0.25, 0.25, 0.25]] {
            let truth = shares[2] - shares[1];
            let mut covered = 0.0;
            for both in 0..=N {
                for first in 0..=N - both {
                    for second in 0..=N - both - first {
                        let counts = [both, first, second, N - both - first - second];
                        let probability = (counts.iter().zip(shares))
                            .fold(factorials[N], |p, (&count, share)| {
                                p * f64::powi(share, count as i32) / factorials[count]
                            });
                        let [low, high] = paired_interval(counts);
                        covered += if (low..=high).contains(&truth) { probability } else { 0.0 };
                    }
                }
            }
            // Newcombe reports 0.93 to 0.98 for samples of this size.
            assert!((0.93..0.985).contains(&covered), "{shares:?}: {covered}");
        }
    }

    #[test]
    fn the_mean_of_nothing_is_none() {
        assert_eq!((mean(&[]), mean(&[1.0, 2.0])), (None, Some(1.5)));
    }
}
