//! The outputs and their formats.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::Flow;
use crate::cli::{input, print};
use crate::error::{Error, Result};
use crate::frame::{FlowField, Image, PixelFormat, Plane};
use crate::io::{check_writable, flo, kitti, npy, picture, write_bytes};
use crate::report::{arrows, colour_wheel};

/// Pixels between arrows.
const ARROW_STEP: u32 = 16;

/// Formats of a flow field.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FormatArg {
    /// Middlebury .flo: two f32 per pixel
    Flo,
    /// KITTI .png: 16 bits, 1/64 px, within ±512 px
    Kitti,
    /// NumPy .npy: float32, height × width × 2
    Npy,
}

impl FormatArg {
    fn extension(self) -> &'static str {
        match self {
            Self::Flo => "flo",
            Self::Kitti => "png",
            Self::Npy => "npy",
        }
    }

    fn encode(self, flow: &FlowField) -> Result<Vec<u8>> {
        match self {
            Self::Flo => flo::encode(flow),
            Self::Kitti => kitti::encode(flow),
            Self::Npy => npy::encode(flow),
        }
    }
}

/// The results of one pair.
pub(super) struct Pair<'a> {
    pub(super) first: &'a Image,
    pub(super) flow: &'a FlowField,
    pub(super) confidence: Option<&'a Plane>,
}

/// The destination of one kind of result.
pub(in crate::cli) enum Place {
    Stdout,
    File(PathBuf),
    Folder(PathBuf, &'static str),
}

impl Place {
    /// Creates the folder, if it is one.
    pub(in crate::cli) fn make_folder(&self) -> Result<()> {
        match self {
            Self::Folder(folder, _) => fs::create_dir_all(folder).map_err(|source| Error::io(folder, source)),
            Self::File(_) | Self::Stdout => Ok(()),
        }
    }

    /// Writes the result of pair `number`.
    pub(in crate::cli) fn write(&self, number: u64, bytes: &[u8]) -> Result<()> {
        match self {
            Self::Stdout => print::bytes(bytes),
            Self::File(path) => write_bytes(path, bytes),
            Self::Folder(folder, extension) => {
                write_bytes(folder.join(format!("{number:06}.{extension}")), bytes)
            }
        }
    }
}

enum Kind {
    Flow(FormatArg),
    Color,
    Arrows { gain: f32 },
    Confidence { npy: bool },
}

/// The destinations of all results.
pub(super) struct Targets {
    places: Vec<(Kind, Place)>,
    scale: Option<f32>,
    colours: bool,
}

impl Targets {
    /// Checks the arguments, and creates nothing.
    pub(super) fn new(args: &Flow, single: bool) -> Result<Self> {
        let mut places = Vec::new();
        if let Some(path) = &args.output {
            places.push(flow_place(path, args.format, single)?);
        } else if let Some(format) = args.format {
            return Err(Error::parameter("--format", format.extension(), "an output (-o) beside it"));
        }
        for (path, kind) in
            [(&args.color, Kind::Color), (&args.arrows, Kind::Arrows { gain: args.arrow_gain })]
        {
            if let Some(path) = path {
                places.push((kind, place(path, single, "png", &["png"])?));
            }
        }
        if let Some(path) = &args.confidence {
            let place = place(path, single, "npy", &["npy", "png"])?;
            let npy = matches!(&place, Place::Folder(..)) || extension(path) == "npy";
            places.push((Kind::Confidence { npy }, place));
        }
        let targets = Self { places, scale: args.scale, colours: args.color.is_some() };
        check_places(targets.places.iter().map(|(_, place)| place))?;
        Ok(targets)
    }

    /// The displacement shown in full colour, if colour images were written.
    pub(super) fn scale(&self) -> Option<f32> {
        self.scale.filter(|_| self.colours)
    }

    /// Creates the folders.
    pub(super) fn make_folders(&self) -> Result<()> {
        self.places.iter().try_for_each(|(_, place)| place.make_folder())
    }

