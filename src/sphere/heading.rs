//! The camera's direction of motion, estimated from the flow.

use glam::{DMat3, DVec3};

use super::eigen::symmetric_eigen;
use super::motion::Heading;
use super::sectors::Sectors;
use crate::quantile::median;

/// The share of the previous frames' moment that is kept from frame to frame.
const MEMORY: f64 = 0.8;
/// Iterations of reweighting the sectors by how well they fit.
const ROUNDS: usize = 8;
/// The least ratio of the moment's median eigenvalue to its smallest one, which is noise.
const LEAST_CONTRAST: f64 = 3.0;
/// The error that all sectors share, in radians.
const FLOOR_RAD: f64 = 0.01;
/// The number of sectors whose errors are correlated: together they count as one.
const ALIKE: f64 = 4.0;

/// The quantity that stays constant from frame to frame while the camera rotates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum HeadingModel {
    /// The direction of motion in the world: the vehicle goes straight on, however the camera rotates or shakes.
    #[default]
    Straight,
    /// The direction of motion in the camera's frame: the vehicle flies the way its nose points, as a fixed wing does
    /// in its turns, and the camera is fixed to it.
    Turning,
}

impl HeadingModel {
    /// The rotation that takes the heading in the camera's frame at the earlier exposure into that at the later one.
    pub(crate) fn cur_from_prev(self, prev_from_cur: &DMat3) -> DMat3 {
        match self {
            Self::Straight => prev_from_cur.transpose(),
            Self::Turning => DMat3::IDENTITY,
        }
    }
}

/// Estimates the direction of motion over the last frames.
///
/// Translation along v makes a flow F at a bearing p that lies in the plane of p and v. So v is perpendicular to every
/// `p × F`: it is the eigenvector of `Σ w (p × F)(p × F)ᵀ` with the smallest eigenvalue. Sectors that do not fit, where
/// something moves by itself, lose weight. Of the eigenvector's two signs the estimate takes the one that the flow
/// leads away from.
#[derive(Clone, Debug)]
pub struct HeadingFilter {
    model: HeadingModel,
    moment: DMat3,
    /// The number of sectors in the moment, with the same memory.
    sectors: f64,
}

impl HeadingFilter {
    /// A filter without any frame so far.
    pub fn new(model: HeadingModel) -> Self {
        Self { model, moment: DMat3::ZERO, sectors: 0.0 }
    }

    /// Forgets all previous frames.
    pub fn reset(&mut self) {
        *self = Self::new(self.model);
    }

    /// The direction of motion in the camera's frame at the later exposure, from this pair and the previous ones.
    pub fn update(&mut self, sectors: &Sectors, prev_from_cur: &DMat3) -> Heading {
        let cur_from_prev = self.model.cur_from_prev(prev_from_cur);
        let kept = MEMORY * (cur_from_prev * self.moment * cur_from_prev.transpose());
        // A sector's weight is bounded: a fast object with its own motion is one sector among many.
        let traces = sectors.moments.iter().map(trace);
        let usual = median(traces.filter(|trace| *trace > 0.0)).unwrap_or(1.0);
        let moments: Vec<DMat3> = (sectors.moments.iter())
            .filter(|moment| trace(moment) > 0.0)
            .map(|moment| *moment * (trace(moment) + usual).recip())
            .collect();
        let mut sum = moments.iter().fold(kept, |sum, moment| sum + *moment);
        for _ in 0..ROUNDS {
            let (values, axes) = symmetric_eigen(&sum);
            if !(values[2] > 0.0) {
                return Heading::UNKNOWN;
            }
            let misfit = |moment: &DMat3| axes[0].dot(*moment * axes[0]) / trace(moment).max(1e-30);
            let typical = median(moments.iter().map(misfit)).map_or(1.0, |median| median.max(1e-6));
            // Geman and McClure's weights: a sector that fits far worse than most counts for nothing.
            sum = moments.iter().fold(kept, |sum, moment| {
                let excess = misfit(moment) / (4.0 * typical);
                sum + *moment * (1.0 + excess * excess).recip()
            });
        }
        self.moment = sum;
        self.sectors = MEMORY * self.sectors + moments.len() as f64;
        let (values, axes) = symmetric_eigen(&sum);
        if !(values[1] > LEAST_CONTRAST * values[0]) {
            return Heading::UNKNOWN;
        }
        let independent = (self.sectors / ALIKE).max(1.0);
        let error_rad = (values[0] / (values[1] - values[0]) / independent).sqrt().hypot(FLOOR_RAD);
        Heading { direction: leading(axes[0], sectors), error_rad }
    }
}

