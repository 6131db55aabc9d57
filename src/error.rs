//! The errors of this crate. Every message is one line that names the thing, the value found and what was expected.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use crate::raster::{PixelFormat, Size};

/// The result type of every fallible call of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Every error of this crate.
///
/// The variants carry both values where two are compared, so that a caller can act on them without reading the text.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be opened, read, written or renamed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file, or a name such as `standard input`.
        path: PathBuf,
        /// The operating system's error.
        source: std::io::Error,
    },
    /// A file was read, but its content is not what its format demands.
    #[error("{}: {what} is {found}, expected {expected}", path.display())]
    Format {
        /// The file, or a name such as `standard input`.
        path: PathBuf,
        /// The part of the file that is wrong, for example `magic number`.
        what: Cow<'static, str>,
        /// The value found there.
        found: String,
        /// What was expected instead.
        expected: String,
    },
    /// A parameter is outside its range.
    #[error("{name} is {value}, expected {expected}")]
    Parameter {
        /// The parameter's name, as it stands in its struct.
        name: &'static str,
        /// The value given.
        value: String,
        /// The range or set of legal values.
        expected: String,
    },
    /// A slice is too short or too long for the image that it should hold.
    #[error("{what} holds {found} elements, expected {expected}")]
    Length {
        /// What the slice holds, for example `frame data`.
        what: &'static str,
        /// Its length, in elements.
        found: usize,
        /// The length that size, format and stride require.
        expected: usize,
    },
    /// Two images that belong together differ in size.
    #[error("{what} is {found}, expected {expected}")]
    SizeMismatch {
        /// The image, for example `second frame`.
        what: String,
        /// Its size.
        found: Size,
        /// The size that it should have.
        expected: Size,
    },
    /// A frame's pixel format is not the one that the engine was made for.
    #[error("frame format is {found}, expected {expected}")]
    PixelFormat {
        /// The frame's format.
        found: PixelFormat,
        /// The engine's format.
        expected: PixelFormat,
    },
    /// An image is larger than the adapter allows.
    #[error("{what} of {size} needs {needed} bytes, over the limit of {limit} of {adapter}")]
    TooLarge {
        /// The buffer's name.
        what: String,
        /// The frame's size.
        size: Size,
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
        /// The adapter that sets the limit.
        adapter: String,
    },
    /// The adapter has no room for all of an engine's buffers.
    #[error("{adapter} has no room for frames of {size}: {needed} bytes needed")]
    OutOfMemory {
        /// The adapter's name.
        adapter: String,
        /// The frame's size.
        size: Size,
        /// Bytes of all buffers.
        needed: u64,
    },
    /// No adapter fits. The message lists the adapters found and says what to install.
    #[error("no usable GPU adapter: {reason}")]
    NoAdapter {
        /// The reason, and what can be done about it.
        reason: String,
    },
    /// The GPU device was lost and could not be reopened, or the caller did not ask for that.
    #[error("GPU device lost on {adapter}: {reason}")]
    DeviceLost {
        /// The adapter's name.
        adapter: String,
        /// The driver's message.
        reason: String,
    },
    /// A frame was not done by its deadline. Its ticket stays valid: it can be waited for again.
    #[error("frame {frame} not done after {waited_ms} ms, deadline {deadline_ms} ms")]
    Timeout {
        /// The frame's number.
        frame: u64,
        /// The time waited, in milliseconds.
        waited_ms: u64,
        /// The time allowed, in milliseconds.
        deadline_ms: u64,
    },
    /// More frames are in flight than the engine has slots for.
    #[error("{in_flight} frames in flight, at most {limit}: wait for one before the next submit")]
    Busy {
        /// Frames submitted whose results were not taken yet.
        in_flight: usize,
        /// Slots of the engine.
        limit: usize,
    },
    /// A ticket does not belong to a frame in flight: it was taken already, or dropped.
    #[error("ticket {ticket} is not in flight: taken already, dropped, or of another engine")]
    Ticket {
        /// The ticket's frame number.
        ticket: u64,
    },
    /// A plan, shader or kernel contradicts itself: a mistake in this crate, found before it could do harm.
    #[error("{kernel}: {problem}")]
    Kernel {
        /// The kernel or plan step.
        kernel: String,
        /// What does not fit.
        problem: String,
    },
}

