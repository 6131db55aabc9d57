//! How well a confidence tells bad pixels from good ones.

/// An alarm's rates for every threshold of a confidence: the receiver operating characteristic (T. Fawcett, An
/// introduction to ROC analysis, Pattern Recognition Letters 27, 2006). An alarm is a confidence below the threshold; it
/// should be raised for bad pixels, and is false for good ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Roc {
    /// From (0, 0) to (1, 1): the share of the good pixels for which the alarm is raised, and that of the bad ones.
    points: Vec<[f64; 2]>,
}

impl Roc {
    /// The curve of pixels with a confidence each, bad or good. The order does not matter. NaN is the least confidence,
    /// so that it never passes as a high one. `None` if there are no bad pixels, or no good ones.
    pub fn new(pixels: impl IntoIterator<Item = (f32, bool)>) -> Option<Self> {
        let value = |confidence: f32| if confidence.is_nan() { f32::NEG_INFINITY } else { confidence };
        let mut pixels: Vec<(f32, bool)> = pixels.into_iter().map(|(c, bad)| (value(c), bad)).collect();
        pixels.sort_by(|a, b| a.0.total_cmp(&b.0));
        let alike = pixels.chunk_by(|a, b| a.0 == b.0);
        Self::of_groups(alike.map(|group| {
            let bad = group.iter().filter(|(_, bad)| *bad).count();
            [group.len() - bad, bad]
        }))
    }

    /// The curve of groups of pixels, each `[good, bad]`, in ascending order of confidence; those of a group share their
    /// confidence. `None` if there are no bad pixels, or no good ones.
    pub fn of_groups(groups: impl IntoIterator<Item = [usize; 2]>) -> Option<Self> {
        let mut sums = vec![[0_usize; 2]];
        let (mut good, mut bad) = (0, 0);
        for [more_good, more_bad] in groups {
            (good, bad) = (good + more_good, bad + more_bad);
            sums.push([good, bad]);
        }
        if good == 0 || bad == 0 {
            return None;
        }
        let mut points: Vec<[f64; 2]> =
            sums.into_iter().map(|[g, b]| [g as f64 / good as f64, b as f64 / bad as f64]).collect();
        points.dedup();
        Some(Self { points })
    }

    /// The curve's points, from (0, 0) to (1, 1): false alarms per good pixel, and alarms per bad pixel.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The area under the curve: the probability that a bad pixel has a lower confidence than a good one, where equal
    /// ones count half. 1 for a perfect confidence, ½ for a random one.
    pub fn area(&self) -> f64 {
        self.points.windows(2).map(|pair| 0.5 * (pair[1][0] - pair[0][0]) * (pair[0][1] + pair[1][1])).sum()
    }

    /// The share of the bad pixels for which no alarm is raised, at the threshold that raises a false one for this share
    /// of the good pixels, 0 to 1. Linear between points.
    pub fn missed(&self, false_alarms: f64) -> f64 {
        let Some(next) = self.points.iter().position(|[x, _]| *x > false_alarms) else { return 0.0 };
        let [[x0, y0], [x1, y1]] = [self.points[next.max(1) - 1], self.points[next]];
        1.0 - (y0 + (y1 - y0) * (false_alarms - x0) / (x1 - x0))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn roc(pixels: &[(f32, bool)]) -> Option<Roc> {
        Roc::new(pixels.iter().copied())
    }

    #[test]
    fn an_area_worked_out_by_hand() {
        // Of the 3 × 2 couples of a good and a bad pixel, (.9, .8), (.9, .3), (.7, .3) and (.5, .3) are in order.
        let curve = roc(&[(0.9, false), (0.8, true), (0.7, false), (0.5, false), (0.3, true)]).unwrap();
        assert!((curve.area() - 4.0 / 6.0).abs() <= 1e-12, "{}", curve.area());
        let (third, two) = (1.0 / 3.0, 2.0 / 3.0);
        assert_eq!(
            curve.points(),
            [[0.0, 0.0], [0.0, 0.5], [third, 0.5], [two, 0.5], [two, 1.0], [1.0, 1.0]]
        );
        // One of the two is found without a false alarm, the other after two of three.
        assert_eq!([0.0, 0.1, 0.6].map(|share| curve.missed(share)), [0.5; 3]);
        assert_eq!([0.7, 1.0].map(|share| curve.missed(share)), [0.0; 2]);
    }

    #[test]
    fn equal_confidences_count_half() {
        let curve = roc(&[(0.5, false), (0.5, true), (0.5, true)]).unwrap();
        assert_eq!((curve.area(), curve.points()), (0.5, &[[0.0, 0.0], [1.0, 1.0]][..]));
        assert!((curve.missed(0.1) - 0.9).abs() <= 1e-12);
        // Couples: (.5, .5) counts half, (.5, .2) one, (.6, ...) two.
        let curve = roc(&[(0.5, false), (0.5, true), (0.2, true), (0.6, false)]).unwrap();
        assert!((curve.area() - 3.5 / 4.0).abs() <= 1e-12);
    }

    #[test]
    fn a_perfect_and_a_reversed_confidence_are_the_ends() {
        let perfect = roc(&[(0.1, true), (0.2, true), (0.3, false)]).unwrap();
        assert_eq!((perfect.area(), perfect.missed(0.0), perfect.missed(0.1)), (1.0, 0.0, 0.0));
        let reversed = roc(&[(0.1, false), (0.2, true)]).unwrap();
        assert_eq!((reversed.area(), reversed.missed(0.1)), (0.0, 1.0));
    }

    #[test]
    fn there_is_none_without_bad_or_without_good_pixels() {
        assert_eq!(roc(&[(0.1, true), (0.2, true)]), None);
        assert_eq!(roc(&[(0.1, false)]), None);
        assert_eq!(roc(&[]), None);
        assert_eq!(Roc::of_groups([[3, 0], [0, 0]]), None);
    }

    #[test]
    fn nan_is_the_least_confidence() {
        assert_eq!(roc(&[(f32::NAN, true), (0.0, false)]).unwrap().area(), 1.0);
        assert_eq!(roc(&[(f32::NAN, false), (0.0, true)]).unwrap().area(), 0.0);
        assert_eq!(roc(&[(f32::NAN, false), (-f32::NAN, true)]).unwrap().area(), 0.5);
    }

    #[test]
    fn groups_are_the_pixels_in_them() {
        let pixels = [(0.1, true), (0.1, false), (0.1, true), (0.4, false), (0.9, true), (0.9, false)];
        assert_eq!(roc(&pixels), Roc::of_groups([[1, 2], [0, 0], [1, 0], [1, 1]]));
    }
}
