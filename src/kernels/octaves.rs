//! The unbounded texture of the simulator, for several neighbouring pixels at once.

use super::hash::scrambled;
use super::surface_layout::{LANES, Lanes, pick};

const OCTAVES: u32 = 11;
const AMPLITUDE: f32 = 50.0;
const FULL_LOG2: f32 = 1.5;

/// The places of pixels on a texture.
pub(super) struct Places {
    /// Metres beyond the cells, or turns if there is a period.
    pub(super) u: Lanes,
    /// Metres beyond the cells.
    pub(super) v: Lanes,
    /// Whole grid spacings of the coarsest octave along u.
    pub(super) cells_u: [i32; LANES],
    /// The same along v.
    pub(super) cells_v: [i32; LANES],
    /// Metres after which the texture repeats along u, or 0.
    pub(super) period: Lanes,
    pub(super) seed: [u32; LANES],
    /// Logarithm to base 2 of the metres that a pixel covers.
    pub(super) footprint: Lanes,
}

/// Gray levels around 128.
#[inline(always)]
pub(super) fn textured(places: &Places) -> Lanes {
    let mut sum = [128.0; LANES];
    for octave in 0..OCTAVES {
        let shares: Lanes = std::array::from_fn(|lane| {
            (2.0 - octave as f32 - places.footprint[lane] - FULL_LOG2 + 1.0).clamp(0.0, 1.0)
        });
        if !shares.iter().any(|share| *share > 0.0) {
            break;
        }
        for lane in 0..LANES {
            let share = shares[lane];
            let value = value(places, octave, lane);
            sum[lane] += AMPLITUDE * (share * share * (3.0 - 2.0 * share)) * (value / 8_388_608.0 - 1.0);
        }
    }
    sum
}

#[inline(always)]
fn value(places: &Places, octave: u32, lane: usize) -> f32 {
    let per_metre = 0.25 * (1 << octave) as f32;
    let period = places.period[lane];
    let around = period > 0.0;
    // A period contains a whole number of grid points.
    let points = (period * per_metre + 0.5).floor().max(1.0);
    let turn = pick(around, 1.0 / points, 0.0);
    let (u, v) = (places.u[lane] * pick(around, points, per_metre), places.v[lane] * per_metre);
    let (column, row) = (u.floor(), v.floor());
    let (x, y) = (spline(u - column), spline(v - row));
    let base = places.cells_u[lane] << octave;
    let columns: [u32; 4] = std::array::from_fn(|i| {
        let step = column + (i as f32 - 1.0);
        let wrapped = step - points * ((step + 0.5) * turn).floor();
        whole(wrapped).wrapping_add(base) as u32
    });
    let row = whole(row).wrapping_add(places.cells_v[lane] << octave);
    let seed = scrambled(places.seed[lane] ^ scrambled(octave));
    let mut sum = 0.0;
    for (j, weight) in y.into_iter().enumerate() {
        let seed = scrambled(seed ^ row.wrapping_add(j as i32 - 1) as u32);
        let random = columns.map(|column| (scrambled(seed ^ column) >> 8) as i32 as f32);
        sum += weight * (x[0] * random[0] + x[1] * random[1] + x[2] * random[2] + x[3] * random[3]);
    }
    sum
}

/// A whole number within ±2²² as an integer: a conversion that handles all numbers has no vector instruction.
#[inline(always)]
pub(super) fn whole(number: f32) -> i32 {
    const SHIFT: f32 = 12_582_912.0;
    (number + SHIFT).to_bits().wrapping_sub(SHIFT.to_bits()) as i32
}

/// The weights of the four grid points around a place.
#[inline(always)]
fn spline(t: f32) -> [f32; 4] {
    let s = 1.0 - t;
    [s * s * s, (3.0 * t - 6.0) * t * t + 4.0, (3.0 * s - 6.0) * s * s + 4.0, t * t * t]
        .map(|w| w * (1.0 / 6.0))
}

/// log₂ by the series of the area tangent, to 1e-7, as the shader has it.
#[inline(always)]
pub(super) fn log2_of(value: f32) -> f32 {
    let shifted = value.to_bits().wrapping_add(0x3f80_0000 - 0x3f35_04f3);
    let exponent = (shifted >> 23) as i32 - 127;
    let mantissa = f32::from_bits((shifted & 0x007f_ffff) + 0x3f35_04f3);
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let q = s * s;
    exponent as f32 + s * (2.885_39 + q * (0.961_796_7 + q * (0.577_078 + q * 0.412_198_6)))
}

/// The angle of a place about the origin, in turns from −½ to ½, to 4e-8.
#[inline(always)]
pub(super) fn turns(x: f32, y: f32) -> f32 {
    const ATAN: [f32; 7] =
        [0.159_154_33, -0.053_026_24, 0.031_525_12, -0.021_061_51, 0.012_672_5, -0.005_348_27, 0.001_084_13];
    let (a, b) = (x.abs(), y.abs());
    let t = pick(a < b, a, b) / pick(a > b, a, b).max(1e-30);
    let q = t * t;
    let octant = t * ATAN.into_iter().rev().fold(0.0, |sum, term| term + q * sum);
    let quadrant = pick(b > a, 0.25 - octant, octant);
    let half = pick(x < 0.0, 0.5 - quadrant, quadrant);
    pick(y < 0.0, -half, half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithm_and_angle_are_those_of_the_library() {
        for i in 0..20_000_u32 {
            let value = (f64::from(i) * 0.003 - 30.0).exp() as f32;
            let expected = f64::from(value).log2();
            let found = f64::from(log2_of(value));
            assert!((found - expected).abs() < 2e-7 * (1.0 + expected.abs()), "{value}: {found}");
            for number in [i as i32, -(i as i32), 200 * i as i32, -200 * i as i32] {
                assert_eq!(whole(number as f32), number);
            }
            let angle = f64::from(i) * 3e-4;
            let (x, y) = ((3.0 * angle.cos()) as f32, (3.0 * angle.sin()) as f32);
            let expected = f64::from(y).atan2(f64::from(x)) / std::f64::consts::TAU;
            assert!((f64::from(turns(x, y)) - expected).abs() < 1.2e-7, "{angle}");
        }
    }
}
