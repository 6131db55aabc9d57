//! Sums of errors that can be added up over parts of an image and over images.

use super::metrics::{FlowError, angular_error_deg, distance};
use crate::frame::FlowField;

/// Count, mean and sum of squared deviations, in one pass (Welford 1962), which does not suffer the cancellation of the
/// difference of two sums. Two of them are merged as in Chan, Golub, LeVeque, "Updating formulae and a pairwise algorithm
/// for computing sample variances", COMPSTAT 1982.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Moments {
    /// Number of values.
    count: usize,
    /// Their mean; 0 without values.
    mean: f64,
    /// The sum of the squared deviations from the mean.
    squares: f64,
}

impl Moments {
    /// Adds a value.
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
    }

    /// Adds all values of another set.
    pub fn merge(&mut self, other: &Self) {
        let count = self.count + other.count;
        if other.count == 0 {
            return;
        }
        let (apart, share) = (other.mean - self.mean, other.count as f64 / count as f64);
        self.mean += apart * share;
        self.squares += other.squares + apart * apart * share * self.count as f64;
        self.count = count;
    }

    /// Number of values.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The mean; NaN without values.
    pub fn mean(&self) -> f64 {
        if self.count == 0 { f64::NAN } else { self.mean }
    }

    /// The variance, with the number of values as divisor; NaN without values.
    pub fn variance(&self) -> f64 {
        self.squares / self.count as f64
    }
}

/// The errors of a set of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tally {
    /// Pixels known in the truth.
    known: usize,
    /// Endpoint errors, px, of the pixels known in both fields.
    endpoint: Moments,
    /// Their angular errors, degrees.
    angular: Moments,
    /// Those whose endpoint error is over 1 px.
    over_1: usize,
    /// Those whose endpoint error is over 3 px.
    over_3: usize,
}

impl Tally {
    /// Adds a pixel whose true displacement is known. Returns the endpoint error in pixels; `None` if the estimate is
    /// unknown.
    pub fn add(&mut self, truth: [f32; 2], estimate: [f32; 2]) -> Option<f64> {
        self.known += 1;
        if !FlowField::is_known(estimate) {
            return None;
        }
        let distance = distance(truth, estimate);
        self.endpoint.add(distance);
        self.angular.add(angular_error_deg(truth, estimate));
        self.over_1 += usize::from(distance > 1.0);
        self.over_3 += usize::from(distance > 3.0);
        Some(distance)
    }

    /// Adds all pixels of another set.
    pub fn merge(&mut self, other: &Self) {
        self.known += other.known;
        self.endpoint.merge(&other.endpoint);
        self.angular.merge(&other.angular);
        self.over_1 += other.over_1;
        self.over_3 += other.over_3;
    }

    /// Pixels known in the truth.
    pub fn known(&self) -> usize {
        self.known
    }

    /// The figures.
    pub fn error(&self) -> FlowError {
        let pixels = self.endpoint.count();
        // 0/0 is NaN, the documented value where nothing was compared.
        let share = |part: usize, whole: usize| part as f64 / whole as f64;
        FlowError {
            aee_px: self.endpoint.mean(),
            aee_std: self.endpoint.variance().sqrt(),
            aae_deg: self.angular.mean(),
            aae_std_deg: self.angular.variance().sqrt(),
            rmse_px: (self.endpoint.mean().powi(2) + self.endpoint.variance()).sqrt(),
            r1: share(self.over_1, pixels),
            r3: share(self.over_3, pixels),
            density: share(pixels, self.known),
            pixels,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_add_up_to_the_whole() {
        let values: Vec<f64> = (0..100).map(|i| f64::from(i * i % 37) + 1e6).collect();
        let moments = |values: &[f64]| {
            let mut moments = Moments::default();
            values.iter().for_each(|value| moments.add(*value));
            moments
        };
        let whole = moments(&values);
        for cut in [0, 1, 50, 100] {
            let mut sum = moments(&values[..cut]);
            sum.merge(&moments(&values[cut..]));
            // Some hundred roundings of numbers of 1e6.
            assert!((sum.mean() - whole.mean()).abs() <= 1e-8, "{cut}");
            assert!((sum.variance() / whole.variance() - 1.0).abs() <= 1e-8, "{cut}");
            assert_eq!(sum.count(), 100);
        }
        let mut none = Moments::default();
        none.merge(&Moments::default());
        assert!(none.mean().is_nan() && none.variance().is_nan());
    }

    #[test]
    fn an_unknown_estimate_lowers_the_density_alone() {
        let mut tally = Tally::default();
        assert_eq!(tally.add([0.0; 2], [3.0, 4.0]), Some(5.0));
        assert_eq!(tally.add([0.0; 2], [f32::NAN, 0.0]), None);
        let error = tally.error();
        assert_eq!(
            (tally.known(), error.pixels, error.density, error.aee_px, error.r3),
            (2, 1, 0.5, 5.0, 1.0)
        );
    }
}
