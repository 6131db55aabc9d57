//! The record of a frame.

use glam::DVec3;

use super::accuracy::Measured;
use super::perception::{Perception, SensorInput};
use crate::camera::roll_pitch_yaw_rad;
use crate::quantile::median;
use crate::sim::Course;
use crate::sim::vehicle::VehicleState;
use crate::sphere::{Heading, Sectors};
use crate::steer::{Command, Decision, Source, View};

/// The angle from the direction of motion, radians, within which sectors count towards the time to contact ahead.
const AHEAD_RAD: f64 = 0.1;

/// The record of a frame. It has nothing that differs from one run to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The frame's number, from 0.
    pub frame: u64,
    /// The frame's time, seconds.
    pub time_s: f64,
    /// The vehicle's position, metres NED.
    pub position_ned_m: DVec3,
    /// The vehicle's velocity over ground, m/s NED.
    pub velocity_ned_m_s: DVec3,
    /// The vehicle's roll, pitch and yaw.
    pub roll_pitch_yaw_rad: [f64; 3],
    /// The vehicle's angular rate, rad/s FRD.
    pub rate_body_rad_s: DVec3,
    /// The airspeed, m/s.
    pub airspeed_m_s: f64,
    /// The clearance from the vehicle's centre to the nearest surface, metres.
    pub clearance_m: f64,
    /// The progress towards the goal, metres.
    pub progress_m: f64,
    /// The offset to the right of the centre line, metres; `None` for courses without one.
    pub offset_m: Option<f64>,
    /// Why there is no valid view; `None` if there is one.
    pub invalid: Option<String>,
    /// The share of the field of view whose flow is trusted, 0 to 1.
    pub coverage: f64,
    /// The angle between the view's heading and the true direction of motion; `None` without a heading.
    pub heading_error_rad: Option<f64>,
    /// The view's time to contact along the direction of motion, from the sectors within 0.1 rad of it.
    pub contact_s: Option<f64>,
    /// The true time to contact along the direction of motion.
    pub true_contact_s: Option<f64>,
    /// The error of the flow, if it is [measured](super::FlightConfig::measure).
    pub measured: Option<Measured>,
    /// The command decided at this frame.
    pub command: Command,
    /// The origin of that command.
    pub source: Source,
    /// The danger of the chosen arc, 0 to 1.
    pub danger: Option<f64>,
    /// The command in effect from this frame to the next, decided some frames earlier.
    pub acting: Command,
}

impl Record {
    /// The record of a frame, from the vehicle's state, the sensor's output and the decision.
    pub(super) fn of(
        course: &Course,
        at: &SensorInput<'_>,
        state: &VehicleState,
        perception: &Perception<'_>,
        decision: Decision,
        acting: Command,
    ) -> Self {
        let motion = at.velocity_world_m_s;
        let ahead = at.pose.world_from_camera.transpose() * motion.normalize_or(DVec3::X);
        let true_rate_hz = course.world.seen(&at.pose, ahead).nearness_per_m * motion.length();
        let heading = perception.view.map(|view| view.heading).filter(Heading::is_known);
        let sectors =
            perception.view.map(|view| view.sectors).or(perception.cue.as_ref().map(|cue| cue.sectors));
        let contact_s = perception.view.and_then(|View { sectors, .. }| ahead_s(sectors, ahead));
        Self {
            frame: at.frame,
            time_s: at.time_s,
            position_ned_m: state.position_ned_m,
            velocity_ned_m_s: state.velocity_ned_m_s,
            roll_pitch_yaw_rad: roll_pitch_yaw_rad(&state.world_from_body),
            rate_body_rad_s: state.rate_body_rad_s,
            airspeed_m_s: state.air_velocity_body_m_s.length(),
            clearance_m: course.world.clearance_m(state.position_ned_m),
            progress_m: course.progress_m(state.position_ned_m),
            offset_m: course.offset_m(state.position_ned_m),
            invalid: perception.invalid.clone(),
            coverage: sectors.map_or(0.0, Sectors::coverage),
            heading_error_rad: heading.map(|heading| heading.direction.angle_between(ahead)),
            contact_s,
            true_contact_s: (true_rate_hz > 0.0).then(|| true_rate_hz.recip()),
            measured: perception.measured,
            command: decision.command,
            source: decision.source,
            danger: decision.danger,
            acting,
        }
    }
}

/// The time to contact in a direction, seconds: from the median of the sectors around it, as a single sector is too
/// noisy.
fn ahead_s(sectors: &Sectors, direction: DVec3) -> Option<f64> {
    let grid = sectors.grid;
    let around = (0..grid.len())
        .filter(|at| grid.bearing(at % grid.columns, at / grid.columns).dot(direction) > AHEAD_RAD.cos());
    let known = around.map(|at| &sectors.sectors[at]).filter(|sector| sector.is_known());
    let rate_hz = median(known.map(|sector| sector.nearness_rate_hz[1]))?;
    (rate_hz > 0.0).then(|| (rate_hz.recip() - 0.5 * sectors.interval_s).max(0.0))
}
