use super::{PixelFormat, Size};
use crate::error::{Error, Result};

/// An image borrowed from the caller; this type never copies it.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    size: Size,
    format: PixelFormat,
    stride_bytes: usize,
    data: &'a [u8],
}

impl<'a> Frame<'a> {
    /// A frame whose rows follow each other without padding: `data` holds `size.pixels() * format.bytes()` bytes, row
    /// by row.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a size out of range, [`Error::Length`] if `data` does not have exactly the length
    /// that size and format require.
    pub fn new(size: Size, format: PixelFormat, data: &'a [u8]) -> Result<Self> {
        size.validate()?;
        let expected = size.pixels() * format.bytes();
        if data.len() != expected {
            return Err(Error::Length { what: "frame data", found: data.len(), expected });
        }
        Self::with_stride(size, format, size.width as usize * format.bytes(), data)
    }

    /// A frame whose rows start `stride_bytes` apart in `data`. The last row may end early, at its last pixel.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a size out of range or a stride below one row, [`Error::Length`] if `data` is too
    /// short.
    pub fn with_stride(size: Size, format: PixelFormat, stride_bytes: usize, data: &'a [u8]) -> Result<Self> {
        size.validate()?;
        let row = size.width as usize * format.bytes();
        if stride_bytes < row {
            return Err(Error::parameter("stride_bytes", stride_bytes, format_args!("at least {row}")));
        }
        let short = || Error::parameter("stride_bytes", stride_bytes, "a stride that fits the address space");
        let above = stride_bytes.checked_mul(size.height as usize - 1).ok_or_else(short)?;
        let expected = above.checked_add(row).ok_or_else(short)?;
        if data.len() < expected {
            return Err(Error::Length { what: "frame data", found: data.len(), expected });
        }
        Ok(Self { size, format, stride_bytes, data })
    }

    /// Width and height.
    pub fn size(&self) -> Size {
        self.size
    }

    /// How a pixel is stored.
    pub fn format(&self) -> PixelFormat {
        self.format
    }

    /// The bytes of row `y`, without the padding between rows.
    ///
    /// # Panics
    /// If `y` is not below the height.
    pub fn row(&self, y: u32) -> &'a [u8] {
        assert!(y < self.size.height, "row {y} of a frame of {}", self.size);
        let start = y as usize * self.stride_bytes;
        &self.data[start..start + self.size.width as usize * self.format.bytes()]
    }
}

/// An image that owns its bytes, with rows without padding: the result of the file readers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width and height.
    pub size: Size,
    /// How a pixel is stored.
    pub format: PixelFormat,
    /// `size.pixels() * format.bytes()` bytes, row by row.
    pub data: Vec<u8>,
}

/// An image without pixels, for a reader to fill. It is not a valid frame before that.
impl Default for Image {
    fn default() -> Self {
        Self { size: Size::new(0, 0), format: PixelFormat::Gray8, data: Vec::new() }
    }
}

impl Image {
    /// The image as a borrowed frame.
    ///
    /// # Errors
    /// As in [`Frame::new`], if the fields contradict each other.
    pub fn frame(&self) -> Result<Frame<'_>> {
        Frame::new(self.size, self.format, &self.data)
    }
}

/// A plane of one `f32` per pixel, with rows without padding: a certainty, a confidence, a depth.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Plane {
    /// Width and height.
    pub size: Size,
    /// `size.pixels()` values, row by row.
    pub data: Vec<f32>,
}

impl Plane {
    /// Checks that size and data agree.
    pub fn validate(&self) -> Result<()> {
        self.size.validate()?;
        let expected = self.size.pixels();
        if self.data.len() != expected {
            return Err(Error::Length { what: "plane data", found: self.data.len(), expected });
        }
        Ok(())
    }
}

/// The value written for an unknown flow component. On reading, NaN and any magnitude over 1e9 count as unknown.
pub const UNKNOWN_FLOW: f32 = 1.666_667e9;

/// Displacements in pixels from one frame to the next: x to the right, y down, with rows without padding.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowField {
    /// Width and height.
    pub size: Size,
    /// `size.pixels()` pairs `[u, v]`, row by row.
    pub data: Vec<[f32; 2]>,
}

impl FlowField {
    /// Checks that size and data agree.
    pub fn validate(&self) -> Result<()> {
        self.size.validate()?;
        let expected = self.size.pixels();
        if self.data.len() != expected {
            return Err(Error::Length { what: "flow data", found: self.data.len(), expected });
        }
        Ok(())
    }

    /// Whether a displacement is known: finite, and no component over 1e9 in magnitude (the Middlebury convention).
    pub fn is_known(flow: [f32; 2]) -> bool {
        flow.iter().all(|c| c.abs() <= 1e9)
    }
}
