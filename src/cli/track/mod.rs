//! `viewsphere track`: corners and their tracks over a sequence.

mod outputs;
mod summary;

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use self::outputs::{Places, Writers};
use self::summary::Summary;
use super::args::{named_by_flags, whole, whole_within};
use super::backend::BackendArgs;
use super::flow::source::Source;
use super::progress::Progress;
use super::{Outcome, input};
use crate::error::{Error, Result};
use crate::features::{CornerParameters, CornerResponse};
use crate::frame::{Image, Plane, Size};
use crate::io::points::{self, ListedPoint};
use crate::tracking::{MAX_POINTS, TrackParameters, Tracker, TrackerConfig};

/// Track corners over a sequence or video: Shi-Tomasi corners and pyramidal Lucas-Kanade.
///
/// Inputs are images (PNG, JPEG, PGM, PPM), a numbered or globbed sequence, a .y4m video, or - for one on standard input.
/// The result is a CSV with one line per track and frame: frame,track,x,y,status,fb_error_px,error. Positions are in pixels,
/// (0, 0) is the centre of the first pixel. Status is new, tracked, or the reason for which the track ends in this frame:
/// lost, inconsistent (see --forward-backward) or outside. The error is the mean absolute difference of the track's
/// windows, in gray levels. Parameters are those of OpenCV's goodFeaturesToTrack and calcOpticalFlowPyrLK.
#[derive(Args, Debug)]
#[command(
    name = "track",
    after_help = "\
Examples:
  viewsphere track 'frames/%04d.png'                            only a summary
  viewsphere track 'frames/%04d.png' -o tracks.csv --overlay tracks.y4m
  viewsphere track video.y4m -o - --forward-backward 0.5 | head
  viewsphere track a.png b.png --points points.csv -o tracks.csv --window 31 --levels 4
  viewsphere track video.y4m -o tracks.csv --harris --k 0.05 --max-corners 1000 --min-tracks 800
  ffmpeg -i in.mp4 -pix_fmt yuv420p -f yuv4mpegpipe - | viewsphere track - -o tracks.csv"
)]
pub(super) struct TrackCommand {
    /// Images; or a sequence such as 'frames/%04d.png' or 'frames/*.png'; or a .y4m video; or - for standard input
    #[arg(required = true)]
    inputs: Vec<String>,
    /// Write the tracks to this .csv; - is standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write the frames with the tracks over them to this .y4m, or as .png files into this folder; ffmpeg converts both to
    /// other videos
    #[arg(long, value_name = "PATH")]
    overlay: Option<PathBuf>,
    /// Track the points of this file in place of corners: x,y in pixels, one point per line, at most --max-corners of them. New
    /// corners are detected only with --min-tracks
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,
    /// Detect corners only where this mask is over 0: an image or a .npy plane of 0 to 1
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
    /// Print no progress and no notes
    #[arg(long)]
    quiet: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    /// Size of raw gray frames, one byte per pixel, on standard input
    #[arg(long, value_name = "WxH")]
    raw: Option<Size>,
    #[command(flatten)]
    corners: CornerArgs,
    #[command(flatten)]
    track: TrackArgs,
    #[command(flatten)]
    backend: BackendArgs,
}

/// The flags of detection.
#[derive(Args, Debug)]
#[command(next_help_heading = "Corners")]
struct CornerArgs {
    /// The most live tracks, 1 to 65535
    #[arg(long, value_name = "N", default_value = "500", value_parser = whole_within(1, MAX_POINTS))]
    max_corners: usize,
    /// Detect new corners when fewer tracks than this live, at most --max-corners; 0 for never [default: half of
    /// --max-corners, 0 with --points]
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    min_tracks: Option<usize>,
    /// The least response of a corner relative to the largest one, above 0 and up to 1
    #[arg(long, value_name = "SHARE", default_value_t = 0.01, allow_negative_numbers = true)]
    quality_level: f64,
    /// The least distance between corners, and from live tracks, 0 to 16384; below 1 it has no effect
    #[arg(long, value_name = "PX", default_value_t = 7.0, allow_negative_numbers = true)]
    min_distance: f64,
    /// Side of the block over which gradients are summed, 1 to 64
    #[arg(long, value_name = "PX", default_value_t = 3)]
    block_size: u32,
    /// Harris' response in place of the smaller eigenvalue
    #[arg(long)]
    harris: bool,
    /// Weight of the squared trace in Harris' response, 0 to 1
    #[arg(
        long,
        value_name = "K",
        default_value_t = 0.04,
        allow_negative_numbers = true,
        requires = "harris"
    )]
    k: f64,
}

/// The flags of tracking.
#[derive(Args, Debug)]
#[command(next_help_heading = "Tracking")]
struct TrackArgs {
    /// Side of the window around a point, or its width and height, such as 31x15: each 3 to 1024 and at most the frame's, with
    /// at most 4096 pixels in all
    #[arg(long, value_name = "PX", default_value = "21", value_parser = window)]
    window: [u32; 2],
    /// Levels of the pyramid beside the full image, 0 to 16; those that the window would cover are left out
    #[arg(long, value_name = "N", default_value_t = 3)]
    levels: u32,
    /// The most iterations on each level, 1 to 100
    #[arg(long, value_name = "N", default_value_t = 30)]
    iterations: u32,
    /// Length of a step that ends the iterations, 0 to 10
    #[arg(long, value_name = "PX", default_value_t = 0.01, allow_negative_numbers = true)]
    epsilon: f64,
    /// The least smaller eigenvalue of a window's gradient matrix, in OpenCV's unit, 0 to 10⁹
    #[arg(long, value_name = "VALUE", default_value_t = 1e-4, allow_negative_numbers = true)]
    min_eigenvalue: f64,
    /// Track each point back as well, and end tracks that miss their start by more than this, above 0
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    forward_backward: Option<f32>,
}

