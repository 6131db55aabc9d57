//! The sensors that compute nearness or flow from the world itself.

use glam::{DMat3, DVec3};

use super::perception::SensorInput;
use super::sensor::{FlowNoise, Sensor};
use super::true_flow::true_flow;
use crate::camera::{Camera, Pose};
use crate::error::Result;
use crate::frame::Plane;
use crate::quantile::nearest;
use crate::sim::{Random, RayTable, nearness};
use crate::sphere::{
    CellFlow, Heading, HeadingFilter, HeadingModel, Sector, SectorAggregator, Sectors, Sphere,
};
use crate::steer::View;

/// Sees the world through a pinhole camera with one pixel per cell of the view.
pub(super) struct TrueSensor {
    ideal: Camera,
    sensor: Sensor,
    noise: FlowNoise,
    random: Random,
    coarse: RayTable,
    /// The angle of an ideal image's pixel on its axis, radians.
    pixel_rad: f64,
    cell_px: f64,
    aggregator: SectorAggregator,
    sectors: Sectors,
    headings: HeadingFilter,
    model: HeadingModel,
    heading: Heading,
    quantile: f64,
    before: Option<Pose>,
}

impl TrueSensor {
    pub(super) fn new(
        ideal: &Camera,
        view: &Sphere,
        sensor: Sensor,
        noise: FlowNoise,
        random: Random,
    ) -> Result<Self> {
        let aggregator = SectorAggregator::new(ideal, view)?;
        let side = f64::from(view.cell);
        let coarse = Camera {
            size: aggregator.cells().size,
            f_u: ideal.f_u / side,
            f_v: ideal.f_v / side,
            u_0: (ideal.u_0 - 0.5 * (side - 1.0)) / side,
            v_0: (ideal.v_0 - 0.5 * (side - 1.0)) / side,
            lens: ideal.lens,
        };
        Ok(Self {
            ideal: *ideal,
            sensor,
            noise,
            random,
            coarse: RayTable::new(&coarse)?,
            pixel_rad: 1.0 / ideal.f_u,
            cell_px: side,
            sectors: Sectors::unknown(aggregator.grid()),
            aggregator,
            headings: HeadingFilter::new(view.heading),
            model: view.heading,
            heading: Heading::UNKNOWN,
            quantile: view.quantile,
            before: None,
        })
    }

    /// The ideal pinhole camera, whose cells the sensor sees.
    pub(super) fn ideal(&self) -> &Camera {
        &self.ideal
    }

    /// Records the pose of the first frame, which has no view.
    pub(super) fn begin(&mut self, pose: Pose) {
        self.before = Some(pose);
    }

