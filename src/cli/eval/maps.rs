//! The images of the page: kept beside the results, or in memory. Error maps are PNG, as their colours are exact; what a pair
//! shows is JPEG, which takes less.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::eval::Job;
use crate::io::write_bytes;

/// The folder of images beside the results.
const FOLDER: &str = "maps";

/// Images by name.
pub(super) enum Maps {
    /// Files in this folder.
    Folder(PathBuf),
    Memory(HashMap<String, Vec<u8>>),
    /// None are wanted.
    Nowhere,
}

/// What an image shows of a pair.
#[derive(Clone, Copy)]
pub(super) enum Shown<'a> {
    FirstFrame,
    Truth,
    /// The error of a run.
    Error(&'a Job),
}

impl Shown<'_> {
    /// The media type of the image.
    pub(super) fn media_type(self) -> &'static str {
        match self {
            Self::FirstFrame | Self::Truth => "image/jpeg",
            Self::Error(_) => "image/png",
        }
    }
}

impl Maps {
    /// Those beside the results in a folder.
    pub(super) fn beside(results: &Path) -> Self {
        Self::Folder(results.join(FOLDER))
    }

    pub(super) fn are_wanted(&self) -> bool {
        !matches!(self, Self::Nowhere)
    }

    /// Whether an image is there.
    pub(super) fn has(&self, set: &str, pair: &str, shown: Shown<'_>) -> bool {
        match self {
            Self::Folder(folder) => folder.join(name(set, pair, shown)).is_file(),
            Self::Memory(images) => images.contains_key(&name(set, pair, shown)),
            Self::Nowhere => false,
        }
    }

    pub(super) fn put(&mut self, set: &str, pair: &str, shown: Shown<'_>, bytes: Vec<u8>) -> Result<()> {
        let name = name(set, pair, shown);
        match self {
            Self::Folder(folder) => {
                fs::create_dir_all(&*folder).map_err(|source| Error::io(&*folder, source))?;
                write_bytes(folder.join(name), &bytes)
            }
            Self::Memory(images) => {
                images.insert(name, bytes);
                Ok(())
            }
            Self::Nowhere => Ok(()),
        }
    }

    /// An image, if there is one.
    pub(super) fn get(&self, set: &str, pair: &str, shown: Shown<'_>) -> Option<Vec<u8>> {
        let name = name(set, pair, shown);
        match self {
            Self::Folder(folder) => fs::read(folder.join(name)).ok(),
            Self::Memory(images) => images.get(&name).cloned(),
            Self::Nowhere => None,
        }
    }

    /// Copies the images of another folder of results.
    pub(super) fn copy_from(&mut self, results: &Path) -> Result<()> {
        let (Self::Folder(folder), from) = (self, results.join(FOLDER)) else { return Ok(()) };
        if !from.is_dir() {
            return Ok(());
        }
        fs::create_dir_all(&*folder).map_err(|source| Error::io(&*folder, source))?;
        let wrong = |source| Error::io(&from, source);
        for entry in fs::read_dir(&from).map_err(wrong)? {
            let path = entry.map_err(wrong)?.path();
            let is_image = path.extension().is_some_and(|extension| extension == "png" || extension == "jpg");
            if let Some(name) = path.file_name().filter(|_| is_image) {
                let bytes = fs::read(&path).map_err(|source| Error::io(&path, source))?;
                write_bytes(folder.join(name), &bytes)?;
            }
        }
        Ok(())
    }
}

/// A file name that differs for different images: all but letters, digits and some signs becomes `%` and its code.
fn name(set: &str, pair: &str, shown: Shown<'_>) -> String {
    let what = match shown {
        Shown::FirstFrame => "frame".to_owned(),
        Shown::Truth => "truth".to_owned(),
        Shown::Error(job) => format!("{}@{}", job.run, job.backend),
    };
    let mut name = String::new();
    for character in format!("{set}/{pair}/{what}").chars() {
        match character {
            '/' => name.push('~'),
            ':' => name.push('+'),
            _ if character.is_ascii_alphanumeric() || "-_.=@".contains(character) => name.push(character),
            _ => name += &format!("%{:x}", u32::from(character)),
        }
    }
    name + if shown.media_type() == "image/png" { ".png" } else { ".jpg" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_differ() {
        let job = Job { set: "a".into(), pair: "b/c".into(), run: "x:y:p=0.5".into(), backend: "cpu".into() };
        assert_eq!(name("a", "b/c", Shown::Error(&job)), "a~b~c~x+y+p=0.5@cpu.png");
        assert_eq!(name("a b", "é~", Shown::Truth), "a%20b~%e9%7e~truth.jpg");
    }
}
