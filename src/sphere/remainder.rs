//! What of the camera's turn is left in the flow after the gyro's has been taken out.

use glam::{DMat3, DVec3};

use super::eigen::symmetric_eigen;
use super::sectors::Sectors;

/// Rounds of finding the turn with the direction of motion held, and the direction with the turn held.
const ROUNDS: usize = 12;
/// Sectors that are needed at least.
const LEAST_SECTORS: usize = 12;
/// How far the turn must be determined about every axis, against the sectors' number.
const LEAST_SHARE: f64 = 0.01;

/// The camera's angular rate that the sectors' flow still shows, rad/s in the camera's frame; none where they do not tell.
///
/// Moving along v, a static point at a bearing p is seen to move within the plane of p and v. What moves across that plane,
/// along n = p × v, is a turn: F·n = (p × ω)·n. That is linear in ω for a given v, and linear in v for a given ω, so that
/// the two are found in turns by least squares; sectors that fit badly lose weight (S. Geman and D. McClure, 1987). It is
/// the epipolar constraint for small motions: A. Bruss and B. Horn, Passive navigation, CVGIP 21, 1983.
pub fn remaining_turn_rad_s(sectors: &Sectors) -> Option<DVec3> {
    let grid = sectors.grid;
    let seen: Vec<(DVec3, DVec3, f64)> = (sectors.sectors.iter().enumerate())
        .filter(|(_, sector)| sector.is_known())
        .map(|(at, sector)| {
            let p = grid.bearing(at % grid.columns, at / grid.columns);
            (p, sector.flow_rad_s, sector.coverage * sector.confidence)
        })
        .filter(|(_, flow, weight)| flow.is_finite() && *weight > 0.0)
        .collect();
    if seen.len() < LEAST_SECTORS {
        return None;
    }
    // Something fast that moves by itself must not lead the first round astray.
    let mut speeds: Vec<f64> = seen.iter().map(|(_, flow, _)| flow.length()).collect();
    speeds.sort_by(f64::total_cmp);
    let usual = speeds[speeds.len() / 2].max(1e-4);
    let first = |flow: &DVec3, weight: f64| weight / (1.0 + flow.length_squared() / (usual * usual));
    let mut weights: Vec<f64> = seen.iter().map(|(_, flow, weight)| first(flow, *weight)).collect();
    let mut turn = DVec3::ZERO;
    for _ in 0..ROUNDS {
        let moment = seen.iter().zip(&weights).fold(DMat3::ZERO, |sum, ((p, flow, _), weight)| {
            let normal = p.cross(*flow - p.cross(turn));
            // The length of a flow says how near things are, not how well it is known.
            let size = normal.length_squared() + 1e-4;
            sum + *weight / size * outer(normal, normal)
        });
        let direction = symmetric_eigen(&moment).1[0];
        let (mut a, mut b, mut total) = (DMat3::ZERO, DVec3::ZERO, 0.0);
        let across = |p: &DVec3| p.cross(direction).try_normalize();
        for ((p, flow, _), weight) in seen.iter().zip(&weights) {
            let Some(normal) = across(p) else { continue };
            let slope = normal.cross(*p);
            a += *weight * outer(slope, slope);
            b += *weight * slope * flow.dot(normal);
            total += weight;
        }
        if !(symmetric_eigen(&a).0[0] > LEAST_SHARE * total) {
            return None;
        }
        turn = a.inverse() * b;
        let misfits: Vec<f64> = (seen.iter())
            .map(|(p, flow, _)| across(p).map_or(0.0, |normal| (flow - p.cross(turn)).dot(normal).abs()))
            .collect();
        let mut sorted = misfits.clone();
        sorted.sort_by(f64::total_cmp);
        let typical = (2.0 * sorted[sorted.len() / 2]).max(1e-4);
        for ((weight, (_, flow, trust)), misfit) in weights.iter_mut().zip(&seen).zip(misfits) {
            *weight = first(flow, *trust) / (1.0 + (misfit / typical).powi(2)).powi(2);
        }
    }
    turn.is_finite().then_some(turn)
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::{Grid, model};

    /// A flight over a ground with things on it, and a turn that is left in the flow.
    fn sectors(v: DVec3, turn: DVec3, noise: f64, wrong: bool) -> Sectors {
        let grid = Grid { columns: 24, rows: 18, azimuth_rad: [-0.7, 0.7], elevation_rad: [0.55, -0.55] };
        let mut sectors = Sectors::unknown(grid);
        sectors.interval_s = 1.0 / 30.0;
        let mut random = crate::kernels::cases::Random::new(3);
        let mut draw = || f64::from(random.next()) - 0.5;
        for at in 0..grid.len() {
            let p = grid.bearing(at % 24, at / 24);
            let nearness = if p.y > 0.05 { p.y / 10.0 } else { 0.02 + 0.06 * (draw() + 0.5) };
            let off = noise * DVec3::new(draw(), draw(), draw());
            let mut flow = model::bearing_rate(p, nearness, v, turn) + off - p * p.dot(off);
            if wrong && at % 24 > 20 {
                flow = 0.8 * p.cross(DVec3::X);
            }
            let sector = &mut sectors.sectors[at];
            (sector.coverage, sector.confidence, sector.flow_rad_s) = (1.0, 1.0, flow);
        }
        sectors
    }

    #[test]
    fn a_turn_is_told_from_moving_along() {
        for v in [DVec3::new(0.0, 0.5, 12.0), DVec3::new(2.0, -0.5, 11.0)] {
            for turn in
                [DVec3::ZERO, DVec3::splat(0.087), DVec3::new(0.0, 0.1, 0.0), DVec3::new(-0.05, 0.0, 0.2)]
            {
                for wrong in [false, true] {
                    let found = remaining_turn_rad_s(&sectors(v, turn, 0.02, wrong));
                    let error = found.map(|found| (found - turn).length());
                    assert!(error.is_some_and(|error| error < 0.012), "{v} {turn} {wrong}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn where_little_is_seen_nothing_is_told() {
        let mut few = sectors(DVec3::Z * 12.0, DVec3::ZERO, 0.0, false);
        few.sectors.iter_mut().skip(11).for_each(|sector| sector.coverage = 0.0);
        assert_eq!(remaining_turn_rad_s(&few), None);
        few.sectors.iter_mut().for_each(|sector| {
            (sector.coverage, sector.flow_rad_s) = (1.0, DVec3::NAN);
        });
        assert_eq!(remaining_turn_rad_s(&few), None);
    }
}
