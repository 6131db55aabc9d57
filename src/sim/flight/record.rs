//! What is kept of a flight.

use glam::DVec3;

use super::accuracy::Measured;
use super::perception::{Perception, SensorInput};
use crate::camera::roll_pitch_yaw_rad;
use crate::quantile::median;
use crate::sim::Course;
use crate::sim::vehicle::VehicleState;
use crate::sphere::{Heading, Sectors};
use crate::steer::{Command, Decision, Source, View};

/// How far off the direction of motion sectors may lie that say what is met there, radians.
const AHEAD_RAD: f64 = 0.1;

/// What is kept of a frame. It holds nothing that differs from one run to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The frame's number, from 0.
    pub frame: u64,
    /// Its time, seconds.
    pub time_s: f64,
    /// Where the vehicle is, metres NED.
    pub position_ned_m: DVec3,
    /// How it moves over ground, m/s NED.
    pub velocity_ned_m_s: DVec3,
    /// Its roll, pitch and yaw.
    pub roll_pitch_yaw_rad: [f64; 3],
    /// Its angular rate, rad/s FRD.
    pub rate_body_rad_s: DVec3,
    /// Its airspeed, m/s.
    pub airspeed_m_s: f64,
    /// From its middle to the nearest surface, metres.
    pub clearance_m: f64,
    /// How far it has come towards the goal, metres.
    pub progress_m: f64,
    /// How far it is to the right of the middle of the way, where that has one.
    pub offset_m: Option<f64>,
    /// Why the view says nothing; none if it does.
    pub invalid: Option<String>,
    /// The share of the view that is trusted, 0 to 1.
    pub coverage: f64,
    /// Angle between the direction of motion that the view tells and the true one; none where it tells none.
    pub heading_error_rad: Option<f64>,
    /// Time to contact along the direction of motion, as the view says within 0.1 rad of it.
    pub contact_s: Option<f64>,
    /// The same, in truth.
    pub true_contact_s: Option<f64>,
    /// How far the flow is from the true one, where that is [measured](super::FlightConfig::measure).
    pub measured: Option<Measured>,
    /// What was decided.
    pub command: Command,
    /// By what.
    pub source: Source,
    /// How dangerous the way is that was chosen, 0 to 1.
    pub danger: Option<f64>,
    /// The command that acts from this frame to the next: one that was decided some frames before.
    pub acting: Command,
}

impl Record {
    /// What is kept of a frame: where the vehicle is, what the sensor says, and what became of it.
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

/// Seconds until contact in a direction: by the median of the sectors around it, since a single one there says little.
fn ahead_s(sectors: &Sectors, direction: DVec3) -> Option<f64> {
    let grid = sectors.grid;
    let around = (0..grid.len())
        .filter(|at| grid.bearing(at % grid.columns, at / grid.columns).dot(direction) > AHEAD_RAD.cos());
    let known = around.map(|at| &sectors.sectors[at]).filter(|sector| sector.is_known());
    let rate_hz = median(known.map(|sector| sector.nearness_rate_hz[1]))?;
    (rate_hz > 0.0).then(|| (rate_hz.recip() - 0.5 * sectors.interval_s).max(0.0))
}
