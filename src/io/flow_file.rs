//! Flow files of every format, told apart by their extension.

use std::path::Path;

use super::{flo, kitti, npy};
use crate::error::{Error, Result};
use crate::frame::FlowField;

#[derive(Clone, Copy)]
enum Kind {
    Flo,
    Kitti,
    Npy,
}

/// Reads a flow field in pixels: `.flo` (Middlebury), `.png` (KITTI) or `.npy` (`float32`, height × width × 2). The
/// extension may be in upper or lower case.
///
/// # Errors
/// [`Error::Format`] for another extension or content that does not match the format, [`Error::Io`].
pub fn read_flow(path: impl AsRef<Path>) -> Result<FlowField> {
    let path = path.as_ref();
    match kind(path)? {
        Kind::Flo => flo::read(path),
        Kind::Kitti => kitti::read(path),
        Kind::Npy => npy::read(path),
    }
}

/// Writes a flow field in pixels atomically, in the format that the extension names. See [`read_flow`].
///
/// # Errors
/// [`Error::Format`] for another extension, [`Error::Parameter`] or [`Error::Length`] if size and data contradict
/// each other, [`Error::Io`].
pub fn write_flow(path: impl AsRef<Path>, flow: &FlowField) -> Result<()> {
    let path = path.as_ref();
    match kind(path)? {
        Kind::Flo => flo::write(path, flow),
        Kind::Kitti => kitti::write(path, flow),
        Kind::Npy => npy::write(path, flow),
    }
}

fn kind(path: &Path) -> Result<Kind> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "flo" => Ok(Kind::Flo),
        "png" => Ok(Kind::Kitti),
        "npy" => Ok(Kind::Npy),
        other => {
            let found = if other.is_empty() { "missing".to_owned() } else { format!(".{other}") };
            Err(Error::format(path, "extension", found, ".flo, .png (KITTI) or .npy"))
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::Size;

    #[test]
    fn every_kind_reads_what_it_writes() {
        let folder = tempfile::tempdir().unwrap();
        let flow =
            FlowField { size: Size::new(2, 2), data: vec![[0.5, -1.25], [3.0, 0.0], [0.0; 2], [-7.5, 9.0]] };
        for name in ["a.flo", "a.png", "a.npy", "b.FLO", "b.PNG"] {
            let path = folder.path().join(name);
            write_flow(&path, &flow).unwrap();
            assert_eq!(read_flow(&path).unwrap(), flow, "{name}");
        }
    }

    #[test]
    fn another_extension_is_named_beside_the_accepted_ones() {
        let text = read_flow("flow.pfm").unwrap_err().to_string();
        assert_eq!(text, "flow.pfm: extension is .pfm, expected .flo, .png (KITTI) or .npy");
        let text = read_flow("flow").unwrap_err().to_string();
        assert_eq!(text, "flow: extension is missing, expected .flo, .png (KITTI) or .npy");
    }
}