    /// Writes the results of pair `number`.
    pub(super) fn write(&mut self, number: u64, pair: &Pair<'_>) -> Result<()> {
        // Encode everything before writing, so that an error leaves no file behind.
        let mut contents = Vec::new();
        for (kind, _) in &self.places {
            contents.push(match kind {
                Kind::Flow(format) => format.encode(pair.flow)?,
                Kind::Color => {
                    let (image, scale) = colour_wheel(pair.flow, self.scale)?;
                    // A sequence keeps its first scale, so that its colours are comparable.
                    self.scale = Some(scale);
                    picture::encode_png(&image)?
                }
                Kind::Arrows { gain } => {
                    picture::encode_png(&arrows(&pair.first.frame()?, pair.flow, ARROW_STEP, *gain)?)?
                }
                Kind::Confidence { npy } => {
                    let plane = pair.confidence.ok_or_else(|| {
                        Error::parameter("--confidence", "given", "none: the plan computes no confidence")
                    })?;
                    if *npy { npy::encode_plane(plane)? } else { picture::encode_png(&gray(plane))? }
                }
            });
        }
        self.places.iter().zip(contents).try_for_each(|((_, place), bytes)| place.write(number, &bytes))
    }
}

/// Checks that the folders are writable or can be created, and that no two results share a file.
pub(in crate::cli) fn check_places<'a>(places: impl Iterator<Item = &'a Place>) -> Result<()> {
    let mut seen = Vec::new();
    for place in places {
        match place {
            Place::Folder(folder, _) => input::folder(folder)?,
            Place::File(path) => {
                let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
                let special = fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
                if !special {
                    check_writable(parent.unwrap_or(Path::new(".")))?;
                }
            }
            Place::Stdout => {}
        }
        let name = match place {
            Place::Stdout => PathBuf::from("-"),
            Place::File(path) => path.clone(),
            Place::Folder(folder, extension) => folder.join(format!("NNNNNN.{extension}")),
        };
        if seen.contains(&name) {
            let expected = "a place of its own for each result";
            return Err(Error::parameter("output", format_args!("{} twice", name.display()), expected));
        }
        seen.push(name);
    }
    Ok(())
}

/// A plane of 0 to 1 as a gray image, black to white.
pub(in crate::cli) fn gray(plane: &Plane) -> Image {
    // NaN becomes 0.
    let data = plane.data.iter().map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8).collect();
    Image { size: plane.size, format: PixelFormat::Gray8, data }
}

fn flow_place(path: &Path, format: Option<FormatArg>, single: bool) -> Result<(Kind, Place)> {
    if path == Path::new("-") {
        let format = format.unwrap_or(FormatArg::Flo);
        if !single && format == FormatArg::Kitti {
            return Err(Error::parameter(
                "--format",
                "kitti",
                "flo or npy for a sequence to standard output",
            ));
        }
        return Ok((Kind::Flow(format), Place::Stdout));
    }
    if single && !is_folder(path) && format.is_some() {
        let format = format.unwrap_or(FormatArg::Flo);
        return Ok((Kind::Flow(format), Place::File(path.to_owned())));
    }
    let place = place(path, single, format.unwrap_or(FormatArg::Flo).extension(), &["flo", "png", "npy"])?;
    let by_name = match extension(path).as_str() {
        "png" => FormatArg::Kitti,
        "npy" => FormatArg::Npy,
        _ => FormatArg::Flo,
    };
    let format = if matches!(place, Place::File(_)) { by_name } else { format.unwrap_or(FormatArg::Flo) };
    Ok((Kind::Flow(format), place))
}

/// A file with one of the given extensions, or a folder of files with one extension.
pub(in crate::cli) fn place(
    path: &Path,
    single: bool,
    in_folder: &'static str,
    as_file: &[&str],
) -> Result<Place> {
    let extension = extension(path);
    if single && path == Path::new("-") {
        return Ok(Place::Stdout);
    }
    if is_folder(path) {
        return Ok(Place::Folder(path.to_owned(), in_folder));
    }
    if single {
        if !as_file.contains(&extension.as_str()) {
            let found = if extension.is_empty() { "missing".to_owned() } else { format!(".{extension}") };
            let expected = as_file.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(" or ");
            return Err(Error::format(path, "extension", found, expected));
        }
        return Ok(Place::File(path.to_owned()));
    }
    if path == Path::new("-") || as_file.contains(&extension.as_str()) {
        return Err(Error::parameter("output", path.display(), "a folder, as the input is a sequence"));
    }
    Ok(Place::Folder(path.to_owned(), in_folder))
}

fn is_folder(path: &Path) -> bool {
    path.is_dir() || path.as_os_str().as_encoded_bytes().ends_with(b"/")
}

fn extension(path: &Path) -> String {
    path.extension().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase()
}
