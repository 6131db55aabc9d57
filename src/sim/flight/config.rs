//! What a flight is made of and told.

use crate::camera::{Camera, Lens};
use crate::error::{Error, Result};
use crate::flow::{Algorithm, Farneback, Update, Window};
use crate::frame::Size;
use crate::imu::GyroConfig;
use crate::pipeline::PipelineConfig;
use crate::sim::vehicle::{
    AirframeParams, AirspeedModel, Autopilot, Gusts, GyroErrors, TurnParams, VaneErrors, Wind,
};
use crate::sim::{Course, RendererConfig};
use crate::sphere::{Derotation, HeadingModel, Sphere};
use crate::steer::SteerConfig;

use super::Fault;

/// What the steering sees by: a ladder from what is known exactly to what a camera gives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sensor {
    /// The true nearness and the true direction of motion.
    Depth,
    /// The true flow of each cell.
    Flow,
    /// The true flow, blurred as a window blurs it, and noisy.
    NoisyFlow,
    /// Pictures through a lens, and a [`Pipeline`](crate::Pipeline).
    #[default]
    Images,
}

/// What [`Sensor::NoisyFlow`] does to the true flow. The defaults stand for Farnebäck's flow in pictures of 320×240, as a
/// flight computes it: the better half of the cells in a corridor are 0.064 px off in the median, which is a standard
/// deviation of 0.055 px along each axis, and what windows of 3 px on each level (with the expansion's 1.2 px) let through is
/// halved at the same detail as by a Gaussian of 3.1 px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowNoise {
    /// Standard deviation of the Gaussian that it is blurred with, in pixels, above 0.
    pub blur_px: f64,
    /// Standard deviation of what is added to each cell along two axes, in pixels.
    pub white_px: f64,
    /// Standard deviation of the factor that it is multiplied with, against 1.
    pub relative: f64,
}

impl Default for FlowNoise {
    fn default() -> Self {
        Self { blur_px: 3.1, white_px: 0.055, relative: 0.03 }
    }
}

/// The most frames that a command may act after its exposure: one second of them.
pub const MAX_LATENCY_FRAMES: u32 = 30;

/// What flies.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// A point in coordinated turns.
    Turn(TurnParams),
    /// A rigid body with an inner loop.
    Airframe {
        /// The airframe.
        params: Box<AirframeParams>,
        /// Its inner loop.
        autopilot: Autopilot,
    },
}

impl Default for Body {
    fn default() -> Self {
        Self::Airframe { params: Box::default(), autopilot: Autopilot::default() }
    }
}

/// How a flight is flown.
#[derive(Clone, Debug)]
pub struct FlightConfig {
    /// What flies.
    pub body: Body,
    /// Its airspeed, m/s: 0.1 to 1000 of a turn, and where an airframe flies level
    /// ([`AirframeParams::level_speeds_m_s`]).
    pub speed_m_s: f64,
    /// The radius of the ball around its middle that must stay free, metres, above 0: half the wing span.
    pub radius_m: f64,
    /// What the steering sees by.
    pub sensor: Sensor,
    /// The camera, at the body's origin, its axis along the body's x axis.
    pub camera: Camera,
    /// How its pictures come about.
    pub renderer: RendererConfig,
    /// How they are looked at. The gyro is set by the flight.
    pub pipeline: PipelineConfig,
    /// What is done about it. The camera's mounting and the latency are set by the flight, and how the aircraft follows
    /// commands where that is known: of a coordinated turn.
    pub steer: SteerConfig,
    /// Frames from an exposure until its command acts, at most [`MAX_LATENCY_FRAMES`].
    pub latency_frames: u32,
    /// What the gyro gets wrong.
    pub gyro: GyroErrors,
    /// The share by which the airspeed sensor may be wrong, 0 or above and below 1.
    pub airspeed_error: f64,
    /// What vanes for the direction of motion get wrong; none where that is taken from the flow itself.
    pub vanes: Option<VaneErrors>,
    /// Where the air moves to, m/s NED, each axis within ±[`MAX_WIND_M_S`](crate::sim::vehicle::MAX_WIND_M_S).
    pub wind_ned_m_s: glam::DVec3,
    /// Gusts, if there are any.
    pub gusts: Option<Gusts>,
    /// What [`Sensor::NoisyFlow`] does to the true flow.
    pub flow_noise: FlowNoise,
    /// What goes wrong, and when.
    pub faults: Vec<Fault>,
    /// Whether each frame's flow is held against the true one. Only with [`Sensor::Images`].
    pub measure: bool,
    /// A flight that takes this many times as long as the straight way is given up, at least 1.
    pub patience: f64,
}