impl Error {
    /// A short name of the kind of error that never changes, for programs that log it or act on it:
    ///
    /// | code | variant |
    /// |---|---|
    /// | `io` | [`Error::Io`] |
    /// | `format` | [`Error::Format`] |
    /// | `parameter` | [`Error::Parameter`] |
    /// | `length` | [`Error::Length`] |
    /// | `size-mismatch` | [`Error::SizeMismatch`] |
    /// | `pixel-format` | [`Error::PixelFormat`] |
    /// | `too-large` | [`Error::TooLarge`] |
    /// | `out-of-memory` | [`Error::OutOfMemory`] |
    /// | `no-adapter` | [`Error::NoAdapter`] |
    /// | `device-lost` | [`Error::DeviceLost`] |
    /// | `timeout` | [`Error::Timeout`] |
    /// | `busy` | [`Error::Busy`] |
    /// | `ticket` | [`Error::Ticket`] |
    /// | `kernel` | [`Error::Kernel`] |
    pub fn code(&self) -> &'static str {
        match self {
            Self::Io { .. } => "io",
            Self::Format { .. } => "format",
            Self::Parameter { .. } => "parameter",
            Self::Length { .. } => "length",
            Self::SizeMismatch { .. } => "size-mismatch",
            Self::PixelFormat { .. } => "pixel-format",
            Self::TooLarge { .. } => "too-large",
            Self::OutOfMemory { .. } => "out-of-memory",
            Self::NoAdapter { .. } => "no-adapter",
            Self::DeviceLost { .. } => "device-lost",
            Self::Timeout { .. } => "timeout",
            Self::Busy { .. } => "busy",
            Self::Ticket { .. } => "ticket",
            Self::Kernel { .. } => "kernel",
        }
    }

    /// An [`Error::Io`] of a file.
    pub fn io(path: impl AsRef<Path>, source: std::io::Error) -> Self {
        Self::Io { path: path.as_ref().to_owned(), source }
    }

    /// An [`Error::Format`] of a file.
    pub fn format(
        path: impl AsRef<Path>,
        what: impl Into<Cow<'static, str>>,
        found: impl ToString,
        expected: impl ToString,
    ) -> Self {
        Self::Format {
            path: path.as_ref().to_owned(),
            what: what.into(),
            found: found.to_string(),
            expected: expected.to_string(),
        }
    }

    /// An [`Error::Parameter`].
    pub fn parameter(name: &'static str, value: impl ToString, expected: impl ToString) -> Self {
        Self::Parameter { name, value: value.to_string(), expected: expected.to_string() }
    }
}

/// Checks named values against their ranges, both ends included: (name, value, low, high).
///
/// # Errors
/// [`Error::Parameter`] naming the first one that is out of range or NaN.
pub(crate) fn in_ranges(values: &[(&'static str, f64, f64, f64)]) -> Result<()> {
    for &(name, value, low, high) in values {
        if !(low..=high).contains(&value) {
            return Err(Error::parameter(name, value, format_args!("{low} to {high}")));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// One of each variant. A new variant does not compile in [`Error::code`] without a code, and belongs into this
    /// list.
    fn each() -> Vec<Error> {
        let (size, text) = (Size::new(1, 1), String::new);
        vec![
            Error::io("a", std::io::Error::other("b")),
            Error::format("a", "b", "c", "d"),
            Error::parameter("a", "b", "c"),
            Error::Length { what: "a", found: 0, expected: 1 },
            Error::SizeMismatch { what: text(), found: size, expected: size },
            Error::PixelFormat { found: PixelFormat::Gray8, expected: PixelFormat::Rgb8 },
            Error::TooLarge { what: text(), size, needed: 2, limit: 1, adapter: text() },
            Error::OutOfMemory { adapter: text(), size, needed: 1 },
            Error::NoAdapter { reason: text() },
            Error::DeviceLost { adapter: text(), reason: text() },
            Error::Timeout { frame: 0, waited_ms: 2, deadline_ms: 1 },
            Error::Busy { in_flight: 2, limit: 2 },
            Error::Ticket { ticket: 0 },
            Error::Kernel { kernel: text(), problem: text() },
        ]
    }

    #[test]
    fn codes_differ_and_are_those_of_the_documentation() {
        let codes: BTreeSet<&str> = each().iter().map(Error::code).collect();
        assert_eq!(codes.len(), each().len(), "{codes:?}");
        let lines = include_str!("error.rs").lines();
        let documented: BTreeSet<&str> = lines
            .filter_map(|line| line.trim().strip_prefix("/// | `")?.split_once("` | [`Error::"))
            .map(|(code, _)| code)
            .collect();
        assert_eq!(codes, documented);
        let plain = |c: char| c.is_ascii_lowercase() || c == '-';
        assert!(codes.iter().all(|code| !code.is_empty() && code.chars().all(plain)), "{codes:?}");
    }
}
