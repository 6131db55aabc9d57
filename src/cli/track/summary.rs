//! The summary of the tracks.

use std::time::Duration;

use serde::Serialize;

use crate::cli::print;
use crate::error::Result;
use crate::frame::Size;
use crate::quantile::median;
use crate::tracking::{Track, TrackStatus};

/// Figures over all frames.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    backend: String,
    width: u32,
    height: u32,
    frames: u64,
    /// Tracks that were begun.
    tracks: u64,
    /// Tracks that live in the last frame.
    live: u64,
    lost: u64,
    inconsistent: u64,
    outside: u64,
    /// The mean number of frames over which a track is seen, the first one included.
    mean_length_frames: f64,
    /// The medians over all tracks and frames.
    median_shift_px: Option<f64>,
    median_error: Option<f64>,
    median_fb_error_px: Option<f64>,
    /// The median time of a frame, from the image to its tracks.
    median_ms: Option<f64>,
    #[serde(skip)]
    values: Values,
}

#[derive(Debug, Default)]
struct Values {
    shifts: Vec<f64>,
    errors: Vec<f64>,
    back: Vec<f64>,
    times: Vec<f64>,
    seen: u64,
}

impl Summary {
    pub(super) fn new(backend: String, size: Size) -> Self {
        Self {
            backend,
            width: size.width,
            height: size.height,
            frames: 0,
            tracks: 0,
            live: 0,
            lost: 0,
            inconsistent: 0,
            outside: 0,
            mean_length_frames: 0.0,
            median_shift_px: None,
            median_error: None,
            median_fb_error_px: None,
            median_ms: None,
            values: Values::default(),
        }
    }

    pub(super) fn add(&mut self, tracks: &[Track], time: Duration) {
        self.frames += 1;
        self.live = 0;
        for track in tracks {
            match track.status {
                TrackStatus::New => self.tracks += 1,
                TrackStatus::Tracked => {
                    let [u, v] = track.shift.map(f64::from);
                    self.values.shifts.push(u.hypot(v));
                    self.values.errors.push(f64::from(track.error));
                    self.values.back.extend(track.forward_backward_px.map(f64::from));
                }
                TrackStatus::Lost => self.lost += 1,
                TrackStatus::Inconsistent => self.inconsistent += 1,
                TrackStatus::Outside => self.outside += 1,
            }
            if track.status.is_live() {
                self.live += 1;
                self.values.seen += 1;
            }
        }
        self.values.times.push(time.as_secs_f64() * 1e3);
    }

    /// Prints to standard output, as JSON or as text.
    pub(super) fn print(&mut self, json: bool) -> Result<()> {
        let values = std::mem::take(&mut self.values);
        self.mean_length_frames = values.seen as f64 / self.tracks.max(1) as f64;
        self.median_shift_px = median(values.shifts);
        self.median_error = median(values.errors);
        self.median_fb_error_px = median(values.back);
        self.median_ms = median(values.times);
        if json {
            return print::json(self);
        }
        let number = |value: Option<f64>, unit: &str| match value {
            Some(value) => format!("{value:.3} {unit}"),
            None => "none".to_owned(),
        };
        print::text(&format!(
            "{} frames of {}×{} on {}\n\
             tracks   {}, {} live at the end, {:.1} frames each in the mean\n\
             ended    {} lost, {} inconsistent, {} outside\n\
             median   shift {}, error {}, forward-backward error {}\n\
             time     median {} per frame",
            self.frames,
            self.width,
            self.height,
            self.backend,
            self.tracks,
            self.live,
            self.mean_length_frames,
            self.lost,
            self.inconsistent,
            self.outside,
            number(self.median_shift_px, "px"),
            number(self.median_error, "gray levels"),
            number(self.median_fb_error_px, "px"),
            number(self.median_ms, "ms"),
        ))
    }
}
