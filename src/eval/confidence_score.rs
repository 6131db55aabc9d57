//! How well a confidence tells bad pixels.

use super::{Roc, Sparsification};

/// The endpoint error over which a pixel is bad, px.
pub const BAD_PX: f64 = 0.5;
/// The equal parts of the confidence's range 0 to 1 in which pixels are counted.
const BINS: usize = 1000;

/// How well a confidence from 0 to 1 tells bad pixels, whose endpoint error is over [`BAD_PX`], from good ones.
///
/// Pixels are counted in thousandths of the confidence, so that the counts of many pairs can be added up; those of one bin
/// count as equal.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ConfidenceScore {
    /// Pixels that are not sky.
    solid: Counts,
    /// Pixels of the sky; empty if none are known.
    sky: Counts,
    sparsification: Sparsification,
}

/// Good and bad pixels per bin; empty without pixels.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Counts {
    good: Vec<usize>,
    bad: Vec<usize>,
}

impl Counts {
    fn add(&mut self, bin: usize, is_bad: bool) {
        let bins = if is_bad { &mut self.bad } else { &mut self.good };
        bins.resize(BINS, 0);
        bins[bin] += 1;
    }

    fn merge(&mut self, other: &Self) {
        for (mine, other) in [(&mut self.good, &other.good), (&mut self.bad, &other.bad)] {
            mine.resize(mine.len().max(other.len()), 0);
            mine.iter_mut().zip(other).for_each(|(mine, other)| *mine += other);
        }
    }
}

/// Whose bad pixels are to be told from the good ones of the whole image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bad {
    /// All bad pixels.
    Everywhere,
    /// Bad pixels that are not sky, from good ones that are not sky.
    Solid,
    /// The bad pixels of the sky, from all good ones.
    Sky,
}

impl ConfidenceScore {
    /// Counts pixels: the confidence, the endpoint error in pixels, and whether it is sky. `None` without pixels.
    pub fn new(pixels: &[(f32, f64, bool)]) -> Option<Self> {
        let all: Vec<(f32, f64)> =
            pixels.iter().map(|(confidence, error, _)| (*confidence, *error)).collect();
        let sparsification = Sparsification::new(&all)?;
        let mut score = Self { solid: Counts::default(), sky: Counts::default(), sparsification };
        for &(confidence, error, is_sky) in pixels {
            // The conversion saturates, and makes 0 of NaN.
            let bin = ((f64::from(confidence) * BINS as f64) as usize).min(BINS - 1);
            let counts = if is_sky { &mut score.sky } else { &mut score.solid };
            // An error of NaN is bad.
            counts.add(bin, !(error <= BAD_PX));
        }
        Some(score)
    }

    /// Includes the pixels of another pair.
    pub fn merge(&mut self, other: &Self) {
        self.solid.merge(&other.solid);
        self.sky.merge(&other.sky);
        self.sparsification.merge(&other.sparsification);
    }

    /// Pixels counted.
    pub fn pixels(&self) -> usize {
        [&self.solid.good, &self.solid.bad, &self.sky.good, &self.sky.bad].iter().copied().flatten().sum()
    }

    /// The bad pixels as a share of all, 0 to 1.
    pub fn bad(&self) -> f64 {
        let bad: usize = [&self.solid.bad, &self.sky.bad].iter().copied().flatten().sum();
        bad as f64 / self.pixels() as f64
    }

    /// The alarm's rates for every threshold; `None` if there are no bad pixels, or no good ones.
    pub fn roc(&self, of: Bad) -> Option<Roc> {
        let at = |bins: &[usize], bin: usize| bins.get(bin).copied().unwrap_or(0);
        let (solid, sky) = (&self.solid, &self.sky);
        Roc::of_groups((0..BINS).map(|bin| match of {
            Bad::Everywhere => {
                [at(&solid.good, bin) + at(&sky.good, bin), at(&solid.bad, bin) + at(&sky.bad, bin)]
            }
            Bad::Solid => [at(&solid.good, bin), at(&solid.bad, bin)],
            Bad::Sky => [at(&solid.good, bin) + at(&sky.good, bin), at(&sky.bad, bin)],
        }))
    }

    /// The error of the pixels that the confidence rates best.
    pub fn sparsification(&self) -> &Sparsification {
        &self.sparsification
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::kernels::hash::{finalised, scrambled};

    /// A pseudorandom number from 0 to 1.
    fn random(i: u32) -> f32 {
        (finalised(scrambled(i)) >> 8) as f32 / (1 << 24) as f32
    }

    #[test]
    fn bins_are_nearly_the_pixels_themselves() {
        let pixels: Vec<(f32, f64, bool)> = (0..20_000)
            .map(|i| {
                let confidence = random(i);
                (confidence, f64::from((1.2 - confidence) * random(i + 20_000)), i % 3 == 0)
            })
            .collect();
        let score = ConfidenceScore::new(&pixels).unwrap();
        let exact = Roc::new(pixels.iter().map(|(c, error, _)| (*c, *error > BAD_PX))).unwrap();
        let binned = score.roc(Bad::Everywhere).unwrap();
        // Half of the couples of a bin, a thousandth of all, could be out of order.
        assert!((binned.area() - exact.area()).abs() <= 5e-4, "{} {}", binned.area(), exact.area());
        assert!(exact.area() > 0.6 && exact.area() < 0.9, "{}", exact.area());
        assert_eq!(score.pixels(), 20_000);
    }

    #[test]
    fn the_sky_is_told_from_what_is_good_anywhere() {
        let pixels = [(0.9, 0.0, false), (0.3, 9.0, false), (0.1, 9.0, true), (0.2, 0.5, true)];
        let score = ConfidenceScore::new(&pixels).unwrap();
        let area = |of| score.roc(of).map(|roc| roc.area());
        // Good: .9 and .2; bad: .3 and .1. Of four couples (.2, .3) is out of order.
        assert_eq!([Bad::Everywhere, Bad::Solid, Bad::Sky].map(area), [Some(0.75), Some(1.0), Some(1.0)]);
        assert_eq!(score.bad(), 0.5);
    }

    #[test]
    fn without_bad_or_good_pixels_there_is_no_curve() {
        let good = ConfidenceScore::new(&[(0.5, 0.1, false)]).unwrap();
        let bad = ConfidenceScore::new(&[(0.5, 0.6, false)]).unwrap();
        for score in [&good, &bad] {
            assert_eq!([Bad::Everywhere, Bad::Solid, Bad::Sky].map(|of| score.roc(of)), [None, None, None]);
        }
        assert_eq!(ConfidenceScore::new(&[]), None);
        let mut both = good;
        both.merge(&bad);
        assert_eq!(both.roc(Bad::Everywhere).map(|roc| roc.area()), Some(0.5));
    }

    #[test]
    fn numbers_out_of_range_and_nan_are_at_the_ends() {
        let pixels = [(f32::NAN, 9.0, false), (-3.0, 9.0, false), (7.0, 0.0, false), (1.0, f64::NAN, false)];
        let score = ConfidenceScore::new(&pixels).unwrap();
        assert_eq!((score.solid.bad[0], score.solid.bad[BINS - 1], score.solid.good[BINS - 1]), (2, 1, 1));
    }
}
