//! The buffers of a plan, and the layout of images in them.

use crate::frame::Size;

/// The number of a buffer of a [`Plan`](super::Plan).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BufId(pub(super) usize);

impl BufId {
    /// The index of the buffer in [`Plan::bufs`](super::Plan::bufs).
    pub fn index(self) -> usize {
        self.0
    }
}

/// A buffer of `f32` values.
#[derive(Clone, Debug)]
pub struct Buf {
    /// A description of the contents, for messages.
    pub name: String,
    /// The length, in `f32` values.
    pub len: usize,
    /// The origin of its values.
    pub content: Content,
}

/// The origin of a buffer's values.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// The caller writes them for each frame.
    Input,
    /// They never change.
    Constant(Vec<f32>),
    /// Steps compute them. They begin as zeros.
    Computed,
}

/// The layout of an image in a buffer: row 0 of each channel, then row 1 of each channel, and so on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Width and height of the image.
    pub size: Size,
    /// Number of channels. Each row holds that row of every channel, one after the other.
    pub channels: usize,
    /// Values of a pixel that lie side by side within a channel: 1, or 4 for four values per pixel.
    pub values: usize,
}

impl Shape {
    /// Channels with one value per pixel.
    pub const fn planar(size: Size, channels: usize) -> Self {
        Self { size, channels, values: 1 }
    }

    /// One channel with four values per pixel, side by side.
    pub const fn quads(size: Size) -> Self {
        Self { size, channels: 1, values: 4 }
    }

    /// The length, in `f32` values.
    pub const fn len(self) -> usize {
        self.size.stride() * self.values * self.channels * self.size.height as usize
    }

    /// Whether the length is 0, which no valid size has.
    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Column, row and channel of the value at an index.
    pub fn place(self, index: usize) -> [usize; 3] {
        let row = self.size.stride() * self.values;
        let (line, within) = (index / row, index % row);
        [
            within / self.values,
            line / self.channels,
            line % self.channels * self.values + within % self.values,
        ]
    }
}

/// Builds the list of a plan's buffers.
#[derive(Debug, Default)]
pub struct Bufs(Vec<Buf>);

impl Bufs {
    /// Adds a buffer that the caller writes.
    pub fn input(&mut self, name: impl Into<String>, len: usize) -> BufId {
        self.add(name, len, Content::Input)
    }

    /// Adds a buffer of constant values.
    pub fn constant(&mut self, name: impl Into<String>, values: Vec<f32>) -> BufId {
        self.add(name, values.len(), Content::Constant(values))
    }

    /// Adds a buffer that steps write.
    pub fn computed(&mut self, name: impl Into<String>, shape: Shape) -> BufId {
        self.add(name, shape.len(), Content::Computed)
    }

    /// The finished list of buffers.
    pub fn finish(self) -> Vec<Buf> {
        self.0
    }

    fn add(&mut self, name: impl Into<String>, len: usize, content: Content) -> BufId {
        self.0.push(Buf { name: name.into(), len, content });
        BufId(self.0.len() - 1)
    }
}
