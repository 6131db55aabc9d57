//! The ports of a plan: what the host writes before a run and reads after one.

use super::BufId;
use crate::error::{Error, Result};
use crate::frame::{FlowField, Frame, PixelFormat, Plane, Size};

/// A place where the host writes into a plan or reads from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    /// The name by which it is addressed, for example `frame`.
    pub name: &'static str,
    /// What its values are.
    pub kind: PortKind,
    /// Its buffers, by the parity of the frame that is being computed.
    pub bufs: [BufId; 2],
    /// What an input holds when the host gives nothing. Of an output it means nothing.
    pub if_absent: Fill,
}

/// What the values of a port are, on the host and in the buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PortKind {
    /// The bytes of a frame. In the buffer every row begins at a whole word of four bytes.
    Frame {
        /// The frame's size.
        size: Size,
        /// The frame's format.
        format: PixelFormat,
    },
    /// One value per pixel.
    Plane {
        /// The plane's size.
        size: Size,
        /// The range that an input's values are clamped to; NaN becomes its lower end. None leaves them as they are.
        range: Option<[f32; 2]>,
    },
    /// A displacement per pixel, in pixels. An unknown one goes in as zero.
    Flow {
        /// The field's size.
        size: Size,
    },
    /// Values as they lie in the buffer.
    Raw {
        /// How many. An input may be shorter: it then replaces the first values only.
        len: usize,
    },
}

/// What an input holds when the host gives nothing.
#[derive(Clone, Debug, PartialEq)]
pub enum Fill {
    /// The host must give it every time.
    Required,
    /// One value everywhere.
    Value(f32),
    /// These values, as many as the buffer holds.
    Values(Vec<f32>),
    /// What stands in the buffer: what the previous run has left there.
    Keep,
}

/// What the host writes to an input.
#[derive(Clone, Copy, Debug)]
pub enum Value<'a> {
    /// For [`PortKind::Frame`].
    Frame(&'a Frame<'a>),
    /// For [`PortKind::Plane`].
    Plane(&'a Plane),
    /// For [`PortKind::Flow`].
    Flow(&'a FlowField),
    /// For [`PortKind::Raw`].
    Raw(&'a [f32]),
}

/// What an input is called, and what is written to it; nothing leaves it to [`Port::if_absent`].
pub type Given<'a> = (&'static str, Option<Value<'a>>);

impl Port {
    /// A port with the same buffer for both parities.
    pub fn new(name: &'static str, kind: PortKind, buf: BufId, if_absent: Fill) -> Self {
        Self { name, kind, bufs: [buf; 2], if_absent }
    }

    /// An output with the same buffer for both parities.
    pub fn output(name: &'static str, kind: PortKind, buf: BufId) -> Self {
        Self::new(name, kind, buf, Fill::Keep)
    }

    /// What is given for this port.
    pub(crate) fn among<'v>(&self, given: &[Given<'v>]) -> Option<Value<'v>> {
        given.iter().find(|(name, _)| *name == self.name).and_then(|(_, value)| *value)
    }

    /// Checks that a value is of the port's kind and fits it.
    ///
    /// # Errors
    /// [`Error::PixelFormat`], [`Error::SizeMismatch`] or [`Error::Length`] for a value that does not fit,
    /// [`Error::Parameter`] for one of another kind.
    pub fn check(&self, value: &Value<'_>) -> Result<()> {
        let same_size = |found: Size, expected: Size| match found == expected {
            true => Ok(()),
            false => Err(Error::SizeMismatch { what: self.name.replace('_', " "), found, expected }),
        };
        match (self.kind, value) {
            (PortKind::Frame { size, format }, Value::Frame(frame)) => {
                same_size(frame.size(), size)?;
                match frame.format() == format {
                    true => Ok(()),
                    false => Err(Error::PixelFormat { found: frame.format(), expected: format }),
                }
            }
            (PortKind::Plane { size, .. }, Value::Plane(plane)) => {
                plane.validate()?;
                same_size(plane.size, size)
            }
            (PortKind::Flow { size }, Value::Flow(field)) => {
                field.validate()?;
                same_size(field.size, size)
            }
            (PortKind::Raw { len }, Value::Raw(values)) => match values.len() <= len {
                true => Ok(()),
                false => Err(Error::Length { what: self.name, found: values.len(), expected: len }),
            },
            (kind, _) => Err(Error::parameter(self.name, value.noun(), kind.noun())),
        }
    }
}

impl PortKind {
    /// Its length in the buffer, in `f32`.
    pub fn len(&self) -> usize {
        match *self {
            Self::Frame { size, format } => format.row_words(size.width) * size.height as usize,
            Self::Plane { size, .. } => super::Shape::planar(size, 1).len(),
            Self::Flow { size } => super::Shape::planar(size, 2).len(),
            Self::Raw { len } => len,
        }
    }

    /// Whether it holds nothing.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn noun(&self) -> &'static str {
        match self {
            Self::Frame { .. } => "a frame",
            Self::Plane { .. } => "a plane",
            Self::Flow { .. } => "a flow field",
            Self::Raw { .. } => "raw values",
        }
    }
}

impl Value<'_> {
    fn noun(&self) -> &'static str {
        match self {
            Self::Frame(_) => "a frame",
            Self::Plane(_) => "a plane",
            Self::Flow(_) => "a flow field",
            Self::Raw(_) => "raw values",
        }
    }
}