/// The flags by the parameters that they set.
const FLAGS: [(&str, &str); 10] = [
    ("max_corners", "--max-corners"),
    ("quality_level", "--quality-level"),
    ("min_distance", "--min-distance"),
    ("block_size", "--block-size"),
    ("k", "--k"),
    ("window", "--window"),
    ("levels", "--levels"),
    ("iterations", "--iterations"),
    ("epsilon", "--epsilon"),
    ("min_eigenvalue", "--min-eigenvalue"),
];

/// Parses a window: one side, or width and height.
fn window(text: &str) -> Result<[u32; 2]> {
    let wrong = |_| Error::parameter("window", format_args!("{text:?}"), "pixels such as 21, or 31x15");
    let (columns, rows) = text.split_once('x').unwrap_or((text, text));
    Ok([columns.trim().parse().map_err(wrong)?, rows.trim().parse().map_err(wrong)?])
}

impl TrackCommand {
    pub(super) fn run(&self) -> Result<Outcome> {
        let config = self.config();
        config.corners.validate().map_err(|error| named_by_flags(error, &FLAGS))?;
        let limit = config.corners.max_corners;
        if config.min_tracks > limit {
            let expected = format_args!("at most --max-corners, {limit}");
            return Err(Error::parameter("--min-tracks", config.min_tracks, expected));
        }
        let points = self.points.as_ref().map(points::read).transpose()?;
        if let (Some(path), Some(points)) = (&self.points, points.as_ref().filter(|all| all.len() > limit)) {
            let expected = format_args!("at most --max-corners, {limit}");
            return Err(Error::format(path, "number of points", points.len(), expected));
        }
        let mut source = Source::open(&self.inputs, self.raw)?;
        let given = [&self.points, &self.mask].into_iter().flatten().map(PathBuf::as_path);
        let read = self.inputs.iter().map(Path::new).chain(given);
        let places = Places::new(self.output.as_deref(), self.overlay.as_deref(), self.json, read)?;
        let images = source.first_two()?;
        let (size, first) = (images[0].size, &self.inputs[0]);
        config.track.validate(size).map_err(|error| named_by_flags(error, &FLAGS))?;
        let mask = self.mask.as_ref().map(|path| input::plane(path, size, first.as_ref())).transpose()?;
        if let (Some(path), Some(points)) = (&self.points, &points) {
            inside(path, points, size, first)?;
        }
        let backend = self.backend.open(self.quiet)?;
        let mut tracker = Tracker::new(&backend, size, images[0].format, &config)
            .map_err(|error| named_by_flags(error, &[("forward_backward_px", "--forward-backward")]))?;
        if let Some(points) = points {
            tracker.set_points(points.iter().map(|point| point.place).collect())?;
        }
        let progress = Progress::of_sequence(source.len(), "frames", 2, self.quiet);
        let mut summary = Summary::new(backend.name(), size);
        let rate = source.rate().unwrap_or((30, 1));
        let done = places.with_writers(size, rate, |writers| {
            follow(&mut tracker, &mut source, images, mask.as_ref(), writers, &mut summary, &progress)
        });
        progress.finish();
        done?;
        if !places.writes_to_stdout() {
            summary.print(self.json)?;
        }
        Ok(Outcome::Done)
    }

    fn config(&self) -> TrackerConfig {
        let CornerArgs { max_corners, min_tracks, quality_level, min_distance, block_size, harris, k } =
            self.corners;
        let TrackArgs { window, levels, iterations, epsilon, min_eigenvalue, forward_backward } = self.track;
        let response = if harris { CornerResponse::Harris { k } } else { CornerResponse::MinEigenvalue };
        TrackerConfig {
            corners: CornerParameters { max_corners, quality_level, min_distance, block_size, response },
            track: TrackParameters { window, levels, iterations, epsilon, min_eigenvalue },
            forward_backward_px: forward_backward,
            min_tracks: min_tracks.unwrap_or(if self.points.is_some() { 0 } else { max_corners / 2 }),
        }
    }
}

/// Checks that given points lie inside the frames.
fn inside(path: &Path, points: &[ListedPoint], size: Size, first: &str) -> Result<()> {
    match points.iter().find(|point| !size.contains(point.place)) {
        None => Ok(()),
        Some(ListedPoint { place: [x, y], line }) => {
            let expected = format_args!("a place inside the {size} of {first}");
            Err(Error::format(path, "a point", format_args!("{x},{y} in line {line}"), expected))
        }
    }
}

fn follow(
    tracker: &mut Tracker,
    source: &mut Source,
    [first, second]: [Image; 2],
    mask: Option<&Plane>,
    writers: &mut Writers<'_, '_>,
    summary: &mut Summary,
    progress: &Progress,
) -> Result<()> {
    let (mut image, mut next) = (first, Some(second));
    for number in 0.. {
        let frame = image.frame()?;
        let start = Instant::now();
        let tracks = tracker.process(&frame, mask)?;
        summary.add(tracks, start.elapsed());
        if !writers.write(number, &frame, tracks)? {
            break;
        }
        progress.inc();
        match next.take() {
            Some(second) => image = second,
            None if source.next(&mut image)? => {}
            None => break,
        }
    }
    Ok(())
}
