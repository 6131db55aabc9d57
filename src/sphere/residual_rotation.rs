//! The residual rotation: the camera's rotation that is left in the flow after derotation.

use glam::{DMat3, DVec3};

use super::eigen::symmetric_eigen;
use super::sectors::Sectors;
use crate::quantile::median;

/// Iterations of the Gauss–Newton method.
const ROUNDS: usize = 15;
/// The least number of sectors.
const LEAST_SECTORS: usize = 12;
/// Levenberg–Marquardt damping, as a share of the diagonal.
const DAMPING: f64 = 1e-3;
/// Sectors nearer to the direction of motion than this, in radians, do not determine the flow across it.
const NEAR_RAD: f64 = 0.05;
/// Unknowns: the rotation, and the direction of motion along two axes.
const UNKNOWNS: usize = 5;

/// A sector's observation.
struct SectorFlow {
    bearing: DVec3,
    flow: DVec3,
    weight: f64,
}

/// The camera's angular rate that the sectors' flow still shows, rad/s in the camera's frame; `None` where they do not
/// determine it.
///
/// While the camera moves along v, the bearing p of a static point moves within the plane of p and v. Flow across that
/// plane, along n = p × v / |p × v|, is rotation: (F − p × ω)·n = 0, the epipolar constraint for small motions (A.
/// Bruss and B. Horn, Passive navigation, CVGIP 21, 1983). ω and v are found together by least squares; sectors that
/// fit badly lose weight (S. Geman and D. McClure, 1987).
pub fn residual_rotation_rad_s(sectors: &Sectors) -> Option<DVec3> {
    let seen = seen(sectors);
    if seen.len() < LEAST_SECTORS {
        return None;
    }
    let moment = seen.iter().fold(DMat3::ZERO, |sum, sector| {
        let normal = sector.bearing.cross(sector.flow);
        sum + sector.weight / (normal.length_squared() + 1e-4) * outer(normal, normal)
    });
    let (mut turn, mut direction) = (DVec3::ZERO, symmetric_eigen(&moment).1[0]);
    for round in 0..ROUNDS {
        let (a, b) = direction.any_orthonormal_pair();
        let rows: Vec<([f64; UNKNOWNS], f64, f64)> =
            seen.iter().filter_map(|sector| row(sector, turn, direction, [a, b])).collect();
        let typical = (2.0 * median(rows.iter().map(|(_, misfit, _)| misfit.abs()))?).max(1e-4);
        let (mut matrix, mut right) = ([[0.0; UNKNOWNS]; UNKNOWNS], [0.0; UNKNOWNS]);
        for (slopes, misfit, weight) in &rows {
            // The first iteration weights all sectors alike.
            let excess = if round > 0 { misfit / typical } else { 0.0 };
            let weight = weight / (1.0 + excess * excess).powi(2);
            for i in 0..UNKNOWNS {
                (0..UNKNOWNS).for_each(|j| matrix[i][j] += weight * slopes[i] * slopes[j]);
                right[i] -= weight * slopes[i] * misfit;
            }
        }
        (0..UNKNOWNS).for_each(|i| matrix[i][i] *= 1.0 + DAMPING);
        let step = solve(matrix, right)?;
        turn += DVec3::new(step[0], step[1], step[2]);
        direction = (direction + step[3] * a + step[4] * b).try_normalize()?;
    }
    turn.is_finite().then_some(turn)
}

fn seen(sectors: &Sectors) -> Vec<SectorFlow> {
    let grid = sectors.grid;
    let known =
        sectors.sectors.iter().enumerate().filter(|(_, sector)| {
            sector.is_known() && sector.flow_rad_s.is_finite() && sector.confidence > 0.0
        });
    let mut seen: Vec<SectorFlow> = known
        .map(|(at, sector)| SectorFlow {
            bearing: grid.bearing(at % grid.columns, at / grid.columns),
            flow: sector.flow_rad_s,
            weight: sector.coverage * sector.confidence,
        })
        .collect();
    // A fast object with its own motion must not mislead the first iteration.
    let speed = median(seen.iter().map(|sector| sector.flow.length()));
    let usual = speed.map_or(1.0, |speed| speed.max(1e-4));
    seen.iter_mut().for_each(|sector| sector.weight /= 1.0 + (sector.flow.length() / usual).powi(2));
    seen
}

/// A sector's row of the equations: the derivatives of its misfit with respect to the unknowns, the misfit, the weight.
fn row(
    sector: &SectorFlow,
    turn: DVec3,
    direction: DVec3,
    axes: [DVec3; 2],
) -> Option<([f64; UNKNOWNS], f64, f64)> {
    let p = sector.bearing;
    let across = p.cross(direction);
    let length = across.length();
    if !(length > NEAR_RAD) {
        return None;
    }
    let normal = across / length;
    let left = sector.flow - p.cross(turn);
    // The normal rotates with the direction, but stays a unit vector.
    let [along_a, along_b] = axes.map(|axis| {
        let change = p.cross(axis) / length;
        left.dot(change - normal * normal.dot(change))
    });
    let slope = p.cross(normal);
    Some(([slope.x, slope.y, slope.z, along_a, along_b], left.dot(normal), sector.weight))
}

/// Solves linear equations with a positive definite matrix by elimination; `None` where it is not positive definite.
fn solve(mut matrix: [[f64; UNKNOWNS]; UNKNOWNS], mut right: [f64; UNKNOWNS]) -> Option<[f64; UNKNOWNS]> {
    let largest = (0..UNKNOWNS).map(|i| matrix[i][i]).fold(0.0, f64::max);
    for i in 0..UNKNOWNS {
        if !(matrix[i][i] > 1e-9 * largest) {
            return None;
        }
        for j in i + 1..UNKNOWNS {
            let share = matrix[j][i] / matrix[i][i];
            (i..UNKNOWNS).for_each(|k| matrix[j][k] -= share * matrix[i][k]);
            right[j] -= share * right[i];
        }
    }
    for i in (0..UNKNOWNS).rev() {
        let known: f64 = (i + 1..UNKNOWNS).map(|k| matrix[i][k] * right[k]).sum();
        right[i] = (right[i] - known) / matrix[i][i];
    }
    Some(right)
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::{Grid, model};

    /// A flight over ground with objects on it, and a rotation that is left in the flow.
    fn sectors(v: DVec3, turn: DVec3, noise: f64, wrong: bool) -> Sectors {
        let grid = Grid { columns: 24, rows: 18, azimuth_rad: [-0.7, 0.7], elevation_rad: [0.55, -0.55] };
        let mut sectors = Sectors::unknown(grid);
        sectors.interval_s = 1.0 / 30.0;
        let mut random = crate::kernels::test_inputs::Random::new(3);
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
                    let found = residual_rotation_rad_s(&sectors(v, turn, 0.02, wrong));
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
        assert_eq!(residual_rotation_rad_s(&few), None);
        few.sectors.iter_mut().for_each(|sector| {
            (sector.coverage, sector.flow_rad_s) = (1.0, DVec3::NAN);
        });
        assert_eq!(residual_rotation_rad_s(&few), None);
    }
}