fn trace(m: &DMat3) -> f64 {
    m.x_axis.x + m.y_axis.y + m.z_axis.z
}

/// The axis with the sign that the flow leads away from.
fn leading(axis: DVec3, sectors: &Sectors) -> DVec3 {
    let grid = sectors.grid;
    let along: f64 = (sectors.sectors.iter().enumerate())
        .map(|(i, sector)| {
            let p = grid.bearing(i % grid.columns, i / grid.columns);
            let expected = p * p.dot(axis) - axis;
            sector.coverage * sector.confidence * sector.flow_rad_s.dot(expected)
        })
        .sum();
    if along < 0.0 { -axis } else { axis }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::Grid;

    /// Sectors as a static world of random depths gives them, one of them with something that moves by itself.
    fn sectors(v: DVec3, wrong: bool) -> Sectors {
        let grid = Grid { columns: 24, rows: 9, azimuth_rad: [-0.8, 0.8], elevation_rad: [0.6, -0.6] };
        let mut sectors = Sectors::unknown(grid);
        sectors.interval_s = 1.0;
        let mut random = crate::kernels::test_inputs::Random::new(5);
        for i in 0..grid.len() {
            let p = grid.bearing(i % 24, i / 24);
            let mut flow = (0.01 + 0.05 * f64::from(random.next())) * (p * p.dot(v) - v);
            let noise = DVec3::new(random.next().into(), random.next().into(), random.next().into()) - 0.5;
            flow += 4e-4 * (noise - p * p.dot(noise));
            if wrong && i % 24 > 20 {
                flow = 0.05 * p.cross(DVec3::X);
            }
            let normal = p.cross(flow);
            sectors.moments[i] =
                20.0 * DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
            sectors.sectors[i].coverage = 1.0;
            sectors.sectors[i].confidence = 1.0;
            sectors.sectors[i].flow_rad_s = flow;
        }
        sectors
    }

    #[test]
    fn the_direction_is_found_also_beside_the_axis_and_backwards() {
        for v in [DVec3::Z, DVec3::new(0.3, -0.1, 0.9), DVec3::new(-0.8, 0.1, 0.2), -DVec3::Z] {
            let v = v.normalize();
            let found =
                HeadingFilter::new(HeadingModel::Straight).update(&sectors(v, false), &DMat3::IDENTITY);
            assert!(found.direction.angle_between(v) < 0.02, "{found:?} for {v}");
            assert!(found.error_rad < 0.05, "{found:?}");
        }
    }

    #[test]
    fn what_moves_by_itself_does_not_mislead() {
        let v = DVec3::new(0.1, 0.05, 1.0).normalize();
        let found = HeadingFilter::new(HeadingModel::Straight).update(&sectors(v, true), &DMat3::IDENTITY);
        assert!(found.direction.angle_between(v) < 0.05, "{found:?}");
    }

    #[test]
    fn without_motion_nothing_is_known() {
        let mut still = sectors(DVec3::Z, false);
        still.moments.iter_mut().for_each(|moment| *moment = DMat3::ZERO);
        assert_eq!(
            HeadingFilter::new(HeadingModel::Straight).update(&still, &DMat3::IDENTITY),
            Heading::UNKNOWN
        );
        still.moments.iter_mut().for_each(|moment| *moment = 1e-8 * DMat3::IDENTITY);
        assert_eq!(
            HeadingFilter::new(HeadingModel::Straight).update(&still, &DMat3::IDENTITY),
            Heading::UNKNOWN
        );
    }

    #[test]
    fn what_was_known_turns_with_the_camera() {
        let mut filter = HeadingFilter::new(HeadingModel::Straight);
        let v = DVec3::new(0.2, 0.0, 1.0).normalize();
        filter.update(&sectors(v, false), &DMat3::IDENTITY);
        // The camera turns right by 0.2: what was ahead is now to the left.
        let prev_from_cur = DMat3::from_rotation_y(0.2);
        let mut nothing = sectors(v, false);
        nothing.moments.iter_mut().for_each(|moment| *moment = DMat3::ZERO);
        let turned = filter.update(&nothing, &prev_from_cur).direction;
        let expected = prev_from_cur.transpose() * v;
        assert!(turned.angle_between(expected).min(turned.angle_between(-expected)) < 0.02, "{turned}");
        // An aircraft turns with its camera.
        let mut filter = HeadingFilter::new(HeadingModel::Turning);
        filter.update(&sectors(v, false), &DMat3::IDENTITY);
        let kept = filter.update(&nothing, &prev_from_cur).direction;
        assert!(kept.angle_between(v).min(kept.angle_between(-v)) < 0.02, "{kept}");
    }
}
