//! Tracks over a sequence: detection, following, loss and renewed detection.

use super::{MAX_POINTS, PointTracker, TrackParameters, TrackedPoint};
use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::features::{CornerDetector, CornerParameters};
use crate::frame::{Frame, PixelFormat, Plane, Size};

/// The configuration of a [`Tracker`].
#[derive(Clone, Debug, PartialEq)]
pub struct TrackerConfig {
    /// Detection of corners; `max_corners` is the most live tracks, 1 to 65535.
    pub corners: CornerParameters,
    /// Following them.
    pub track: TrackParameters,
    /// The largest forward–backward error of a track in pixels, above 0; `None` follows nothing back.
    pub forward_backward_px: Option<f32>,
    /// Corners are detected again when fewer tracks than this live, so that there are `max_corners` again where the image
    /// has them; they keep their distance from live tracks. At most `max_corners`; 0 detects them in the first frame only.
    pub min_tracks: usize,
}

impl Default for TrackerConfig {
    fn default() -> Self {
        Self {
            corners: CornerParameters::default(),
            track: TrackParameters::default(),
            forward_backward_px: Some(1.0),
            min_tracks: 250,
        }
    }
}

/// What has happened to a track in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackStatus {
    /// It begins.
    New,
    /// It was found.
    Tracked,
    /// It ends: the search has lost it.
    Lost,
    /// It ends: the search back has missed its place in the previous frame by more than the largest error.
    Inconsistent,
    /// It ends: its point lies outside the frame.
    Outside,
}

impl TrackStatus {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::New => "new",
            Self::Tracked => "tracked",
            Self::Lost => "lost",
            Self::Inconsistent => "inconsistent",
            Self::Outside => "outside",
        }
    }

    /// Whether the track goes on in the next frame.
    pub fn is_live(self) -> bool {
        matches!(self, Self::New | Self::Tracked)
    }
}

/// A track in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// Its number, counted from 0 over the sequence.
    pub id: u64,
    /// Frames since its first one.
    pub age: u32,
    /// The column, in pixels; of a track that ends, the last place of the search.
    pub x: f32,
    /// The row, in pixels.
    pub y: f32,
    /// The displacement since the previous frame, in pixels; zero of a new track.
    pub shift: [f32; 2],
    /// What has happened to it.
    pub status: TrackStatus,
    /// The forward–backward error in pixels, if it was followed back and found.
    pub forward_backward_px: Option<f32>,
    /// The mean absolute difference of its windows in both frames, in gray levels; 0 of new and lost tracks.
    pub error: f32,
}

/// Tracks corners over a sequence.
pub struct Tracker {
    config: TrackerConfig,
    size: Size,
    detector: CornerDetector,
    points: PointTracker,
    given: Option<Vec<[f32; 2]>>,
    tracks: Vec<Track>,
    frames: u64,
    next_id: u64,
}

impl Tracker {
    /// Allocates the buffers for frames of this size and format.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a parameter that is out of range; as [`Runner::new`](crate::runner::Runner::new).
    pub fn new(backend: &Backend, size: Size, format: PixelFormat, config: &TrackerConfig) -> Result<Self> {
        let capacity = config.corners.max_corners;
        if !(1..=MAX_POINTS).contains(&capacity) {
            return Err(Error::parameter("max_corners", capacity, format_args!("1 to {MAX_POINTS}")));
        }
        if config.min_tracks > capacity {
            let expected = format_args!("at most max_corners, {capacity}");
            return Err(Error::parameter("min_tracks", config.min_tracks, expected));
        }
        if let Some(limit) = config.forward_backward_px.filter(|limit| !(*limit > 0.0 && limit.is_finite())) {
            return Err(Error::parameter("forward_backward_px", limit, "a finite number of pixels over 0"));
        }
        let backward = config.forward_backward_px.is_some();
        Ok(Self {
            config: config.clone(),
            size,
            detector: CornerDetector::new(backend, size, format, &config.corners)?,
            points: PointTracker::new(backend, size, format, &config.track, capacity, backward)?,
            given: None,
            tracks: Vec::new(),
            frames: 0,
            next_id: 0,
        })
    }

