//! Random numbers that are identical on every machine.

use std::f64::consts::{LN_2, SQRT_2};

/// The increment of SplitMix64's state: 2^64 over the golden ratio, made odd.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// A random number generator: SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators",
/// 2014). Its period is 2^64.
///
/// A seed gives the same bits on every machine: only integers, the four operations and square roots, whose results
/// IEEE 754 defines exactly, are used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The generator of a seed. All seeds are equally good, including 0 and 1.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next 64 bits.
    pub fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(STEP);
        mix(self.state)
    }

    /// A uniform number in [0, 1): a multiple of 2⁻⁵³.
    pub fn uniform(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// A uniform number from the first to the second; the second itself only by rounding.
    pub fn within(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// A number from the standard normal distribution, by Marsaglia's polar method.
    ///
    /// It uses two or more numbers of the generator. The method's second result is not kept, so that the next number
    /// depends on the state alone.
    pub fn normal(&mut self) -> f64 {
        loop {
            let (x, y) = (self.within([-1.0, 1.0]), self.within([-1.0, 1.0]));
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                return x * (-2.0 * ln(square) / square).sqrt();
            }
        }
    }

    /// A number from the exponential distribution of mean 1: the gap between points of density 1.
    pub fn exponential(&mut self) -> f64 {
        -ln(1.0 - self.uniform())
    }

    /// An independent generator for stream number `stream`. This one stays unchanged, so that an additional stream
    /// changes no other numbers.
    pub fn fork(&self, stream: u64) -> Self {
        Self { state: mix(self.state ^ mix(stream.wrapping_add(STEP))) }
    }
}

/// The finaliser of SplitMix64: David Stafford's 13th variant of that of MurmurHash3.
fn mix(bits: u64) -> u64 {
    let bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ bits >> 31
}

/// The natural logarithm of a normal number above 0. The standard library's differs between platforms in the last
/// bit.
fn ln(x: f64) -> f64 {
    let bits = x.to_bits();
    let (mut exponent, mut mantissa) =
        ((bits >> 52) as i32 - 1023, f64::from_bits(bits & (u64::MAX >> 12) | 1023 << 52));
    if mantissa > SQRT_2 {
        (exponent, mantissa) = (exponent + 1, mantissa / 2.0);
    }
    // ln m = 2 artanh s, of which 11 terms leave less than 2⁻⁵³ where |s| ≤ 0.172.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let series = (0..11).rev().fold(0.0, |sum, i| sum * s * s + 1.0 / f64::from(2 * i + 1));
    f64::from(exponent) * LN_2 + 2.0 * s * series
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean, variance, skewness and excess kurtosis.
    fn moments(values: &[f64]) -> [f64; 4] {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let central = |power| values.iter().map(|value| (value - mean).powi(power)).sum::<f64>() / n;
        let variance = central(2);
        [mean, variance, central(3) / variance.powf(1.5), central(4) / (variance * variance) - 3.0]
    }

    fn close(found: [f64; 4], expected: [f64; 4], deviations: [f64; 4]) {
        for i in 0..4 {
            // Five standard deviations of the estimate: one in two million.
            let bound = 5.0 * deviations[i];
            assert!((found[i] - expected[i]).abs() <= bound, "{found:?}, expected {expected:?}");
        }
    }

    #[test]
    fn the_bits_are_those_of_splitmix64() {
        // The published vectors of the seed 1234567.
        let mut random = Random::new(1_234_567);
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!(std::array::from_fn(|_| random.next_u64()), expected);
    }

    #[test]
    fn uniform_numbers_have_the_moments_of_their_distribution() {
        let mut random = Random::new(1);
        let values: Vec<f64> = (0..200_000).map(|_| random.within([-1.0, 3.0])).collect();
        assert!(values.iter().all(|value| (-1.0..=3.0).contains(value)));
        let n = values.len() as f64;
        let deviations = [1.155, 1.19, 1.5, 1.2].map(|one| one / n.sqrt());
        close(moments(&values), [1.0, 16.0 / 12.0, 0.0, -1.2], deviations);
    }

    #[test]
    fn normal_numbers_have_the_moments_and_the_tails_of_their_distribution() {
        let mut random = Random::new(2);
        let values: Vec<f64> = (0..200_000).map(|_| random.normal()).collect();
        let n = values.len() as f64;
        // The variances of the estimates: 1/n, 2/n, 6/n, 24/n.
        close(moments(&values), [0.0, 1.0, 0.0, 0.0], [1.0_f64, 2.0, 6.0, 24.0].map(|v| (v / n).sqrt()));
        let beyond = values.iter().filter(|value| value.abs() > 3.0).count() as f64 / n;
        assert!((beyond - 0.0027).abs() <= 5.0 * (0.0027 / n).sqrt(), "{beyond} beyond three deviations");
    }

    #[test]
    fn exponential_numbers_have_the_moments_of_their_distribution() {
        let mut random = Random::new(3);
        let values: Vec<f64> = (0..200_000).map(|_| random.exponential()).collect();
        let [mean, variance, ..] = moments(&values);
        let n = values.len() as f64;
        assert!((mean - 1.0).abs() <= 5.0 / n.sqrt(), "mean {mean}");
        assert!((variance - 1.0).abs() <= 5.0 * (8.0 / n).sqrt(), "variance {variance}");
    }

    #[test]
    fn the_logarithm_is_that_of_the_library() {
        let mut random = Random::new(4);
        for i in 0..10_000 {
            let x = random.uniform().max(1e-300) * 2.0_f64.powi(-(i % 60));
            // Both round; this one a few times.
            let difference = (ln(x) - x.ln()).abs();
            assert!(
                difference <= 4.0 * f64::EPSILON * x.ln().abs().max(f64::MIN_POSITIVE),
                "{x}: {difference}"
            );
        }
        assert_eq!(ln(1.0), 0.0);
    }

    #[test]
    fn forks_differ_and_leave_the_trunk_alone() {
        let mut random = Random::new(5);
        let before = random.clone();
        let firsts: Vec<u64> = (0..1000).map(|stream| random.fork(stream).next_u64()).collect();
        assert_eq!(random, before);
        let mut sorted = firsts.clone();
        sorted.push(random.next_u64());
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), 1001);
        assert_eq!(firsts[7], before.fork(7).next_u64());
        // The same stream of neighbouring seeds: half of their bits agree.
        let alike: u32 = (0..1000)
            .map(|seed| {
                let [a, b] = [seed, seed + 1].map(|seed| Random::new(seed).fork(0).next_u64());
                (a ^ b).count_zeros()
            })
            .sum();
        assert!((f64::from(alike) - 32_000.0).abs() <= 5.0 * 16_000.0_f64.sqrt(), "{alike} of 64000");
    }

    #[test]
    fn the_numbers_of_a_seed_stay_what_they_are() {
        let mut random = Random::new(42);
        let found = [random.uniform(), random.within([2.0, 5.0]), random.normal(), random.exponential()];
        assert_eq!(found, [0.7415648787718233, 2.47973117863076, -1.2810773478777024, 0.03877218903711899]);
    }
}
