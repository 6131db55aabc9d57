//! The outputs and their formats.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::Flow;
use crate::cli::paths;
use crate::cli::place::{Allowed, Folder, Place, extension, is_folder};
use crate::error::{Error, Result};
use crate::frame::{FlowField, Image, PixelFormat, Plane};
use crate::io::{flo, kitti, npy, picture};
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

enum Kind {
    Flow(FormatArg),
    Color,
    Arrows { gain: f32 },
    Confidence { npy: bool },
}

/// The destinations of all results.
pub(super) struct Targets {
    /// Each with its flag.
    places: Vec<(&'static str, Kind, Place)>,
    scale: Option<f32>,
    colours: bool,
}

impl Targets {
    /// Checks the arguments, and creates nothing.
    pub(super) fn new(args: &Flow, single: bool) -> Result<Self> {
        let mut places = Vec::new();
        if let Some(path) = &args.output {
            let (format, place) = flow_place(path, args.format, single)?;
            places.push(("-o", Kind::Flow(format), place));
        } else if let Some(format) = args.format {
            return Err(Error::parameter("--format", format.extension(), "an output (-o) beside it"));
        }
        let png = allowed(single, "png", &["png"]);
        if let Some(path) = &args.color {
            places.push(("--color", Kind::Color, png.place("--color", path)?));
        }
        if let Some(path) = &args.arrows {
            places.push(("--arrows", Kind::Arrows { gain: args.arrow_gain }, png.place("--arrows", path)?));
        }
        if let Some(path) = &args.confidence {
            let place = allowed(single, "npy", &["npy", "png"]).place("--confidence", path)?;
            let npy = matches!(&place, Place::Folder(..)) || extension(path) == "npy";
            places.push(("--confidence", Kind::Confidence { npy }, place));
        }
        let results: Vec<_> = places.iter().map(|(flag, _, place)| (*flag, Some(place))).collect();
        let read = args.inputs.iter().map(Path::new);
        let given = [&args.init, &args.mask].into_iter().flatten().map(PathBuf::as_path);
        paths::check(&results, read.chain(given))?;
        Ok(Self { places, scale: args.scale, colours: args.color.is_some() })
    }

    /// The displacement shown in full colour, if colour images were written.
    pub(super) fn scale(&self) -> Option<f32> {
        self.scale.filter(|_| self.colours)
    }

    /// Creates the folders.
    pub(super) fn make_folders(&self) -> Result<()> {
        self.places.iter().try_for_each(|(.., place)| place.make_folder())
    }

    /// Writes the results of pair `number`.
    pub(super) fn write(&mut self, number: u64, pair: &Pair<'_>) -> Result<()> {
        // Encode everything before writing, so that an error leaves no file behind.
        let mut contents = Vec::new();
        for (_, kind, _) in &self.places {
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
        self.places.iter().zip(contents).try_for_each(|((.., place), bytes)| place.write(number, &bytes))
    }
}

/// A plane of 0 to 1 as a gray image, black to white.
pub(in crate::cli) fn gray(plane: &Plane) -> Image {
    // NaN becomes 0.
    let data = plane.data.iter().map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8).collect();
    Image { size: plane.size, format: PixelFormat::Gray8, data }
}

/// The place and the format of the flow.
fn flow_place(path: &Path, format: Option<FormatArg>, single: bool) -> Result<(FormatArg, Place)> {
    let in_folder = format.unwrap_or(FormatArg::Flo);
    if path == Path::new("-") && !single && in_folder == FormatArg::Kitti {
        return Err(Error::parameter("--format", "kitti", "flo or npy for a sequence to standard output"));
    }
    let is_named_otherwise = single && format.is_some() && path != Path::new("-") && !is_folder(path);
    let place = match is_named_otherwise {
        true => Place::File(path.to_owned()),
        false => Allowed { stdout: true, ..allowed(single, in_folder.extension(), &["flo", "png", "npy"]) }
            .place("-o", path)?,
    };
    let by_name = match extension(path).as_str() {
        "png" => FormatArg::Kitti,
        "npy" => FormatArg::Npy,
        _ => FormatArg::Flo,
    };
    let is_file = matches!(place, Place::File(_));
    Ok((format.unwrap_or(if is_file { by_name } else { FormatArg::Flo }), place))
}

/// For one pair a file, or a folder that is marked as one; for a sequence a folder.
fn allowed(single: bool, in_folder: &'static str, files: &'static [&'static str]) -> Allowed {
    match single {
        true => Allowed { files, folder: Folder::Marked(in_folder), stdout: true },
        false => Allowed::of_sequence(in_folder),
    }
}
