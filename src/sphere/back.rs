//! From the flow to the sectors of the view.

use super::config::Sphere;
use super::grid::{Cells, Grid};
use super::plan::Fields;
use crate::camera::Camera;
use crate::flow::Evidence;
use crate::frame::Size;
use crate::kernels::{cell_mean, cells, looming, sectors, tangent, trust};
use crate::plan::{BufId, Bufs, Port, PortKind, Shape, Step};

/// From the flow to the sectors.
pub(super) struct Back<'a> {
    ideal: &'a Camera,
    view: &'a Sphere,
    cells_at: &'a Cells,
    trust: BufId,
    cells: (BufId, Shape),
    looming: (BufId, Shape),
    sectors: (BufId, Shape),
    tangent: Option<(BufId, Shape)>,
    ranges: BufId,
    members: BufId,
    wanted: Fields,
}

impl<'a> Back<'a> {
    pub(super) fn new(
        bufs: &mut Bufs,
        view: &'a Sphere,
        ideal: &'a Camera,
        cells: &'a Cells,
        grid: &Grid,
        wanted: Fields,
    ) -> Self {
        let columns_rows = Size::new(grid.columns as u32, grid.rows as u32);
        let mut computed = |name: &str, shape: Shape| (bufs.computed(name, shape), shape);
        let (trust, _) = computed("trust", Shape::planar(cells.size, 1));
        let of_cells = computed("cells", Shape::planar(cells.size, 5));
        let looming = computed("looming", Shape::planar(cells.size, 4));
        let sectors = computed("sectors", Shape::planar(columns_rows, sectors::CHANNELS));
        let tangent = wanted.tangent.then(|| computed("tangent flow", Shape::planar(ideal.size, 3)));
        let [ranges, members] = grid.members(cells);
        Self {
            ideal,
            view,
            cells_at: cells,
            trust,
            cells: of_cells,
            looming,
            sectors,
            tangent,
            ranges: bufs.constant("ranges of members", ranges),
            members: bufs.constant("members of sectors", members),
            wanted,
        }
    }

    /// What is read of a pair, but for the flow.
    pub(super) fn outputs(&self) -> Vec<Port> {
        let port = |name: &'static str, (buf, shape): (BufId, Shape)| {
            Port::output(name, PortKind::Raw { len: shape.len() }, buf)
        };
        let mut outputs = vec![port("sectors", self.sectors)];
        outputs.extend(self.wanted.looming.then(|| port("looming", self.looming)));
        outputs.extend(self.wanted.cells.then(|| port("cells", self.cells)));
        outputs.extend(self.tangent.map(|tangent| port("tangent", tangent)));
        outputs
    }

    /// `turn` is what the flow still holds of the camera's turn, `motion` what is known of the heading.
    pub(super) fn steps(
        &self,
        steps: &mut Vec<Step>,
        evidence: Evidence,
        certainty: [BufId; 2],
        flow: BufId,
        [turn, motion]: [BufId; 2],
    ) {
        let Size { width, height } = self.ideal.size;
        let Size { width: columns, height: rows } = self.cells_at.size;
        let Sphere { cell, step, .. } = *self.view;
        if let Some(tangent) = self.tangent {
            steps.push(Step::new(&tangent::KERNEL, "sphere", pinhole(self.ideal), &[flow, turn], &[tangent]));
        }
        let trust = [(self.trust, Shape::planar(self.cells_at.size, 1))];
        steps.push(match evidence {
            Evidence::Expansions([quad_0, cross_0, quad_1, cross_1]) => Step::new(
                &trust::KERNEL,
                "sphere",
                trust::Params { columns, rows, width, height, cell, step },
                &[quad_0, cross_0, quad_1, cross_1, certainty[0], certainty[1], flow],
                &trust,
            ),
            Evidence::Confidence(plane) => Step::new(
                &cell_mean::KERNEL,
                "sphere",
                cell_mean::Params { columns, rows, width, height, cell, step },
                &[plane, certainty[0]],
                &trust,
            ),
        });
        let tangent::Params { focal, centre, .. } = pinhole(self.ideal);
        steps.push(Step::new(
            &cells::KERNEL,
            "sphere",
            cells::Params { columns, rows, width, height, cell, step, focal, centre },
            &[flow, turn, certainty[0], self.trust],
            &[self.cells],
        ));
        steps.push(Step::new(
            &looming::KERNEL,
            "sphere",
            looming_params(self.view, self.ideal, self.cells_at),
            &[self.cells.0, motion],
            &[self.looming],
        ));
        steps.push(Step::new(
            &sectors::KERNEL,
            "sphere",
            sectors_params(self.view, self.cells_at),
            &[self.cells.0, self.looming.0, self.ranges, self.members],
            &[self.sectors],
        ));
    }
}

/// How nearness rate and divergence come of the cells.
pub(super) fn looming_params(view: &Sphere, ideal: &Camera, cells: &Cells) -> looming::Params {
    let [origin, pitch] = cells.origin_and_pitch().map(|pair| pair.map(|value| value as f32));
    looming::Params {
        columns: cells.size.width,
        rows: cells.size.height,
        radius: view.window,
        inner: view.window / 2,
        pitch,
        origin,
        noise: (view.noise_px / ideal.f_u) as f32,
        least_trust: view.least_trust as f32,
    }
}

/// How the cells are summed up in sectors.
pub(super) fn sectors_params(view: &Sphere, cells: &Cells) -> sectors::Params {
    sectors::Params {
        columns: view.sectors[0],
        rows: view.sectors[1],
        cell_columns: cells.size.width,
        // A window is whole where all its cells are trusted; at half of that it still counts.
        least_trust: 0.5 * view.least_trust as f32,
        quantile: view.quantile as f32,
    }
}

/// An ideal camera as the kernels take it.
pub(super) fn pinhole(camera: &Camera) -> tangent::Params {
    tangent::Params {
        width: camera.size.width,
        height: camera.size.height,
        focal: [camera.f_u as f32, camera.f_v as f32],
        centre: [camera.u_0 as f32, camera.v_0 as f32],
    }
}
