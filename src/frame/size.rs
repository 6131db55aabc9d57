use std::str::FromStr;

use super::Size;
use crate::error::{Error, Result};

impl Size {
    /// Checks that both sides are between 1 and [`Size::MAX_SIDE`].
    ///
    /// # Errors
    /// [`Error::Parameter`] if one is not.
    pub fn validate(self) -> Result<Self> {
        let side = 1..=Self::MAX_SIDE;
        if side.contains(&self.width) && side.contains(&self.height) {
            return Ok(self);
        }
        Err(Error::parameter("size", self, format_args!("1×1 to {0}×{0}", Self::MAX_SIDE)))
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
