//! `viewsphere undistort`: images as a camera without distortion would show them.

mod resample;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use self::resample::Resample;
use super::backend::BackendArgs;
use super::flow::source::Source;
use super::place::{Allowed, Folder, Place};
use super::progress::Progress;
use super::{Outcome, input, paths, print};
use crate::camera::{Camera, Framing, Lens};
use crate::error::{Error, Result};
use crate::frame::{FlowField, Image, Size, UNKNOWN_FLOW};
use crate::io::{self, picture};
use crate::report::arrows;

/// About the number of arrows in a row of the displacement field's image.
const ARROWS: u32 = 40;

/// Remove the lens distortion from images, so that straight lines are straight.
///
/// The camera file is one of OpenCV, ROS (camera_info), Kalibr (its cam0) or EuRoC. Inputs are an image (PNG, JPEG,
/// PGM, PPM), a numbered or globbed sequence, a .y4m video, or - for one on standard input. For one image -o names a
/// .png or is - for standard output; for everything else a folder. Colour and 16-bit images keep their format; videos
/// become gray. Pixels that the original does not show are black. Without --keep-all and --crop the focal length and
/// the principal point stay the same.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere undistort --camera cam.yaml in.jpg -o out.png
  viewsphere undistort --camera cam.yaml in.jpg -o out.png --crop --write-camera out.yaml
  viewsphere undistort --camera cam.yaml in.jpg --field field.png
  viewsphere undistort --camera cam.yaml 'frames/%04d.png' -o straight/ --keep-all --size 800x600
  ffmpeg -i in.mp4 -pix_fmt yuv420p -f yuv4mpegpipe - | viewsphere undistort --camera cam.yaml - -o straight/")]
pub(super) struct Undistort {
    /// An image; or a sequence such as 'frames/%04d.png' or 'frames/*.png'; or a .y4m video; or - for standard input
    #[arg(required = true)]
    inputs: Vec<String>,
    /// Camera file: the camera that took the images
    #[arg(long, value_name = "FILE")]
    camera: PathBuf,
    /// Write the result to this .png or into this folder; - is standard output
    #[arg(short, long, value_name = "PATH")]
    output: Option<PathBuf>,
    /// Show everything that the original shows
    #[arg(long, conflicts_with = "crop")]
    keep_all: bool,
    /// Show only what the original shows, without black borders
    #[arg(long)]
    crop: bool,
    /// Size of the result [default: that of the original]
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Write the first image, with arrows from each point to its undistorted position, to this .png
    #[arg(long, value_name = "FILE")]
    field: Option<PathBuf>,
    /// Write the camera of the result to this file
    #[arg(long, value_name = "FILE")]
    write_camera: Option<PathBuf>,
    /// Format of the camera file written
    #[arg(long, value_enum, default_value_t = FormatArg::Opencv, requires = "write_camera")]
    camera_format: FormatArg,
    /// Size of raw gray frames, one byte per pixel, on standard input
    #[arg(long, value_name = "WxH")]
    raw: Option<Size>,
    /// Print no progress and no notes
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    backend: BackendArgs,
}

/// Formats of a camera file.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum FormatArg {
    /// FileStorage YAML
    Opencv,
    /// camera_info YAML
    Ros,
    /// camchain YAML
    Kalibr,
}

/// The destinations of the results.
struct Places {
    output: Option<Place>,
    field: Option<Place>,
    camera: Option<Place>,
}

