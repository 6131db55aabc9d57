//! From raw frames and a gyro to cues: time to contact, heading and threats, frame by frame.

mod config;
mod cue;

use glam::{DMat3, DVec3};

pub use config::PipelineConfig;
pub use cue::{Cue, Invalid, InvalidKind, OwnedCue};

use crate::backend::Backend;
use crate::camera::Camera;
use crate::error::Result;
use crate::frame::Frame;
use crate::gpu::Gpu;
use crate::imu::{Gyro, GyroSample};
use crate::plan::{Plan, Value};
use crate::sphere::{
    self, AlarmFilter, Cameras, Cells, Climb, Grid, Heading, HeadingFilter, Motion, Sectors, plan,
};
use crate::stream::{Latency, Stats, Stream, Ticket};

/// Computes a [`Cue`] per frame from a camera's frames, their times and a gyro's samples.
///
/// All per-pixel work is one submission per frame, and only the outputs that the configuration asks for are read back.
/// Push a frame's gyro samples before you submit it, up to one after the middle of its exposure.
pub struct Pipeline {
    stream: Stream<Submitted>,
    config: PipelineConfig,
    ideal: Camera,
    cells: Cells,
    gyro: Option<Gyro>,
    last: Option<Last>,
    sectors: Sectors,
    heading: Heading,
    /// The time of the frame that the heading belongs to, seconds.
    heading_time_s: f64,
    given: Option<Heading>,
    climb: Option<Climb>,
    headings: HeadingFilter,
    alarms: AlarmFilter,
}

/// The most recently submitted frame.
#[derive(Clone, Copy)]
struct Last {
    frame: u64,
    /// When its image was taken: of a repeated image, the time of its first appearance.
    time_s: f64,
    /// Its own time, as the caller gave it.
    given_s: f64,
    digest: u64,
}

/// The state of a frame at its submission.
struct Submitted {
    time_s: f64,
    before: Option<Last>,
    turn: Option<DMat3>,
    climb: Option<Climb>,
    fault: Option<Invalid>,
}

impl Submitted {
    fn interval_s(&self) -> Option<f64> {
        self.before.map(|before| self.time_s - before.time_s)
    }
}

impl Pipeline {
    /// Creates a pipeline for the frames of a camera.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a parameter or camera that is out of range,
    /// [`Error::SizeMismatch`](crate::Error::SizeMismatch) for a mask of another size than the camera's; and as
    /// [`Stream::new`].
    pub fn new(backend: Backend, camera: &Camera, config: &PipelineConfig) -> Result<Self> {
        config.validate()?;
        camera.validate()?;
        let ideal = config.ideal(camera)?;
        ideal.validate()?;
        let cameras =
            Cameras { raw: camera, ideal: &ideal, mask: config.mask.as_ref(), gyro: config.gyro.is_some() };
        let PipelineConfig { algorithm, certainty, format, fields, .. } = config;
        let (mut plan, cells, grid) = plan(algorithm, *certainty, &config.sphere, cameras, *format, *fields)?;
        plan.outputs.retain(|port| config.read_flow || port.name != "flow");
        Ok(Self {
            stream: Stream::new(&backend, plan, &config.stream)?,
            ideal,
            cells,
            gyro: config.gyro.map(Gyro::new).transpose()?,
            last: None,
            sectors: Sectors::unknown(grid),
            heading: Heading::UNKNOWN,
            heading_time_s: f64::NAN,
            given: None,
            climb: None,
            headings: HeadingFilter::new(config.sphere.heading),
            alarms: AlarmFilter::new(config.alarm, &grid)?,
            config: config.clone(),
        })
    }

    /// Takes a sample of the gyro. Without [`PipelineConfig::gyro`] it is ignored.
    pub fn push_gyro(&mut self, sample: GyroSample) {
        if let Some(gyro) = &mut self.gyro {
            gyro.push(sample);
        }
    }

    /// Sets the heading at the next submitted frame, in the camera's frame, as measured by a wind vane or by satellite
    /// navigation: it is better than the flow's own estimate. It stays until it is set again; `None` returns to the
    /// flow's estimate.
    pub fn set_heading(&mut self, heading: Option<Heading>) {
        self.given = heading;
    }