    /// The view at a frame; `None` without a previous pose. `turn` is the rotation by the gyro.
    pub(super) fn sense(&mut self, at: &SensorInput<'_>, turn: &DMat3, interval_s: f64) -> Option<View<'_>> {
        let before = self.before.replace(at.pose)?;
        let near = nearness(at.world, &self.coarse, &at.pose);
        if self.sensor == Sensor::Depth {
            let velocity = at.pose.world_from_camera.transpose() * at.velocity_world_m_s;
            let heading = Heading { direction: velocity.normalize_or(DVec3::Z), error_rad: 0.0 };
            self.sum_up(&near, velocity, interval_s);
            return Some(View { sectors: &self.sectors, heading });
        }
        let mut flows = self.flows(&near, &before, &at.pose, turn);
        if self.sensor == Sensor::NoisyFlow {
            self.spoil(&mut flows);
        }
        let carried = self.model.cur_from_prev(turn) * self.heading.direction;
        let climbing = |heading: Heading| at.climb.map_or(heading, |climb| climb.of(heading));
        let expected = at.heading.unwrap_or_else(|| climbing(Heading { direction: carried, ..self.heading }));
        let sectors = self.aggregator.of(flows.into_iter(), &expected, interval_s);
        let found = self.headings.update(sectors, turn);
        self.heading = at.heading.unwrap_or_else(|| climbing(found));
        Some(View { sectors, heading: self.heading })
    }

    /// The flow of each cell between both exact poses, with the gyro's rotation taken out.
    fn flows(&self, near: &Plane, before: &Pose, pose: &Pose, turn: &DMat3) -> Vec<Option<CellFlow>> {
        let width = near.size.width as usize;
        let flow = |(i, nearness): (usize, &f32)| {
            let bearing = self.coarse.centre(i % width, i / width);
            let (bearing, flow_rad) = true_flow(bearing, f64::from(*nearness), [before, pose], turn);
            // The sky has no texture to follow.
            (*nearness > 0.0).then_some(CellFlow { bearing, flow_rad, confidence: 1.0 })
        };
        near.data.iter().enumerate().map(flow).collect()
    }

    /// Adds an estimator's blur and noise to the flow.
    fn spoil(&mut self, flows: &mut [Option<CellFlow>]) {
        let width = self.coarse.size().width as usize;
        let rows = flows.len() / width;
        let exact: Vec<Option<CellFlow>> = flows.to_vec();
        let reach = 2_isize;
        for (i, flow) in flows.iter_mut().enumerate() {
            let Some(flow) = flow else { continue };
            let (x, y) = ((i % width) as isize, (i / width) as isize);
            let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let (x, y) = (x + dx, y + dy);
                    let inside = (0..width as isize).contains(&x) && (0..rows as isize).contains(&y);
                    let Some(other) = inside.then(|| exact[y as usize * width + x as usize]).flatten() else {
                        continue;
                    };
                    let away_px = self.cell_px * f64::hypot(dx as f64, dy as f64);
                    let w = (-0.5 * (away_px / self.noise.blur_px).powi(2)).exp();
                    sum += w * other.flow_rad;
                    weight += w;
                }
            }
            let (right, down) = flow.bearing.any_orthonormal_pair();
            let blurred = sum / weight;
            let scale = 1.0 + self.noise.relative * self.random.normal();
            let noise = self.noise.white_px * self.pixel_rad;
            let off = right * (noise * self.random.normal()) + down * (noise * self.random.normal());
            flow.flow_rad = blurred * scale + off;
        }
    }

    /// Fills the sectors from the true nearness.
    fn sum_up(&mut self, near: &Plane, velocity_m_s: DVec3, interval_s: f64) {
        let grid = self.sectors.grid;
        let mut rates: Vec<Vec<f64>> = vec![Vec::new(); grid.len()];
        let mut cells = vec![0_usize; grid.len()];
        let width = near.size.width as usize;
        for (i, nearness) in near.data.iter().enumerate() {
            let Some([column, row]) = grid.sector(self.coarse.centre(i % width, i / width)) else { continue };
            cells[row * grid.columns + column] += 1;
            if *nearness > 0.0 {
                rates[row * grid.columns + column].push(f64::from(*nearness) * velocity_m_s.length());
            }
        }
        self.sectors.interval_s = interval_s;
        let ahead = velocity_m_s.normalize_or(DVec3::Z);
        for (at, sector) in self.sectors.sectors.iter_mut().enumerate() {
            let (rates, cells) = (&mut rates[at], cells[at]);
            let p = grid.bearing(at % grid.columns, at / grid.columns);
            rates.sort_by(f64::total_cmp);
            let rate = |share: f64| nearest(rates, share).unwrap_or(0.0);
            *sector = Sector {
                coverage: rates.len() as f64 / cells.max(1) as f64,
                confidence: 1.0,
                nearness_rate_hz: [1.0 - self.quantile, 0.5, self.quantile].map(rate),
                // So that either measure of danger gives the same.
                divergence_hz: 2.0 * rate(self.quantile),
                flow_rad_s: rate(0.5) * (p * p.dot(ahead) - ahead),
                ..Sector::default()
            };
        }
    }
}
