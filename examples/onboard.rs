//! A vehicle's loop: it feeds gyro samples and frames to a pipeline and acts on the cues. `onboard` needs no file and
//! no cargo feature: it computes the frames of a flight at 5 m/s towards a wall 6 m ahead, with a gyro at 200 Hz.

use glam::{DMat3, DVec3};
use viewsphere::camera::{Camera, Lens, Pose};
use viewsphere::frame::{Frame, PixelFormat, Size};
use viewsphere::imu::{GyroConfig, GyroSample};
use viewsphere::{Backend, Cue, Pipeline, PipelineConfig};

const WALL_M: f64 = 6.0;
const SPEED_M_S: f64 = 5.0;
const GYRO_RATE_HZ: f64 = 200.0;
const FRAME_RATE_HZ: f64 = 30.0;

fn main() -> viewsphere::Result<()> {
    let size = Size::new(320, 240);
    let camera = Camera { size, f_u: 160.0, f_v: 160.0, u_0: 159.5, v_0: 119.5, lens: Lens::NONE };
    let config = PipelineConfig { gyro: Some(GyroConfig::default()), ..PipelineConfig::default() };
    let mut pipeline = Pipeline::new(Backend::Cpu, &camera, &config)?;
    let mut samples = (0..).map(|i| gyro(f64::from(i) / GYRO_RATE_HZ)).peekable();
    for number in 0..30 {
        let time_s = f64::from(number) / FRAME_RATE_HZ;
        // Up to one sample after the frame, so that the rotation until then is known.
        while let Some(sample) = samples.next_if(|sample| sample.time_s < time_s + 1.0 / GYRO_RATE_HZ) {
            pipeline.push_gyro(sample);
        }
        let picture = picture(&camera, &pose(time_s));
        act(&pipeline.process(&Frame::new(size, PixelFormat::Gray8, &picture)?, time_s)?);
    }
    Ok(())
}

/// Acts on a cue. An invalid cue must not steer; what to do without a cue is the vehicle's decision.
fn act(cue: &Cue<'_>) {
    let what = match (&cue.invalid, &cue.threat) {
        (Some(reason), _) => format!("hold: {reason}"),
        (None, Some(threat)) if threat.alarm => {
            let side = if threat.azimuth_rad < 0.0 { "right" } else { "left" };
            format!(
                "turn {side}: {:.2} s to what is at {:+.1}°",
                threat.time_s,
                threat.azimuth_rad.to_degrees()
            )
        }
        (None, _) => "go on".to_owned(),
    };
    println!("{:.3} s  {what}", cue.time_s);
}

/// The gyro's sample: the vehicle yaws to and fro while it moves straight on.
fn gyro(time_s: f64) -> GyroSample {
    GyroSample { time_s, gyro_rad_s: DVec3::Y * 0.6 * (8.0 * time_s).cos() }
}

fn pose(time_s: f64) -> Pose {
    let world_from_camera = DMat3::from_rotation_y(0.6 / 8.0 * (8.0 * time_s).sin());
    Pose { position_world: DVec3::Z * SPEED_M_S * time_s, world_from_camera }
}

/// The camera's image of a wall with a texture of waves, one byte per pixel.
fn picture(camera: &Camera, pose: &Pose) -> Vec<u8> {
    let gray = |i: u32| {
        let (u, v) = (i % camera.size.width, i / camera.size.width);
        let ray = pose.world_from_camera * camera.ray([f64::from(u), f64::from(v)]).unwrap_or(DVec3::Z);
        let place = pose.position_world + ray * ((WALL_M - pose.position_world.z) / ray.z);
        // Wave numbers in rad/m along x and y: the shortest wave is 0.5 m long.
        let waves = [(12.0, 3.0), (-4.0, 11.0), (5.0, 7.0), (-7.0, 4.0), (2.0, -3.0)];
        let sum: f64 = waves.iter().map(|(x, y)| (x * place.x + y * place.y).sin()).sum();
        (128.0 + 24.0 * sum).round() as u8
    };
    (0..camera.size.width * camera.size.height).map(gray).collect()
}
