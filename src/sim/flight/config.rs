//! Configuration of a flight.

use super::body::Body;
use super::fault::Fault;
use super::sensor::{FlowNoise, Sensor};
use crate::camera::{Camera, FRD_FROM_CAMERA, Lens};
use crate::error::{Error, Result, in_ranges};
use crate::flow::{Algorithm, Farneback, Update, Window};
use crate::frame::Size;
use crate::imu::GyroConfig;
use crate::pipeline::PipelineConfig;
use crate::sim::vehicle::{AirspeedModel, Gusts, GyroErrors, VaneErrors, VerticalSpeedErrors, Wind};
use crate::sim::{Course, RendererConfig};
use crate::sphere::{Derotation, HeadingModel, Sphere};
use crate::steer::SteerParams;

/// The most frames that a command may act after its exposure: one second of them.
pub const MAX_LATENCY_FRAMES: u32 = 30;

/// The configuration of a flight.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FlightConfig {
    /// The vehicle.
    pub body: Body,
    /// The airspeed, m/s: 0.1 to 1000 of a turn, and where an airframe flies level
    /// ([`AirframeParams::level_speeds_m_s`](crate::sim::vehicle::AirframeParams::level_speeds_m_s)).
    pub speed_m_s: f64,
    /// The radius of the ball around the vehicle that must stay free, metres, above 0: half the wing span.
    pub radius_m: f64,
    /// The sensor that the steering uses.
    pub sensor: Sensor,
    /// The camera, at the body's origin, with its optical axis along the body's x axis.
    pub camera: Camera,
    /// How its images are rendered.
    pub renderer: RendererConfig,
    /// The pipeline that computes cues from the images. Its gyro is that of the simulated body, with samples in the body's
    /// frame; without one the rotation stays in the flow, which only [`Sensor::Images`] allows.
    pub pipeline: PipelineConfig,
    /// The parameters of the steering. Its model of the aircraft follows from the body and the latency.
    pub steer: SteerParams,
    /// Frames from an exposure until its command acts, at most [`MAX_LATENCY_FRAMES`].
    pub latency_frames: u32,
    /// The errors of the gyro.
    pub gyro: GyroErrors,
    /// The relative error of the airspeed sensor, 0 or above and below 1.
    pub airspeed_error: f64,
    /// The errors of vanes for the direction of motion; None where the flow itself gives that direction.
    pub vanes: Option<VaneErrors>,
    /// The errors of the vertical speed, by which the heading's elevation is known; `None` leaves it to the flow, as vanes
    /// do.
    pub vertical_speed: Option<VerticalSpeedErrors>,
    /// The wind, the velocity of the air, in m/s, north-east-down, each axis within ±[`MAX_WIND_M_S`](crate::sim::vehicle::MAX_WIND_M_S).
    pub wind_ned_m_s: glam::DVec3,
    /// The gusts, if any.
    pub gusts: Option<Gusts>,
    /// The errors that [`Sensor::NoisyFlow`] adds to the true flow.
    pub flow_noise: FlowNoise,
    /// The faults, each with its times.
    pub faults: Vec<Fault>,
    /// Whether each frame's flow is compared with the true one. Only with [`Sensor::Images`].
    pub measure: bool,
    /// Whether a flight goes on after a surface came nearer than the radius, through it if need be, so that all such
    /// touches of a way are counted. It ends as [`Outcome::Crashed`](super::Outcome::Crashed) all the same.
    pub fly_on: bool,
    /// A flight is given up after this many times the duration of the straight way, at least 1.
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
                // A box window averages a thin trunk with its background, which shows the trunk a sixth too far away; a
                // wide Gaussian over increments, a few per cent. After priming, one iteration finds the rest.
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
                    // Steering goes by nearness rates.
                    directional: true,
                    ..Sphere::default()
                },
                // The gyro measures in the body's frame, whose x axis the camera looks along.
                gyro: Some(GyroConfig {
                    camera_from_gyro: FRD_FROM_CAMERA.transpose(),
                    ..GyroConfig::default()
                }),
                max_remaining_rad_s: 0.1,
                ..PipelineConfig::default()
            },
            steer: SteerParams::default(),
            latency_frames: 1,
            gyro: GyroErrors::default(),
            airspeed_error: AirspeedModel::USUAL,
            vanes: None,
            vertical_speed: Some(VerticalSpeedErrors::default()),
            wind_ned_m_s: glam::DVec3::ZERO,
            gusts: None,
            flow_noise: FlowNoise::default(),
            faults: Vec::new(),
            measure: false,
            fly_on: false,
            patience: 2.0,
        }
    }
}

