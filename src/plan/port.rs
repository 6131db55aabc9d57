//! The ports of a plan: where the host writes before a run and reads after it.

use super::BufId;
use crate::error::{Error, Result};
use crate::frame::{FlowField, Frame, PixelFormat, Plane, Size};

/// A named place where the host writes into a plan or reads from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    /// The name, for example `frame`.
    pub name: &'static str,
    /// The kind of its values.
    pub kind: PortKind,
    /// Its buffers, by the parity of the frame that is computed.
    pub bufs: [BufId; 2],
    /// The values of an input for which the host gives none. Without meaning for an output.
    pub if_absent: Fill,
}

/// The kind of a port's values, on the host and in the buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PortKind {
    /// The bytes of a frame. In the buffer every row begins at a multiple of four bytes.
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
        /// The range to which an input's values are clamped; NaN becomes its lower end. `None` leaves the values
        /// unchanged.
        range: Option<[f32; 2]>,
    },
    /// A displacement per pixel, in pixels. An unknown one becomes zero.
    Flow {
        /// The field's size.
        size: Size,
    },
    /// Values in the layout of the buffer.
    Raw {
        /// The number of values. An input may be shorter: it then replaces the first values only.
        len: usize,
    },
}

/// The values of an input for which the host gives none.
#[derive(Clone, Debug, PartialEq)]
pub enum Fill {
    /// None: the host must give values for every frame.
    Required,
    /// The same value everywhere.
    Value(f32),
    /// These values, as many as the buffer holds.
    Values(Vec<f32>),
    /// The buffer's values, as the previous run has left them.
    Keep,
}

/// A value that the host writes to an input.
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

/// The name of an input and its value; without a value [`Port::if_absent`] applies.
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

    /// The value that is given for this port.
    pub(crate) fn among<'v>(&self, given: &[Given<'v>]) -> Option<Value<'v>> {
        given.iter().find(|(name, _)| *name == self.name).and_then(|(_, value)| *value)
    }

    /// Checks that a value has the port's kind and size.
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
    /// The length in the buffer, in `f32` values.
    pub fn len(&self) -> usize {
        match *self {
            Self::Frame { size, format } => format.row_words(size.width) * size.height as usize,
            Self::Plane { size, .. } => super::Shape::planar(size, 1).len(),
            Self::Flow { size } => super::Shape::planar(size, 2).len(),
            Self::Raw { len } => len,
        }
    }

    /// Whether the length is 0.
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
