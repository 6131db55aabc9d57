//! The true flow, nearness and divergence of cells.

use glam::DMat3;

use super::true_flow::true_flow;
use crate::camera::{Camera, Pose};
use crate::error::Result;
use crate::frame::Size;
use crate::sim::{RayTable, Seen, Twist};
use crate::sphere::{Sphere, model};

/// The rays at which a view's cells are sampled.
pub(super) struct CellRays {
    /// One ray per sample, or one per pixel if the cell is not a multiple of the step: the samples are then not evenly
    /// spaced.
    rays: RayTable,
    /// The spacing of the rays, in pixels.
    apart: usize,
    cell: usize,
    step: usize,
}

/// Sums over the samples of a cell, then their means.
#[derive(Default)]
pub(super) struct CellTruth {
    count: f64,
    /// In the plane at unit distance, as the measured flow.
    pub(super) flow: [f64; 2],
    pub(super) nearness_per_m: f64,
    pub(super) divergence_hz: f64,
}

impl CellRays {
    pub(super) fn new(ideal: &Camera, view: &Sphere) -> Result<Self> {
        let apart = if view.cell.is_multiple_of(view.step) { view.step } else { 1 };
        let share = f64::from(apart);
        let sampled = Camera {
            size: Size::new(ideal.size.width.div_ceil(apart), ideal.size.height.div_ceil(apart)),
            f_u: ideal.f_u / share,
            f_v: ideal.f_v / share,
            u_0: ideal.u_0 / share,
            v_0: ideal.v_0 / share,
            lens: ideal.lens,
        };
        Ok(Self {
            rays: RayTable::new(&sampled)?,
            apart: apart as usize,
            cell: view.cell as usize,
            step: view.step as usize,
        })
    }

    /// The rays, row by row.
    pub(super) fn table(&self) -> &RayTable {
        &self.rays
    }

    /// The means over a cell's samples between two exact poses. `seen` is what each ray of the table meets.
    pub(super) fn truth(
        &self,
        cell: [usize; 2],
        seen: &[Option<Seen>],
        poses: [&Pose; 2],
        prev_from_cur: &DMat3,
        motion: &Twist,
    ) -> CellTruth {
        let Size { width, height } = self.rays.size();
        let along = |axis: usize, side: u32| {
            let pixels = (0..self.cell).step_by(self.step).map(move |pixel| cell[axis] * self.cell + pixel);
            pixels.map(|pixel| pixel / self.apart).filter(move |ray| *ray < side as usize)
        };
        let mut truth = CellTruth::default();
        for y in along(1, height) {
            for seen in along(0, width).filter_map(|x| seen[y * width as usize + x]) {
                let (bearing, flow) = true_flow(seen.bearing, seen.nearness_per_m, poses, prev_from_cur);
                let [x, y] = model::to_plane(bearing, flow);
                truth.count += 1.0;
                truth.flow = [truth.flow[0] + x, truth.flow[1] + y];
                truth.nearness_per_m += seen.nearness_per_m;
                truth.divergence_hz += seen.divergence_per_s(motion);
            }
        }
        CellTruth {
            flow: truth.flow.map(|sum| sum / truth.count),
            nearness_per_m: truth.nearness_per_m / truth.count,
            divergence_hz: truth.divergence_hz / truth.count,
            ..truth
        }
    }
}