impl Default for FlightConfig {
    fn default() -> Self {
        Self {
            body: Body::default(),
            speed_m_s: 12.0,
            radius_m: 0.6,
            sensor: Sensor::default(),
            camera: camera(Size::new(320, 240)),
            renderer: RendererConfig::default(),
            pipeline: PipelineConfig {
                // A box takes in what is behind a thin trunk, and shows it a sixth farther away than it is; of increments a
                // wide Gaussian a few per cent. One iteration finds what is left of a primed search.
                algorithm: Algorithm::from(Farneback {
                    winsize: 21,
                    iterations: 1,
                    window: Window::Gaussian,
                    update: Update::Increment,
                    ..Farneback::default()
                }),
                sphere: Sphere {
                    derotation: Derotation::Primed,
                    heading: HeadingModel::Turning,
                    sectors: [48, 30],
                    cell: 4,
                    step: 2,
                    window: 1,
                    ..Sphere::default()
                },
                gyro: Some(GyroConfig::default()),
                max_remaining_rad_s: 0.1,
                ..PipelineConfig::default()
            },
            steer: SteerConfig::default(),
            latency_frames: 1,
            gyro: GyroErrors::default(),
            airspeed_error: AirspeedModel::USUAL,
            vanes: None,
            wind_ned_m_s: glam::DVec3::ZERO,
            gusts: None,
            flow_noise: FlowNoise::default(),
            faults: Vec::new(),
            measure: false,
            patience: 2.0,
        }
    }
}

/// A wide camera of this size with the usual barrel distortion: 96° across between the middles of the sides without it.
pub fn camera(size: Size) -> Camera {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let f = 0.53 * width;
    let lens = Lens { coefficients: [-0.28, 0.075, 3e-4, -2e-4, 0.0, 0.0, 0.0, 0.0] };
    Camera { size, f_u: f, f_v: f, u_0: 0.5 * (width - 1.0), v_0: 0.5 * (height - 1.0), lens }
}

impl FlightConfig {
    /// When a flight of this course is given up, seconds.
    pub(super) fn longest_s(&self, course: &Course) -> f64 {
        self.patience * course.length_m / self.speed_m_s
    }

    /// Checks that every fault begins before a flight of this course is given up.
    ///
    /// # Errors
    /// [`Error::Parameter`] naming the first that does not.
    pub(crate) fn check_faults_in(&self, course: &Course) -> Result<()> {
        let longest_s = self.longest_s(course);
        let Some(fault) = self.faults.iter().find(|fault| !(fault.from_s <= longest_s)) else {
            return Ok(());
        };
        let found = format_args!("{fault} in {}", course.name);
        let expected = format_args!("one that begins before the flight is given up, at {longest_s:.1} s");
        Err(Error::parameter("fault", found, expected))
    }

    /// Checks every parameter's range.
    ///
    /// # Errors
    /// [`Error::Parameter`], naming the first one that is out of range, also for a fault that the sensor shows nothing of,
    /// for a speed at which the body cannot fly level, and for a camera whose picture has no view without its lens.
    pub fn validate(&self) -> Result<()> {
        self.camera.validate()?;
        self.pipeline.validate()?;
        self.pipeline.ideal(&self.camera)?;
        self.steer.validate()?;
        for (name, value, low, high) in [
            ("radius_m", self.radius_m, 1e-3, 1e3),
            ("flow_noise.blur_px", self.flow_noise.blur_px, 1e-3, 1e3),
            ("flow_noise.white_px", self.flow_noise.white_px, 0.0, 1e3),
            ("flow_noise.relative", self.flow_noise.relative, 0.0, 1.0),
            ("patience", self.patience, 1.0, 1e3),
        ] {
            if !(low..=high).contains(&value) {
                return Err(Error::parameter(name, value, format_args!("{low} to {high}")));
            }
        }
        if self.latency_frames > MAX_LATENCY_FRAMES {
            let expected = format_args!("0 to {MAX_LATENCY_FRAMES}");
            return Err(Error::parameter("latency_frames", self.latency_frames, expected));
        }
        if self.measure && self.sensor != Sensor::Images {
            let expected = format!("the sensor {}", Sensor::Images);
            return Err(Error::parameter(
                "measure",
                format_args!("on with the sensor {}", self.sensor),
                expected,
            ));
        }
        match &self.body {
            Body::Turn(params) => {
                params.validate()?;
                if !(0.1..=1e3).contains(&self.speed_m_s) {
                    return Err(Error::parameter("speed_m_s", self.speed_m_s, "0.1 to 1000 m/s"));
                }
            }
            Body::Airframe { params, autopilot } => {
                autopilot.validate()?;
                params.trim(self.speed_m_s)?;
            }
        }
        self.gyro.validate()?;
        Wind::new(self.wind_ned_m_s, self.gusts, 0)?;
        self.faults.iter().try_for_each(|fault| fault.validate().and_then(|()| fault.check(self.sensor)))
    }
}
