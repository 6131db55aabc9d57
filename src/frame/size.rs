use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// Width and height of a picture in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Size {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Size {
    /// The largest side that is accepted, in pixels. It keeps every index of a picture within 32 bits.
    pub const MAX_SIDE: u32 = 16384;

    /// A size, unchecked. See [`Size::validate`].
    pub const fn new(width: u32, height: u32) -> Self {
        Self { width, height }
    }

    /// Checks that both sides are between 1 and [`Size::MAX_SIDE`].
    pub fn validate(self) -> Result<Self> {
        let side = 1..=Self::MAX_SIDE;
        if side.contains(&self.width) && side.contains(&self.height) {
            return Ok(self);
        }
        Err(Error::parameter("size", self, format_args!("1×1 to {0}×{0}", Self::MAX_SIDE)))
    }

    /// Number of pixels.
    pub const fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Width of a row of a computed plane: [`Size::width`] rounded up to a multiple of 4.
    pub const fn stride(self) -> usize {
        (self.width as usize).next_multiple_of(4)
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}×{}", self.width, self.height)
    }
}

/// Reads `640x480` (also with `X` or `×`).
impl FromStr for Size {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::parameter("size", text, "WIDTHxHEIGHT, for example 640x480");
        let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
        let side = |t: &str| t.trim().parse::<u32>().map_err(|_| wrong());
        Self::new(side(width)?, side(height)?).validate()
    }
}