    /// Begins the tracks at these points of the first frame, `[x, y]` in pixels, in place of detected corners.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a point that is not inside the frame, for more of them than `max_corners`, and after the
    /// first frame.
    pub fn set_points(&mut self, points: Vec<[f32; 2]>) -> Result<()> {
        if self.frames > 0 {
            return Err(Error::parameter("points", "given", "none after the first frame"));
        }
        if points.len() > self.config.corners.max_corners {
            let expected = format_args!("at most max_corners, {}", self.config.corners.max_corners);
            return Err(Error::parameter("number of points", points.len(), expected));
        }
        if let Some((i, [x, y])) = points.iter().enumerate().find(|(_, point)| !self.size.contains(**point)) {
            let expected = format_args!("a place inside the frame of {}", self.size);
            return Err(Error::parameter("points", format_args!("({x}, {y}) at index {i}"), expected));
        }
        self.given = Some(points);
        Ok(())
    }

    /// Follows the live tracks into this frame, and begins new ones where fewer than `min_tracks` are left and the mask
    /// (everywhere without one) is over 0. Returns the tracks of this frame by their number, those that end in it included.
    ///
    /// # Errors
    /// [`Error::PixelFormat`] and [`Error::SizeMismatch`] for a frame or mask whose format or size differs from the tracker's;
    /// [`Error::DeviceLost`] if the device was lost.
    pub fn process(&mut self, frame: &Frame<'_>, mask: Option<&Plane>) -> Result<&[Track]> {
        self.tracks.retain(|track| track.status.is_live());
        let places: Vec<[f32; 2]> = self.tracks.iter().map(|track| [track.x, track.y]).collect();
        let tracked = self.points.track(frame, &places, None)?;
        for (i, point) in tracked.iter().enumerate() {
            let track = &mut self.tracks[i];
            track.shift = [point.x - track.x, point.y - track.y];
            track.status = status(point, self.config.forward_backward_px, self.size);
            track.age += 1;
            (track.x, track.y, track.error) = (point.x, point.y, point.error);
            track.forward_backward_px = point.forward_backward_px;
        }
        self.begin(frame, mask)?;
        self.frames += 1;
        Ok(&self.tracks)
    }

    /// Begins new tracks, if they are needed.
    fn begin(&mut self, frame: &Frame<'_>, mask: Option<&Plane>) -> Result<()> {
        let live = self.tracks.iter().filter(|track| track.status.is_live());
        let live: Vec<[f32; 2]> = live.map(|track| [track.x, track.y]).collect();
        let begun = match (self.frames, self.given.take()) {
            (0, Some(points)) => points,
            (0, None) => self.detect(frame, mask, &live)?,
            _ if live.len() < self.config.min_tracks => self.detect(frame, mask, &live)?,
            _ => Vec::new(),
        };
        for [x, y] in begun {
            let (id, status) = (self.next_id, TrackStatus::New);
            let (shift, forward_backward_px) = ([0.0; 2], None);
            self.tracks.push(Track { id, age: 0, x, y, shift, status, forward_backward_px, error: 0.0 });
            self.next_id += 1;
        }
        Ok(())
    }

    fn detect(
        &mut self,
        frame: &Frame<'_>,
        mask: Option<&Plane>,
        live: &[[f32; 2]],
    ) -> Result<Vec<[f32; 2]>> {
        let room = self.config.corners.max_corners.saturating_sub(live.len());
        let corners = self.detector.detect_beside(frame, mask, live, Some(room))?;
        Ok(corners.iter().map(|corner| [corner.x, corner.y]).collect())
    }
}

fn status(point: &TrackedPoint, limit: Option<f32>, size: Size) -> TrackStatus {
    let returns = |limit: f32| point.forward_backward_px.is_some_and(|error| error <= limit);
    if !point.found {
        TrackStatus::Lost
    } else if !size.contains([point.x, point.y]) {
        TrackStatus::Outside
    } else if limit.is_some_and(|limit| !returns(limit)) {
        TrackStatus::Inconsistent
    } else {
        TrackStatus::Tracked
    }
}
