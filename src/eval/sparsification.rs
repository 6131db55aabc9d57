//! The error of the pixels that a confidence rates best.

/// The number of steps of the curves: the best 5 %, 10 % and so on, to all.
pub const STEPS: usize = 20;

/// The mean endpoint error of the best pixels, by a confidence and by the error itself (the least that any confidence
/// can leave): the sparsification curves of O. Mac Aodha et al., Learning a confidence measure for optical flow, TPAMI 35,
/// 2013.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sparsification {
    /// Pixels.
    pixels: usize,
    /// By the confidence: the mean error in pixels of the best 5 %, 10 %, …, 100 %.
    best_px: Vec<f64>,
    /// By the error itself.
    oracle_px: Vec<f64>,
}

impl Sparsification {
    /// The curves of pixels, each with its confidence and its endpoint error in pixels, which is a number. NaN is the least
    /// confidence. Pixels of equal confidence share their mean error, so that their order does not matter. `None` without
    /// pixels.
    pub fn new(pixels: &[(f32, f64)]) -> Option<Self> {
        if pixels.is_empty() {
            return None;
        }
        let value = |confidence: f32| if confidence.is_nan() { f32::NEG_INFINITY } else { confidence };
        let mut sorted: Vec<(f32, f64)> = pixels.iter().map(|(c, error)| (value(*c), *error)).collect();
        sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut by_confidence = Vec::with_capacity(sorted.len());
        for group in sorted.chunk_by(|a, b| a.0 == b.0) {
            let mean = group.iter().map(|(_, error)| error).sum::<f64>() / group.len() as f64;
            by_confidence.extend(std::iter::repeat_n(mean, group.len()));
        }
        let mut by_error: Vec<f64> = pixels.iter().map(|(_, error)| *error).collect();
        by_error.sort_by(f64::total_cmp);
        Some(Self { pixels: pixels.len(), best_px: means(&by_confidence), oracle_px: means(&by_error) })
    }

    /// Includes the curves of another image: each point becomes the mean over all images, weighted by their pixels.
    pub fn merge(&mut self, other: &Self) {
        let share = other.pixels as f64 / (self.pixels + other.pixels) as f64;
        for (mine, others) in [(&mut self.best_px, &other.best_px), (&mut self.oracle_px, &other.oracle_px)] {
            mine.iter_mut().zip(others).for_each(|(mine, other)| *mine += share * (other - *mine));
        }
        self.pixels += other.pixels;
    }

    /// The mean error in pixels of the best 5 %, 10 %, …, 100 % by the confidence, [`STEPS`] values.
    pub fn best_px(&self) -> &[f64] {
        &self.best_px
    }

    /// The same by the error itself.
    pub fn oracle_px(&self) -> &[f64] {
        &self.oracle_px
    }

    /// The mean distance of the two curves, px: 0 for a confidence that sorts pixels by their error.
    pub fn area_px(&self) -> f64 {
        let apart = self.best_px.iter().zip(&self.oracle_px).map(|(best, oracle)| best - oracle);
        apart.sum::<f64>() / self.best_px.len() as f64
    }
}

/// The means of the first 1/[`STEPS`], 2/[`STEPS`] and so on of the values, of at least one.
fn means(sorted: &[f64]) -> Vec<f64> {
    let (mut sum, mut taken) = (0.0, 0);
    let mean = |step: usize| {
        let count = (sorted.len() * step).div_ceil(STEPS);
        sum += sorted[taken..count].iter().sum::<f64>();
        taken = count;
        sum / count as f64
    };
    (1..=STEPS).map(mean).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn curves_worked_out_by_hand() {
        // Twenty pixels, a step each. The confidence swaps the best two.
        let mut pixels: Vec<(f32, f64)> = (0..20).map(|i| (1.0 - 0.01 * i as f32, f64::from(i))).collect();
        pixels[0].0 = 0.985;
        let curves = Sparsification::new(&pixels).unwrap();
        assert_eq!(curves.best_px()[..3], [1.0, 0.5, 1.0]);
        assert_eq!(curves.oracle_px()[..3], [0.0, 0.5, 1.0]);
        assert_eq!((curves.best_px()[19], curves.best_px().len()), (9.5, STEPS));
        assert!((curves.area_px() - 1.0 / 20.0).abs() <= 1e-12);
    }

    #[test]
    fn equal_confidences_have_one_mean_and_nan_comes_last() {
        let same = Sparsification::new(&[(0.5, 1.0), (0.5, 3.0)]).unwrap();
        assert!(same.best_px().iter().all(|px| *px == 2.0));
        let nan = Sparsification::new(&[(f32::NAN, 9.0), (0.0, 1.0)]).unwrap();
        assert_eq!((nan.best_px()[0], nan.area_px()), (1.0, 0.0));
        assert_eq!(Sparsification::new(&[]), None);
    }

    #[test]
    fn images_are_weighted_by_their_pixels() {
        let mut sum = Sparsification::new(&[(0.5, 1.0)]).unwrap();
        sum.merge(&Sparsification::new(&[(0.5, 4.0), (0.4, 4.0)]).unwrap());
        assert!(sum.best_px().iter().all(|px| (px - 3.0).abs() <= 1e-12), "{sum:?}");
    }
}
