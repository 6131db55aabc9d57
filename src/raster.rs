//! An image's size and pixel format, on which even [`crate::error`] depends. [`crate::frame`] exports them to users.

use std::fmt;

/// Width and height of an image, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Size {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Size {
    /// The largest side that is accepted, in pixels. It keeps every index into an image within 32 bits.
    pub const MAX_SIDE: u32 = 16384;

    /// A size, unchecked. See [`Size::validate`].
    pub const fn new(width: u32, height: u32) -> Self {
        Self { width, height }
    }

    /// Number of pixels.
    pub const fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Whether a point `[x, y]` in pixels lies between the centres of the image's pixels, those included. NaN does not.
    pub fn contains(self, [x, y]: [f32; 2]) -> bool {
        let within = |at: f32, side: u32| at >= 0.0 && at <= side as f32 - 1.0;
        within(x, self.width) && within(y, self.height)
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

/// The storage of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum PixelFormat {
    /// One byte, 0 to 255.
    Gray8,
    /// Two bytes in the machine's byte order, 0 to 65535. White corresponds to 255 in 8 bits; values between keep their
    /// fractions.
    Gray16,
    /// Three bytes: red, green, blue.
    Rgb8,
    /// Four bytes: red, green, blue, and alpha, which is ignored.
    Rgba8,
}

impl PixelFormat {
    /// Bytes of one pixel.
    pub const fn bytes(self) -> usize {
        match self {
            Self::Gray8 => 1,
            Self::Gray16 => 2,
            Self::Rgb8 => 3,
            Self::Rgba8 => 4,
        }
    }

    /// Four-byte words per row in a plan's buffer: every row begins at a whole word.
    pub const fn row_words(self, width: u32) -> usize {
        (width as usize * self.bytes()).div_ceil(4)
    }
}

impl fmt::Display for PixelFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gray8 => "gray8",
            Self::Gray16 => "gray16",
            Self::Rgb8 => "rgb8",
            Self::Rgba8 => "rgba8",
        })
    }
}