    /// Sets how steeply the camera climbs at the next submitted frame, and at that alone: the heading that the flow shows then
    /// keeps its azimuth and gets this elevation.
    ///
    /// # Errors
    /// As [`Climb::validate`]; the climb is then unknown.
    pub fn set_climb(&mut self, climb: Option<Climb>) -> Result<()> {
        self.climb = None;
        climb.as_ref().map_or(Ok(()), Climb::validate)?;
        self.climb = climb;
        Ok(())
    }

    /// Submits a frame with the time of the middle of its exposure, in seconds of the camera's clock. See
    /// [`Stream::submit`].
    ///
    /// # Errors
    /// As [`Stream::submit`].
    pub fn submit(&mut self, frame: &Frame<'_>, time_s: f64) -> Result<Ticket> {
        let before = self.last;
        let digest = digest(frame);
        let frozen = before.filter(|before| before.digest == digest);
        let (turn, fault) = self.turn(before, time_s);
        let fault = match (frozen, fault) {
            // The frames arrive in time; only the image that they repeat is too old for a pair.
            (Some(before), Some(Invalid::Interval { .. })) if self.is_pair(time_s - before.given_s) => {
                Some(Invalid::Frozen)
            }
            (frozen, fault) => fault.or(frozen.map(|_| Invalid::Frozen)),
        };
        if let Some(Invalid::Interval { .. }) = fault {
            self.stream.reset();
        }
        let climb = self.climb.take();
        let seen =
            || climb.map_or(self.turned_heading(time_s), |climb| climb.of(self.turned_heading(time_s)));
        let heading = self.given.unwrap_or_else(seen);
        let motion = Motion { prev_from_cur: turn.unwrap_or(DMat3::IDENTITY), heading };
        let motion = motion.values();
        let given = [("frame", Some(Value::Frame(frame))), ("motion", Some(Value::Raw(&motion)))];
        let ticket = self.stream.submit(&given, Submitted { time_s, before, turn, climb, fault })?;
        // Later frames are compared with the time at which the image was new.
        let taken_s = frozen.map_or(time_s, |before| before.time_s);
        self.last = Some(Last { frame: ticket.frame(), time_s: taken_s, given_s: time_s, digest });
        Ok(ticket)
    }

    /// Whether a frame is done. See [`Stream::poll`].
    ///
    /// # Errors
    /// As [`Stream::poll`].
    pub fn poll(&mut self, ticket: &Ticket) -> Result<bool> {
        self.stream.poll(ticket)
    }

