//! Checks of the subcommands' inputs and outputs.

use std::fs;
use std::path::Path;

use crate::error::{Error, Result};
use crate::frame::{Image, PixelFormat, Plane, Size};
use crate::io::{check_creatable, npy, picture};

/// Checks that the size found in `path` equals that of `other`.
pub(super) fn same_size(path: &Path, found: Size, expected: Size, other: &Path) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    Err(Error::format(path, "size", found, format_args!("{expected} as in {}", other.display())))
}

/// Checks that a folder is writable or can be created, and leaves nothing behind. The error names the given folder,
/// even where one above it is the cause.
pub(super) fn folder(path: &Path) -> Result<()> {
    not_standard_output(path)?;
    check_creatable(path)
}

/// Checks that an output folder is not `-`.
pub(super) fn not_standard_output(path: &Path) -> Result<()> {
    if path == Path::new("-") {
        return Err(Error::parameter(
            "-o",
            "-",
            "a folder, not standard output; write ./- for a folder of that name",
        ));
    }
    Ok(())
}

/// Creates a folder if it is missing, and runs `act`. If that fails, the folders created are removed again, unless
/// they hold something.
pub(super) fn within<T>(folder: &Path, act: impl FnOnce() -> Result<T>) -> Result<T> {
    let missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
    let made: Vec<&Path> = folder.ancestors().take_while(missing).collect();
    fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
    act().inspect_err(|_| {
        for folder in made {
            // Fails, as it should, for a folder that holds something.
            let _ = fs::remove_dir(folder);
        }
    })
}

/// Reads a mask or certainty of 0 to 1: an image, black to white, or a plane in a `.npy` file. Its size must be
/// `size`, that of `other`.
pub(super) fn plane(path: &Path, size: Size, other: &Path) -> Result<Plane> {
    let plane = if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy")) {
        npy::read_plane(path)?
    } else {
        from_image(&picture::read(path)?)
    };
    same_size(path, plane.size, size, other)?;
    if let Some(value) = plane.data.iter().find(|value| !(0.0..=1.0).contains(*value)) {
        return Err(Error::format(path, "a value", value, "0 to 1"));
    }
    Ok(plane)
}

fn from_image(image: &Image) -> Plane {
    let share = |value: u8| f32::from(value) / 255.0;
    let data = match image.format {
        PixelFormat::Gray8 => image.data.iter().map(|&gray| share(gray)).collect(),
        PixelFormat::Gray16 => image
            .data
            .as_chunks::<2>()
            .0
            .iter()
            .map(|&b| f32::from(u16::from_ne_bytes(b)) / 65535.0)
            .collect(),
        // The brightest channel, so that a mask may be painted in any colour.
        PixelFormat::Rgb8 | PixelFormat::Rgba8 => (image.data.chunks_exact(image.format.bytes()))
            .map(|pixel| share(pixel.iter().take(3).copied().max().unwrap_or(0)))
            .collect(),
    };
    Plane { size: image.size, data }
}
