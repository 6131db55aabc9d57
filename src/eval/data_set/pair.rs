use std::path::PathBuf;

use crate::error::Result;
use crate::fnv::Fnv1a;
use crate::io::read_file;

/// The files of a pair of frames with ground truth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PairFiles {
    /// The name, unique in its set.
    pub name: String,
    /// The number of the first frame, in sets of numbered frames.
    pub number: Option<u64>,
    /// The two frames.
    pub frames: [PathBuf; 2],
    /// The true flow from the first frame to the second, in a format of [`read_flow`](crate::io::read_flow).
    pub flow: PathBuf,
    /// The true flow of the pixels that are not occluded alone: a pixel that `flow` knows and this does not is occluded.
    pub visible_flow: Option<PathBuf>,
    /// An image that is white where a pixel is occluded.
    pub occlusions: Option<PathBuf>,
    /// An image that is white where the truth must not be used.
    pub invalid: Option<PathBuf>,
    /// An image that is black where the truth must not be used.
    pub mask: Option<PathBuf>,
    /// The depth in metres, `.npy`.
    pub depth: Option<PathBuf>,
}

impl PairFiles {
    /// All files, in a fixed order.
    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        let further = [&self.visible_flow, &self.occlusions, &self.invalid, &self.mask, &self.depth];
        self.frames.iter().chain([&self.flow]).chain(further.into_iter().flatten())
    }

    /// A digest of the content of all files: 16 hexadecimal digits, the FNV-1a hash of lengths and bytes.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) for a file that cannot be read.
    pub fn digest(&self) -> Result<String> {
        let mut hash = Fnv1a::default();
        for path in self.paths() {
            let bytes = read_file(path)?;
            hash.add(&(bytes.len() as u64).to_le_bytes());
            hash.add(&bytes);
        }
        Ok(hash.text())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_changes_with_any_file() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["a", "b", "flow", "depth"] {
            std::fs::write(at(name), name).unwrap();
        }
        let pair = PairFiles { frames: [at("a"), at("b")], flow: at("flow"), ..PairFiles::default() };
        let with_depth = PairFiles { depth: Some(at("depth")), ..pair.clone() };
        let before = [pair.digest().unwrap(), with_depth.digest().unwrap()];
        assert!(before[0] != before[1] && before[0].len() == 16);
        std::fs::write(at("flow"), "flaw").unwrap();
        assert!(pair.digest().unwrap() != before[0]);
        std::fs::write(at("flow"), "flow").unwrap();
        assert_eq!(pair.digest().unwrap(), before[0]);
        std::fs::remove_file(at("b")).unwrap();
        assert_eq!(pair.digest().unwrap_err().code(), "io");
    }
}
