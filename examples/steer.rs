//! From frames, a gyro, attitude and airspeed to bank and climb, in a closed loop: an autopilot's use of viewsphere.
//! `steer` needs no file: its aircraft, a point mass in coordinated turns, flies at 12 m/s towards a simulated wall.

use viewsphere::camera::FRD_FROM_CAMERA;
use viewsphere::imu::GyroConfig;
use viewsphere::sim::flight::FlightConfig;
use viewsphere::sim::vehicle::{
    CoordinatedTurn, GyroErrors, GyroModel, STEP_S, Start, TurnParams, Vehicle, Wind,
};
use viewsphere::sim::{CourseKind, RayTable, reference_render};
use viewsphere::steer::{Aircraft, Goal, Observation, SteerConfig, Steering, View};
use viewsphere::{Backend, Pipeline, PipelineConfig};

/// Steps of the gyro, at 240 Hz, per frame.
const STEPS: usize = 8;

fn main() -> viewsphere::Result<()> {
    // The configuration of flow and sectors in simulated flights. The gyro's axes are the body's: forward, right, down.
    let FlightConfig { camera, pipeline, .. } = FlightConfig::default();
    let gyro = GyroConfig { camera_from_gyro: FRD_FROM_CAMERA.transpose(), ..GyroConfig::default() };
    let mut pipeline =
        Pipeline::new(Backend::Cpu, &camera, &PipelineConfig { gyro: Some(gyro), ..pipeline })?;
    // Here commands act at once; for a real aircraft, set its latency.
    let aircraft = Aircraft { latency_s: 0.0, ..Aircraft::default() };
    let mut steering = Steering::new(SteerConfig { aircraft, ..SteerConfig::default() })?;

    let course = "wall:distance=50:incidence=0:offset=5".parse::<CourseKind>()?.course(3)?;
    let start = Start { position_ned_m: course.start_ned_m, yaw_rad: course.start_yaw_rad, speed_m_s: 12.0 };
    let mut aircraft = CoordinatedTurn::new(&TurnParams::default(), &start, Wind::calm())?;
    let mut sensor = GyroModel::new(&GyroErrors::default(), 1)?;
    let rays = RayTable::new(&camera)?;
    while course.progress_m(aircraft.state().position_ned_m) < course.length_m {
        let state = aircraft.state();
        pipeline.push_gyro(sensor.sample(&state));
        let view = reference_render(&course.world, &rays, &state.camera_pose());
        let cue = pipeline.process(&view.image.frame()?, state.time_s)?;
        let decision = steering.update(&Observation {
            time_s: state.time_s,
            ned_from_body: state.world_from_body,
            airspeed_m_s: state.air_velocity_body_m_s.length(),
            motion_body: None,
            goal: Goal { yaw_rad: course.goal_yaw_rad, too_low_m: None },
            view: View::of(&cue),
        });
        println!(
            "{:.2} s  bank {:+4.0}°, climb {:+3.0}°, by {:?}; {:.1} m clear",
            state.time_s,
            decision.command.bank_rad.to_degrees(),
            decision.command.climb_rad.to_degrees(),
            decision.source,
            course.world.clearance_m(state.position_ned_m),
        );
        for step in 1..=STEPS {
            aircraft.advance(&decision.command, STEP_S);
            // The sample of the last step is pushed with the next frame.
            if step < STEPS {
                pipeline.push_gyro(sensor.sample(&aircraft.state()));
            }
        }
    }
    Ok(())
}