/// A wide camera of this size with the usual barrel distortion: 96° across between the middles of the sides, 87° without
/// the distortion.
pub fn camera(size: Size) -> Camera {
    barrel_camera(size, 0.53 * f64::from(size.width))
}

/// That camera with another horizontal field of view: between the middles of the sides, without the distortion, radians.
pub fn camera_of_fov(size: Size, fov_rad: f64) -> Camera {
    barrel_camera(size, 0.5 * f64::from(size.width) / (0.5 * fov_rad).tan())
}

fn barrel_camera(size: Size, f: f64) -> Camera {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let lens = Lens { coefficients: [-0.28, 0.075, 3e-4, -2e-4, 0.0, 0.0, 0.0, 0.0] };
    Camera { size, f_u: f, f_v: f, u_0: 0.5 * (width - 1.0), v_0: 0.5 * (height - 1.0), lens }
}

/// The same camera with other pixels: its images resized to the width, and cut or widened to the height.
pub(crate) fn resized(camera: &Camera, size: Size) -> Camera {
    let scale = f64::from(size.width) / f64::from(camera.size.width);
    let rows = 0.5 * (f64::from(size.height) - scale * f64::from(camera.size.height));
    Camera {
        size,
        f_u: scale * camera.f_u,
        f_v: scale * camera.f_v,
        u_0: scale * (camera.u_0 + 0.5) - 0.5,
        v_0: scale * (camera.v_0 + 0.5) - 0.5 + rows,
        lens: camera.lens,
    }
}

impl FlightConfig {
    /// The gyro, which every sensor but [`Sensor::Images`] needs.
    pub(super) fn required_gyro(&self) -> Result<GyroConfig> {
        self.pipeline.gyro.ok_or_else(|| {
            let found = format_args!("none with the sensor {}", self.sensor);
            Error::parameter("pipeline.gyro", found, format_args!("a gyro, or the sensor {}", Sensor::Images))
        })
    }

    /// The time after which a flight of this course is given up, seconds.
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
    /// [`Error::Parameter`], naming the first one that is out of range; also for a fault that the sensor cannot show, for a
    /// speed at which the body cannot fly level, for a camera without an undistorted view, and for a sensor other than
    /// [`Sensor::Images`] without a gyro.
    pub fn validate(&self) -> Result<()> {
        self.camera.validate()?;
        self.pipeline.validate()?;
        self.pipeline.ideal(&self.camera)?;
        self.steer.validate()?;
        in_ranges(&[
            ("radius_m", self.radius_m, 1e-3, 1e3),
            ("flow_noise.blur_px", self.flow_noise.blur_px, 1e-3, 1e3),
            ("flow_noise.white_px", self.flow_noise.white_px, 0.0, 1e3),
            ("flow_noise.relative", self.flow_noise.relative, 0.0, 1.0),
            ("patience", self.patience, 1.0, 1e3),
        ])?;
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
        if self.sensor != Sensor::Images {
            self.required_gyro()?;
        }
        self.body.validate(self.speed_m_s)?;
        self.gyro.validate()?;
        Wind::new(self.wind_ned_m_s, self.gusts, 0)?;
        self.faults.iter().try_for_each(|fault| fault.validate().and_then(|()| fault.check(self.sensor)))
    }
}
