//! Synthetic images for the comparison of the two sides of a kernel.

use crate::frame::Size;
use crate::kernel::Case;
use crate::plan::pack;

/// The content of a synthetic image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// One value everywhere.
    Flat,
    /// Independent random values: every sample matters.
    Textured,
    /// The ends of the legal range, side by side.
    Extreme,
    /// Textured, with one sample in fifty NaN.
    Nan,
}

impl Fill {
    /// All contents.
    pub const ALL: &'static [Self] = &[Self::Flat, Self::Textured, Self::Extreme, Self::Nan];

    /// The contents without NaN, for kernels whose inputs never contain it.
    pub const NUMBERS: &'static [Self] = &[Self::Flat, Self::Textured, Self::Extreme];

    /// The next value of an image whose legal values are from `low` to `high`.
    fn value(self, random: &mut Random, low: f32, high: f32) -> f32 {
        let share = random.next();
        match self {
            Self::Flat => low + 0.7 * (high - low),
            Self::Textured => low + share * (high - low),
            Self::Extreme if share < 0.5 => low,
            Self::Extreme => high,
            Self::Nan if share < 0.02 => f32::NAN,
            Self::Nan => low + share * (high - low),
        }
    }
}

/// A reproducible source of numbers in `0 ≤ x < 1` (xorshift, Marsaglia 2003).
#[derive(Clone, Debug)]
pub struct Random(u32);

impl Random {
    /// Starts a sequence; equal seeds give equal numbers.
    pub fn new(seed: u32) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9) | 1)
    }

    /// The next number.
    #[allow(clippy::should_implement_trait, reason = "it never ends, so an Option would be in the way")]
    pub fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (self.0 >> 8) as f32 / (1 << 24) as f32
    }
}

/// An image of several channels with values from `low` to `high`; the surplus of each row repeats its last pixel.
pub fn planes(size: Size, channels: usize, fill: Fill, [low, high]: [f32; 2], seed: u32) -> Vec<f32> {
    let mut random = Random::new(seed);
    let rows = Size::new(size.width, channels as u32 * size.height);
    pack::padded_groups(rows, |_, _| [fill.value(&mut random, low, high)])
}

/// An image of four values per pixel, side by side in memory, each with its own range.
pub fn quads(size: Size, fill: Fill, ranges: [[f32; 2]; 4], seed: u32) -> Vec<f32> {
    let mut random = Random::new(seed);
    pack::padded_groups(size, |_, _| ranges.map(|[low, high]| fill.value(&mut random, low, high)))
}

/// One case per content for kernels that read one gray image, then tables. `rows` are the row lengths of the outputs.
pub fn gray_cases(
    size: Size,
    fills: &[Fill],
    params: &[u8],
    tables: &[Vec<f32>],
    rows: &[usize],
    extent: Size,
) -> Vec<Case> {
    cases(fills, params, rows, extent, |fill| {
        let mut inputs = vec![planes(size, 1, fill, [0.0, 65535.0], 7)];
        inputs.extend(tables.iter().cloned());
        inputs
    })
}

/// One case per content, with the inputs that `inputs` makes. `rows` are the row lengths of the outputs.
pub fn cases(
    fills: &[Fill],
    params: &[u8],
    rows: &[usize],
    extent: Size,
    inputs: impl Fn(Fill) -> Vec<Vec<f32>>,
) -> Vec<Case> {
    fills
        .iter()
        .map(|&fill| Case {
            name: format!("{fill:?}").to_lowercase(),
            params: params.to_vec(),
            inputs: inputs(fill),
            outputs: rows.iter().map(|row| row * extent.height as usize).collect(),
            extent,
        })
        .collect()
}
