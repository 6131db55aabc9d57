//! Flights through worlds with known ground truth, as seen by a pipeline.

use glam::{DMat3, DQuat, DVec3};
use viewsphere::camera::{Camera, Lens, Pose};
use viewsphere::frame::Size;
use viewsphere::imu::GyroSample;
use viewsphere::sim::{RayTable, World, reference_render};
use viewsphere::sphere::Sectors;
use viewsphere::{Backend, Cue, Pipeline, PipelineConfig};

/// Frame rate.
pub(crate) const RATE_HZ: f64 = 30.0;

/// A straight flight with constant rotation of the camera.
#[derive(Clone, Copy)]
pub(crate) struct FlightPath {
    /// The camera's position at time 0, its axes along the world's.
    pub(crate) start_world: DVec3,
    pub(crate) velocity_world: DVec3,
    /// In the camera's frame.
    pub(crate) omega_rad_s: DVec3,
}

impl FlightPath {
    pub(crate) fn pose(&self, time_s: f64) -> Pose {
        Pose {
            position_world: self.start_world + self.velocity_world * time_s,
            world_from_camera: DMat3::from_quat(DQuat::from_scaled_axis(self.omega_rad_s * time_s)),
        }
    }

    /// The camera's velocity in its own frame.
    pub(crate) fn velocity_camera(&self, time_s: f64) -> DVec3 {
        self.pose(time_s).world_from_camera.transpose() * self.velocity_world
    }
}

/// A wide-angle lens with typical barrel distortion.
pub(crate) fn camera() -> Camera {
    let lens = Lens::new(&[-0.28, 0.075, 3e-4, -2e-4, 0.0]).unwrap_or(Lens::NONE);
    Camera { size: Size::new(640, 480), f_u: 340.0, f_v: 340.0, u_0: 322.5, v_0: 236.0, lens }
}

/// Flies a number of frames that end at a given time, and passes on each cue with the camera's pose.
pub(crate) fn fly(
    config: PipelineConfig,
    world: &World,
    flight: &FlightPath,
    last_time_s: f64,
    frames: u32,
    mut show: impl FnMut(&Cue<'_>, &Camera),
) {
    fn good<T>(result: viewsphere::Result<T>) -> T {
        result.unwrap_or_else(|error| panic!("{error}"))
    }
    let camera = camera();
    let rays = good(RayTable::new(&camera));
    let config = PipelineConfig { gyro: Some(config.gyro.unwrap_or_default()), ..config };
    let mut pipeline = good(Pipeline::new(Backend::Cpu, &camera, &config));
    let first_s = last_time_s - f64::from(frames - 1) / RATE_HZ;
    let mut gyro_s = first_s - 0.005;
    for i in 0..frames {
        let time_s = first_s + f64::from(i) / RATE_HZ;
        while gyro_s < time_s + 0.005 {
            pipeline.push_gyro(GyroSample { time_s: gyro_s, gyro_rad_s: flight.omega_rad_s });
            gyro_s += 0.0025;
        }
        let view = reference_render(world, &rays, &flight.pose(time_s));
        let ideal = *pipeline.ideal();
        let cue = good(pipeline.process(&good(view.image.frame()), time_s));
        show(&cue, &ideal);
    }
}

/// The true median nearness rate of each sector, 1/s; `None` where less than half of it shows a surface.
pub(crate) fn true_rates_hz(
    world: &World,
    flight: &FlightPath,
    time_s: f64,
    sectors: &Sectors,
    ideal: &Camera,
) -> Vec<Option<f64>> {
    let pose = flight.pose(time_s);
    let speed = flight.velocity_world.length();
    let grid = sectors.grid;
    let mut rates = vec![Vec::new(); grid.len()];
    for y in (4..ideal.size.height).step_by(8) {
        for x in (4..ideal.size.width).step_by(8) {
            let Some(ray) = ideal.ray([f64::from(x), f64::from(y)]) else { continue };
            if let Some([column, row]) = grid.sector(ray) {
                rates[row * grid.columns + column].push(world.seen(&pose, ray).nearness_per_m * speed);
            }
        }
    }
    let median = |rates: &mut Vec<f64>| {
        rates.sort_by(f64::total_cmp);
        rates.get(rates.len() / 2).copied().filter(|rate| *rate > 0.0)
    };
    rates.iter_mut().map(median).collect()
}
