//! The map of danger, with the chosen arc.

use glam::DVec3;

use crate::report::canvas::Canvas;
use crate::report::colours::{ARC, BACKGROUND, DIM, TEXT, time_colour};
use crate::sim::flight::FlightFrame;
use crate::sphere::angles_rad;
use crate::steer::Arc;

/// The colour of unknown directions.
const UNKNOWN: [u8; 3] = [14, 16, 20];
/// Rates below this are drawn as 0, 1/s.
const LEAST_HZ: f64 = 0.1;

/// Draws steering's map of danger, with the direction of motion in the centre.
pub(super) fn draw(canvas: &mut Canvas<'_>, seen: &FlightFrame<'_>) {
    let map = seen.steering.map();
    let grid = &map.grid;
    canvas.fill(BACKGROUND);
    let [width, height] = canvas.size();
    let cell = [width / grid.columns as f64, height / grid.rows as f64];
    for (at, (rate_hz, known)) in map.rates_hz.iter().zip(&map.known).enumerate() {
        let (column, row) = ((at % grid.columns) as f64, (at / grid.columns) as f64);
        let corners = [
            [column * cell[0] + 0.5, row * cell[1] + 0.5],
            [(column + 1.0) * cell[0] - 0.5, (row + 1.0) * cell[1] - 0.5],
        ];
        if *known <= 0.0 {
            canvas.rectangle(corners, UNKNOWN, 1.0);
        }
        if *rate_hz >= LEAST_HZ {
            let opacity = if *known > 0.0 { 0.9 } else { 0.35 };
            canvas.rectangle(corners, time_colour(rate_hz.recip()), opacity);
        }
    }
    let place = |[azimuth, elevation]: [f64; 2]| {
        let [left, right] = grid.azimuth_rad;
        let [top, bottom] = grid.elevation_rad;
        [width * (azimuth - left) / (right - left), height * (elevation - top) / (bottom - top)]
    };
    let [left, right] = grid.azimuth_rad;
    canvas.stroke(&[place([left, 0.0]), place([right, 0.0])], 1.0, DIM);
    let motion = seen.record.velocity_ned_m_s;
    if let Some(arc) = seen.steering.arc() {
        let yaw_rad = motion.y.atan2(motion.x);
        canvas.stroke(&directions(arc, yaw_rad).map(place).collect::<Vec<_>>(), 3.0, ARC);
    }
    let climb_rad = (-motion.z).atan2(motion.x.hypot(motion.y));
    let [x, y] = place([0.0, climb_rad]);
    canvas.stroke(&[[x - 7.0, y], [x + 7.0, y]], 2.0, TEXT);
    canvas.stroke(&[[x, y - 7.0], [x, y + 7.0]], 2.0, TEXT);
}

/// Azimuth and elevation of the points of an arc, relative to a level view along a yaw.
fn directions(arc: &Arc, yaw_rad: f64) -> impl Iterator<Item = [f64; 2]> {
    let (sin, cos) = yaw_rad.sin_cos();
    arc.path_ned_m.iter().map(move |place| {
        let (ahead, right) = (cos * place.x + sin * place.y, cos * place.y - sin * place.x);
        angles_rad(DVec3::new(right, place.z, ahead))
    })
}
