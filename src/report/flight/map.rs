//! The map: the vehicle's surroundings from above.

use glam::{DVec2, DVec3};

use crate::report::canvas::Canvas;
use crate::report::colours::{self, ARC, BACKGROUND, DIM, TEXT, time_colour};
use crate::report::footprint::Footprint;
use crate::sim::Course;
use crate::sim::flight::{FlightFrame, Record};

/// The distance from the lower border to the upper one, metres.
pub(super) const SPAN_M: f64 = 90.0;
/// The vehicle's position from the left and from the top, as shares of the map.
pub(super) const VEHICLE: [f64; 2] = [0.5, 0.8];
pub(super) const SOLID: [u8; 3] = [122, 132, 150];
pub(super) const PATH: [u8; 3] = [90, 170, 255];
pub(super) const MIDDLE: [u8; 3] = [64, 72, 88];

/// The static part of a map.
#[derive(Debug)]
pub(super) struct Ground {
    pub(super) footprints: Vec<Footprint>,
    pub(super) centre_line_m: Vec<DVec2>,
    start_m: DVec2,
    pub(super) length_m: f64,
    /// Unit vectors towards the goal and to the right of it, north and east.
    axes: [DVec2; 2],
}

impl Ground {
    pub(super) fn new(course: &Course) -> Self {
        let height_m = -course.start_ned_m.z;
        let footprints = (course.world.surfaces.iter())
            .filter_map(|surface| Footprint::of(&surface.form(), height_m))
            .collect();
        let (sin, cos) = course.goal_yaw_rad.sin_cos();
        Self {
            footprints,
            centre_line_m: course.centre_line_m.clone(),
            start_m: course.start_ned_m.truncate(),
            length_m: course.length_m,
            axes: [DVec2::new(cos, sin), DVec2::new(-sin, cos)],
        }
    }

    /// A vector along north and east, as one to the right and towards the goal.
    pub(super) fn turned(&self, way: DVec2) -> [f64; 2] {
        [way.dot(self.axes[1]), way.dot(self.axes[0])]
    }

    /// A position relative to the start, to the right and towards the goal.
    #[cfg(feature = "io")]
    pub(super) fn offset_from_start(&self, place: DVec2) -> [f64; 2] {
        self.turned(place - self.start_m)
    }
}

/// A course, and the path flown so far.
#[derive(Debug)]
pub(super) struct Map {
    ground: Ground,
    path_m: Vec<DVec2>,
}

impl Map {
    pub(super) fn new(course: &Course) -> Self {
        Self { ground: Ground::new(course), path_m: Vec::new() }
    }

    /// Draws the surroundings, with the goal's direction up.
    pub(super) fn draw(&mut self, canvas: &mut Canvas<'_>, seen: &FlightFrame<'_>) {
        let record = seen.record;
        let here = record.position_ned_m.truncate();
        self.path_m.push(here);
        canvas.fill(BACKGROUND);
        let [width, height] = canvas.size();
        let scale = height / SPAN_M;
        let ground = &self.ground;
        let [ahead, right] = ground.axes;
        let place = |point: DVec2| {
            let [right, ahead] = ground.turned(point - here);
            [VEHICLE[0] * width + scale * right, VEHICLE[1] * height - scale * ahead]
        };
        let around = |off: DVec3| place(here + off.truncate());
        for ends in ground.centre_line_m.windows(2) {
            canvas.stroke(&[place(ends[0]), place(ends[1])], 1.0, MIDDLE);
        }
        let goal = ground.start_m + ground.length_m * ahead;
        let line = [-1e3, 1e3].map(|off| place(goal + off * right));
        canvas.stroke(&line, 2.0, colours::GOAL);
        for footprint in ground.footprints.iter().filter(|footprint| footprint.is_near(here, SPAN_M)) {
            match footprint {
                Footprint::Circle(centre, radius_m) => {
                    canvas.disc(place(*centre), (scale * radius_m).max(1.0), SOLID, 1.0);
                }
                Footprint::Line(ends) => canvas.stroke(&ends.map(place), 2.5, SOLID),
                Footprint::Polygon(corners) => {
                    let corners: Vec<_> = corners.iter().map(|corner| place(*corner)).collect();
                    canvas.polygon(&corners, SOLID, 1.0);
                    // The outline makes a wire visible.
                    let closed: Vec<_> = corners.iter().chain(corners.first()).copied().collect();
                    canvas.stroke(&closed, 1.5, SOLID);
                }
            }
        }
        let path: Vec<_> = self.path_m.iter().map(|point| place(*point)).collect();
        canvas.stroke(&path, 1.5, PATH);
        for obstacle in seen.steering.obstacles() {
            let off = obstacle.place_ned_m;
            let colour = time_colour(off.length() / record.airspeed_m_s.max(0.1));
            canvas.ring(around(off), (scale * obstacle.radius_m).max(2.0), 1.2, colour);
        }
        if let Some(arc) = seen.steering.arc() {
            let points: Vec<_> = std::iter::once(DVec3::ZERO).chain(arc.path_ned_m).map(around).collect();
            canvas.stroke(&points, 3.0, ARC);
        }
        vehicle(canvas, place(here), ground.axes, record);
        let bar = 20.0 * scale;
        let foot = [14.0, height - 14.0];
        canvas.stroke(&[foot, [foot[0] + bar, foot[1]]], 2.0, DIM);
        canvas.text([foot[0], foot[1] - 18.0], "20 m", DIM, 2);
    }
}

/// Draws an arrow in the direction of the nose.
fn vehicle(canvas: &mut Canvas<'_>, at: [f64; 2], [ahead, right]: [DVec2; 2], record: &Record) {
    let (sin, cos) = record.roll_pitch_yaw_rad[2].sin_cos();
    let nose = DVec2::new(cos, sin);
    let (up, across) = (nose.dot(ahead), nose.dot(right));
    let corner =
        |along: f64, aside: f64| [at[0] + along * across + aside * up, at[1] - along * up + aside * across];
    let corners = [corner(12.0, 0.0), corner(-8.0, 8.0), corner(-4.0, 0.0), corner(-8.0, -8.0)];
    canvas.polygon(&corners, TEXT, 1.0);
}
