//! The buffers of a plan, and how pictures lie in them.

use crate::frame::Size;

/// A buffer of a [`Plan`](super::Plan), by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BufId(pub(super) usize);

impl BufId {
    /// The buffer's place in [`Plan::bufs`](super::Plan::bufs).
    pub fn index(self) -> usize {
        self.0
    }
}

/// A buffer of `f32`.
#[derive(Clone, Debug)]
pub struct Buf {
    /// What it holds, for messages.
    pub name: String,
    /// Its length in `f32`.
    pub len: usize,
    /// Where its values come from.
    pub content: Content,
}

/// Where a buffer's values come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// The caller writes them, frame by frame.
    Input,
    /// They never change.
    Constant(Vec<f32>),
    /// Steps compute them. They begin as zeros.
    Computed,
}

/// How the values of a picture lie in a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Width and height of the picture.
    pub size: Size,
    /// Channels, row by row in turn.
    pub channels: usize,
    /// Values of one channel side by side: 1, or 4 where a pixel's four values are neighbours.
    pub values: usize,
}

impl Shape {
    /// Rows of single values.
    pub const fn planar(size: Size, channels: usize) -> Self {
        Self { size, channels, values: 1 }
    }

    /// Rows of pixels of four values.
    pub const fn quads(size: Size) -> Self {
        Self { size, channels: 1, values: 4 }
    }

    /// Length in `f32`.
    pub const fn len(self) -> usize {
        self.size.stride() * self.values * self.channels * self.size.height as usize
    }

    /// Whether nothing is in it, which a valid size rules out.
    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Column, row and channel of a value.
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

/// Collects the buffers of a plan.
#[derive(Debug, Default)]
pub struct Bufs(Vec<Buf>);

impl Bufs {
    /// A buffer that the caller writes.
    pub fn input(&mut self, name: impl Into<String>, len: usize) -> BufId {
        self.add(name, len, Content::Input)
    }

    /// A buffer that never changes.
    pub fn constant(&mut self, name: impl Into<String>, values: Vec<f32>) -> BufId {
        self.add(name, values.len(), Content::Constant(values))
    }

    /// A buffer that steps write.
    pub fn computed(&mut self, name: impl Into<String>, shape: Shape) -> BufId {
        self.add(name, shape.len(), Content::Computed)
    }

    /// All of them.
    pub fn finish(self) -> Vec<Buf> {
        self.0
    }

    fn add(&mut self, name: impl Into<String>, len: usize, content: Content) -> BufId {
        self.0.push(Buf { name: name.into(), len, content });
        BufId(self.0.len() - 1)
    }
}
