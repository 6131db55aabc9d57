//! The destinations of results: what a path given on the command line stands for.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use super::print;
use crate::error::{Error, Result};
use crate::io::write_bytes;

/// The destination of one kind of result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Place {
    Stdout,
    File(PathBuf),
    /// A folder of numbered files with this extension.
    Folder(PathBuf, &'static str),
}

/// The destinations that a kind of result may have.
#[derive(Clone, Copy)]
pub(super) struct Allowed {
    /// Extensions of a file.
    pub(super) files: &'static [&'static str],
    pub(super) folder: Folder,
    /// Whether `-` stands for standard output.
    pub(super) stdout: bool,
}

/// Whether results may go into a folder, and the extension of the numbered files in it.
#[derive(Clone, Copy)]
pub(super) enum Folder {
    No,
    /// One that exists, or whose name ends with `/`.
    Marked(&'static str),
    /// Any name that is not one of a file.
    Any(&'static str),
    /// The same, because the input is a sequence.
    OfSequence(&'static str),
}

/// Extensions of videos that other programs write.
const VIDEOS: [&str; 10] = ["mp4", "avi", "gif", "mov", "mkv", "webm", "m4v", "mpg", "mpeg", "wmv"];
/// Extensions of other files: a new folder of such a name is not meant.
const FILES: [&str; 24] = [
    "y4m", "png", "jpg", "jpeg", "bmp", "tif", "tiff", "webp", "pgm", "ppm", "pnm", "pfm", "svg", "flo",
    "npy", "npz", "csv", "json", "jsonl", "html", "txt", "yaml", "zip", "tar",
];

impl Allowed {
    /// A file with one of these extensions.
    pub(super) const fn file(files: &'static [&'static str]) -> Self {
        Self { files, folder: Folder::No, stdout: false }
    }

    /// The same, and standard output.
    pub(super) const fn file_or_stdout(files: &'static [&'static str]) -> Self {
        Self { files, folder: Folder::No, stdout: true }
    }

    /// A folder of files with this extension for each frame or pair of a sequence.
    pub(super) const fn of_sequence(extension: &'static str) -> Self {
        Self { files: &[], folder: Folder::OfSequence(extension), stdout: false }
    }

    /// The place that a flag's path stands for. Creates nothing.
    ///
    /// # Errors
    /// [`Error::Parameter`] or [`Error::Format`] for a path that is none of the allowed ones.
    pub(super) fn place(self, flag: &'static str, path: &Path) -> Result<Place> {
        if path == Path::new("-") {
            return if self.stdout {
                Ok(Place::Stdout)
            } else {
                Err(Error::parameter(flag, "-", self.expected()))
            };
        }
        if is_folder(path) {
            return match self.folder {
                Folder::No => {
                    Err(Error::parameter(flag, format_args!("{}, a folder", path.display()), self.expected()))
                }
                Folder::Marked(kind) | Folder::Any(kind) | Folder::OfSequence(kind) => {
                    Ok(Place::Folder(path.to_owned(), kind))
                }
            };
        }
        let extension = extension(path);
        if self.files.contains(&extension.as_str()) {
            return Ok(Place::File(path.to_owned()));
        }
        let is_of_a_file = FILES.contains(&extension.as_str()) || VIDEOS.contains(&extension.as_str());
        match self.folder {
            Folder::Any(kind) | Folder::OfSequence(kind) if !is_of_a_file => {
                Ok(Place::Folder(path.to_owned(), kind))
            }
            _ => {
                let found = if extension.is_empty() { "missing".to_owned() } else { format!(".{extension}") };
                let expected = self.expected() + &self.conversion(path, &extension);
                Err(Error::format(path, "extension", found, expected))
            }
        }
    }

    /// The allowed places, as text.
    fn expected(self) -> String {
        let files = self.files.iter().map(|extension| format!(".{extension}"));
        let folder = match self.folder {
            Folder::No | Folder::Marked(_) => None,
            Folder::Any(_) => Some("a folder"),
            Folder::OfSequence(_) => Some("a folder, as the input is a sequence"),
        };
        files.chain(folder.map(str::to_owned)).collect::<Vec<_>>().join(" or ")
    }

    /// How a video that another program writes is made of one of the allowed places; empty if it is not.
    fn conversion(self, path: &Path, extension: &str) -> String {
        if !VIDEOS.contains(&extension) {
            return String::new();
        }
        let stem = path.with_extension("");
        let (stem, whole) = (stem.display(), path.display());
        match self.folder {
            _ if self.files.contains(&"y4m") => format!("; ffmpeg -i {stem}.y4m {whole} converts it"),
            Folder::OfSequence("png") => format!("; ffmpeg -i {stem}/%06d.png {whole} makes a video of it"),
            _ => String::new(),
        }
    }
}

impl Place {
    /// Creates the folder, if it is one.
    pub(super) fn make_folder(&self) -> Result<()> {
        match self {
            Self::Folder(folder, _) => fs::create_dir_all(folder).map_err(|source| Error::io(folder, source)),
            Self::File(_) | Self::Stdout => Ok(()),
        }
    }