impl Undistort {
    pub(super) fn run(&self) -> Result<Outcome> {
        let raw = io::camera::read(&self.camera)?;
        let out = self.ideal(&raw)?;
        let mut source = Source::open(&self.inputs, self.raw)?;
        let places = self.places(source.len() == Some(1))?;
        let mut image = Image::default();
        if !source.next(&mut image)? {
            return Err(Error::format(source.name(), "number of frames", 0, "at least 1"));
        }
        input::same_size(&source.name(), image.size, raw.size, &self.camera)?;
        if let Some(place) = &places.field {
            place.write(0, &picture::encode_png(&field(&raw, &image)?)?)?;
        }
        if let Some(Place::File(path)) = &places.camera {
            let format = match self.camera_format {
                FormatArg::Opencv => io::camera::Format::OpenCv,
                FormatArg::Ros => io::camera::Format::Ros,
                FormatArg::Kalibr => io::camera::Format::Kalibr,
            };
            io::camera::write(path, &out, format)?;
        }
        let Some(place) = &places.output else { return Ok(Outcome::Done) };
        let mut resample = Resample::new(&self.backend.open(self.quiet)?, &raw, &out)?;
        let progress = Progress::of_sequence(source.len(), "frames", 1, self.quiet);
        let done = frames(&mut resample, &mut source, &mut image, place, &progress);
        progress.finish();
        done?;
        if !matches!(place, Place::Stdout) {
            let Camera { size, f_u, f_v, u_0, v_0, .. } = out;
            let share = 100.0 * resample.share();
            print::text(&format!(
                "camera  {size}, focal lengths {f_u:.3} and {f_v:.3} px, principal point {u_0:.3}, {v_0:.3}\n\
                 shown   {share:.2} % of the result"
            ))?;
        }
        Ok(Outcome::Done)
    }

    /// The camera of the result.
    fn ideal(&self, raw: &Camera) -> Result<Camera> {
        let size = self.size.unwrap_or(raw.size);
        match (self.keep_all, self.crop) {
            (true, _) => raw.ideal(size, Framing::KeepAll),
            (_, true) => raw.ideal(size, Framing::CropToValid),
            _ => Ok(Camera { lens: Lens::NONE, ..raw.resized(size) }),
        }
    }

    /// Checks the arguments, and creates nothing.
    fn places(&self, single: bool) -> Result<Places> {
        if self.output.is_none() && self.field.is_none() && self.write_camera.is_none() {
            return Err(Error::parameter("-o", "missing", "-o, --field or --write-camera"));
        }
        let place = |flag: &'static str, path: &Option<PathBuf>, allowed: Allowed| {
            path.as_ref().map(|path| allowed.place(flag, path)).transpose()
        };
        let result = match single {
            true => Allowed { files: &["png"], folder: Folder::Marked("png"), stdout: true },
            false => Allowed::of_sequence("png"),
        };
        let places = Places {
            output: place("-o", &self.output, result)?,
            field: place("--field", &self.field, Allowed::file(&["png"]))?,
            camera: place("--write-camera", &self.write_camera, Allowed::file(&["yaml", "yml"]))?,
        };
        let Places { output, field, camera } = &places;
        let results =
            [("-o", output.as_ref()), ("--field", field.as_ref()), ("--write-camera", camera.as_ref())];
        paths::check(&results, self.inputs.iter().map(Path::new).chain([self.camera.as_path()]))?;
        Ok(places)
    }
}

fn frames(
    resample: &mut Resample,
    source: &mut Source,
    image: &mut Image,
    place: &Place,
    progress: &Progress,
) -> Result<()> {
    place.make_folder()?;
    for number in 0.. {
        place.write(number, &picture::encode_png(&resample.apply(image)?)?)?;
        progress.inc();
        if !source.next(image)? {
            break;
        }
    }
    Ok(())
}

/// The image with arrows from each point to its position in the same camera without distortion.
fn field(raw: &Camera, image: &Image) -> Result<Image> {
    let ideal = Camera { lens: Lens::NONE, ..*raw };
    let step = (raw.size.width / ARROWS).max(8);
    let width = raw.size.width as usize;
    let mut flow = FlowField { size: raw.size, data: vec![[UNKNOWN_FLOW; 2]; raw.size.pixels()] };
    // Compute displacements only where an arrow begins.
    for v in (step / 2..raw.size.height).step_by(step as usize) {
        for u in (step / 2..raw.size.width).step_by(step as usize) {
            let pixel = [f64::from(u), f64::from(v)];
            if let Some([x, y]) = raw.ray(pixel).and_then(|ray| ideal.project(ray)) {
                flow.data[v as usize * width + u as usize] = [(x - pixel[0]) as f32, (y - pixel[1]) as f32];
            }
        }
    }
    arrows(&image.frame()?, &flow, step, 1.0)
}