    /// Waits for a frame. Wait for frames in the order in which they were submitted: the heading found in one is used
    /// for the next.
    ///
    /// # Errors
    /// As [`Stream::wait`].
    pub fn wait(&mut self, ticket: Ticket) -> Result<Cue<'_>> {
        let Self { stream, config, sectors, headings, alarms, given, heading, heading_time_s, .. } = self;
        let done = stream.wait(ticket)?;
        let frame = done.payload;
        let interval_s = frame.interval_s();
        let lost = done.previous != frame.before.map(|before| before.frame);
        let mut invalid = frame.fault.or(lost.then_some(Invalid::Lost));
        let (mut outputs, mut threat) = (None, None);
        let mut residual_rotation_rad_s = None;
        let pair = done.outputs.and_then(|found| Some((found, found.raw("sectors")?, interval_s?)));
        match pair {
            Some((found, summed, interval_s)) if !lost => {
                sectors.read(summed, interval_s);
                outputs = Some(found);
                let coverage = sectors.coverage();
                let least = config.least_coverage;
                invalid = invalid
                    .or((!(coverage >= least)).then_some(Invalid::Coverage { found: coverage, least }));
                if invalid.is_none() && config.watches_turn() {
                    residual_rotation_rad_s = sphere::residual_rotation_rad_s(sectors);
                    let found_rad_s = residual_rotation_rad_s.map_or(0.0, DVec3::length);
                    let most_rad_s = config.max_remaining_rad_s;
                    invalid =
                        (!(found_rad_s <= most_rad_s)).then_some(Invalid::Turn { found_rad_s, most_rad_s });
                }
                if invalid.is_none() {
                    let found = headings.update(sectors, &frame.turn.unwrap_or(DMat3::IDENTITY));
                    let found = frame.climb.map_or(found, |climb| climb.of(found));
                    (*heading, *heading_time_s) = (given.unwrap_or(found), frame.time_s);
                    threat = alarms.update(sectors, heading);
                }
            }
            _ => {
                *sectors = Sectors::unknown(sectors.grid);
                alarms.reset();
            }
        }
        Ok(Cue {
            frame: done.frame,
            time_s: frame.time_s,
            interval_s,
            invalid,
            prev_from_cur: frame.turn,
            residual_rotation_rad_s,
            heading: *heading,
            sectors,
            threat,
            flow: outputs.and_then(|outputs| outputs.flow("flow")),
            looming: outputs.and_then(|outputs| outputs.raw("looming")),
            cells: outputs.and_then(|outputs| outputs.raw("cells")),
            spherical_flow: outputs.and_then(|outputs| outputs.raw("tangent")),
            latency: done.latency,
        })
    }

    /// Submits a frame and waits for it.
    ///
    /// # Errors
    /// As [`Stream::process`].
    pub fn process(&mut self, frame: &Frame<'_>, time_s: f64) -> Result<Cue<'_>> {
        let ticket = self.submit(frame, time_s)?;
        self.stream.finish(ticket)?;
        self.wait(ticket)
    }

    /// The camera's rotation since the previous frame, or the reason why it is unknown or why the two frames are not
    /// paired.
    fn turn(&self, before: Option<Last>, time_s: f64) -> (Option<DMat3>, Option<Invalid>) {
        let Some(before) = before else { return (None, Some(Invalid::First)) };
        let (interval_s, limit_s) = (time_s - before.time_s, self.config.max_interval_s);
        if !self.is_pair(interval_s) {
            return (None, Some(Invalid::Interval { interval_s, limit_s }));
        }
        match self.gyro.as_ref().map(|gyro| gyro.prev_from_cur(before.time_s, time_s)) {
            None => (None, None),
            Some(Ok(turn)) => (Some(turn), None),
            Some(Err(fault)) => (None, Some(Invalid::Gyro(fault))),
        }
    }

    /// Whether frames this far apart are paired.
    fn is_pair(&self, interval_s: f64) -> bool {
        interval_s > 0.0 && interval_s <= self.config.max_interval_s
    }

    /// The heading in the camera's frame at a later time.
    fn turned_heading(&self, time_s: f64) -> Heading {
        let turn = self.gyro.as_ref().map(|gyro| gyro.prev_from_cur(self.heading_time_s, time_s));
        let Some(Ok(turn)) = turn else { return self.heading };
        let cur_from_prev = self.config.sphere.heading.cur_from_prev(&turn);
        Heading { direction: cur_from_prev * self.heading.direction, ..self.heading }
    }

    /// Restarts the stream: the next frame is a first frame, and the heading is unknown.
    pub fn reset(&mut self) {
        self.stream.reset();
        self.last = None;
        self.heading = Heading::UNKNOWN;
        self.headings.reset();
        self.alarms.reset();
    }

    /// The stream's counts.
    pub fn stats(&self) -> Stats {
        self.stream.stats()
    }

    /// The executor: the adapter's name, or the CPU and its number of threads.
    pub fn adapter(&self) -> String {
        self.stream.adapter()
    }

    /// The device in use, if it is a GPU. After a loss it is a new device.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.stream.gpu()
    }

    /// The latencies of the last frames with a result.
    pub fn latency(&self) -> Latency {
        self.stream.latency()
    }

    /// The computation of a frame.
    pub fn plan(&self) -> &Plan {
        self.stream.plan()
    }

    /// The ideal camera: the pinhole in whose image the flow is computed.
    pub fn ideal(&self) -> &Camera {
        &self.ideal
    }

    /// The grid of sectors over the view.
    pub fn grid(&self) -> &Grid {
        &self.sectors.grid
    }

    /// The cells over which the flow is averaged.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }
}

/// A hash of an image's pixels: two different images have the same one with a chance of 1 in 2⁶⁴.
fn digest(frame: &Frame<'_>) -> u64 {
    // Fibonacci hashing, eight bytes at a time.
    const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
    let mixed = |sum: u64, word: u64| (sum ^ word).wrapping_mul(FACTOR).rotate_left(29);
    (0..frame.size().height).fold(0, |sum, y| {
        let (words, rest) = frame.row(y).as_chunks::<8>();
        let sum = words.iter().fold(sum, |sum, word| mixed(sum, u64::from_le_bytes(*word)));
        rest.iter().fold(sum, |sum, byte| mixed(sum, u64::from(*byte)))
    })
}