    /// Writes the result of frame or pair `number`.
    pub(super) fn write(&self, number: u64, bytes: &[u8]) -> Result<()> {
        match self {
            Self::Stdout => print::bytes(bytes),
            Self::File(path) => write_bytes(path, bytes),
            Self::Folder(folder, extension) => {
                write_bytes(folder.join(format!("{number:06}.{extension}")), bytes)
            }
        }
    }
}

/// Whether a path is that of a folder: one that exists, or a name that ends with `/`.
pub(super) fn is_folder(path: &Path) -> bool {
    path.is_dir() || path.as_os_str().as_encoded_bytes().ends_with(b"/")
}

/// The extension in lower case; empty if there is none.
pub(super) fn extension(path: &Path) -> String {
    path.extension().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const OVERLAY: Allowed = Allowed { files: &["y4m"], folder: Folder::Any("png"), stdout: false };

    #[test]
    fn a_name_says_what_it_is() {
        let place = |allowed: Allowed, path: &str| allowed.place("-o", Path::new(path)).unwrap();
        assert_eq!(place(OVERLAY, "a.Y4M"), Place::File("a.Y4M".into()));
        for folder in ["a", "a.mp4/", "v1.2"] {
            assert_eq!(place(OVERLAY, folder), Place::Folder(folder.into(), "png"));
        }
        assert_eq!(place(Allowed::file_or_stdout(&["csv"]), "-"), Place::Stdout);
        assert_eq!(place(Allowed::of_sequence("flo"), "a"), Place::Folder("a".into(), "flo"));
    }

    #[test]
    fn a_file_of_another_kind_is_no_folder() {
        for (allowed, path, expected) in [
            (
                OVERLAY,
                "a/b.mp4",
                "a/b.mp4: extension is .mp4, expected .y4m or a folder; ffmpeg -i a/b.y4m a/b.mp4 converts it",
            ),
            (OVERLAY, "b.png", "b.png: extension is .png, expected .y4m or a folder"),
            (OVERLAY, "-", "-o is -, expected .y4m or a folder"),
            (
                Allowed::of_sequence("png"),
                "b.gif",
                "b.gif: extension is .gif, expected a folder, as the input is a sequence; ffmpeg -i b/%06d.png b.gif \
                 makes a video of it",
            ),
            (
                Allowed::of_sequence("flo"),
                "b.flo",
                "b.flo: extension is .flo, expected a folder, as the input is a sequence",
            ),
            (Allowed::file(&["json"]), "notes", "notes: extension is missing, expected .json"),
            (Allowed::file(&["json"]), "a.json/", "-o is a.json/, a folder, expected .json"),
        ] {
            assert_eq!(allowed.place("-o", Path::new(path)).unwrap_err().to_string(), expected);
        }
    }
}
