//! The steps from the flow to the sectors of the view.

use super::config::Sphere;
use super::grid::{Cells, Grid};
use super::plan::ExtraOutputs;
use crate::camera::Camera;
use crate::flow::Evidence;
use crate::frame::Size;
use crate::kernels::{cell_confidence, cell_evidence, cell_mean, cells, looming, sectors, spherical_flow};
use crate::plan::{BufId, Bufs, Port, PortKind, Shape, Step};

/// The largest standard error of the direction of motion at which the flow has an expected direction, radians.
const KNOWN_RAD: f32 = 0.3;
/// The least distance from the direction of motion at which it has one, in the pinhole's plane.
const NEAR: f32 = 0.05;

/// Builds the steps from the flow to the sectors.
pub(super) struct Aggregation<'a> {
    ideal: &'a Camera,
    view: &'a Sphere,
    cells_at: &'a Cells,
    evidence: (BufId, Shape),
    confidence: (BufId, Shape),
    cells: (BufId, Shape),
    looming: (BufId, Shape),
    sectors: (BufId, Shape),
    spherical_flow: Option<(BufId, Shape)>,
    ranges: BufId,
    members: BufId,
    wanted: ExtraOutputs,
}

impl<'a> Aggregation<'a> {
    pub(super) fn new(
        bufs: &mut Bufs,
        view: &'a Sphere,
        ideal: &'a Camera,
        cells: &'a Cells,
        grid: &Grid,
        wanted: ExtraOutputs,
    ) -> Self {
        let columns_rows = Size::new(grid.columns as u32, grid.rows as u32);
        let mut computed = |name: &str, shape: Shape| (bufs.computed(name, shape), shape);
        let evidence = computed("evidence", Shape::planar(cells.size, cell_evidence::CHANNELS));
        let confidence = computed("confidence", Shape::planar(cells.size, cell_confidence::CHANNELS));
        let of_cells = computed("cells", Shape::planar(cells.size, cells::CHANNELS));
        let looming = computed("looming", Shape::planar(cells.size, 4));
        let sectors = computed("sectors", Shape::planar(columns_rows, sectors::CHANNELS));
        let spherical_flow =
            wanted.spherical_flow.then(|| computed("spherical flow", Shape::planar(ideal.size, 3)));
        let [ranges, members] = grid.members(cells);
        Self {
            ideal,
            view,
            cells_at: cells,
            evidence,
            confidence,
            cells: of_cells,
            looming,
            sectors,
            spherical_flow,
            ranges: bufs.constant("ranges of members", ranges),
            members: bufs.constant("members of sectors", members),
            wanted,
        }
    }

    /// The outputs of a pair, without the flow.
    pub(super) fn outputs(&self) -> Vec<Port> {
        let port = |name: &'static str, (buf, shape): (BufId, Shape)| {
            Port::output(name, PortKind::Raw { len: shape.len() }, buf)
        };
        let mut outputs = vec![port("sectors", self.sectors)];
        outputs.extend(self.wanted.looming.then(|| port("looming", self.looming)));
        outputs.extend(self.wanted.cells.then(|| port("cells", self.cells)));
        outputs.extend(self.spherical_flow.map(|spherical_flow| port("tangent", spherical_flow)));
        outputs
    }

    /// `turn` is the rotation that the flow still contains, `motion` the buffer with the heading.
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
        if let Some(spherical_flow) = self.spherical_flow {
            steps.push(Step::new(
                &spherical_flow::KERNEL,
                "sphere",
                pinhole(self.ideal),
                &[flow, turn],
                &[spherical_flow],
            ));
        }
        let samples = cell_evidence::Params { columns, rows, width, height, cell, step };
        match evidence {
            Evidence::Expansions([quad_0, cross_0, quad_1, cross_1]) => {
                let inputs = [quad_0, cross_0, quad_1, cross_1, certainty[0], certainty[1], flow];
                steps.push(Step::new(&cell_evidence::KERNEL, "sphere", samples, &inputs, &[self.evidence]));
                let params = confidence_params(self.view, self.ideal, self.cells_at);
                let inputs = [self.evidence.0, motion];
                steps.push(Step::new(
                    &cell_confidence::KERNEL,
                    "sphere",
                    params,
                    &inputs,
                    &[self.confidence],
                ));
            }
            Evidence::Confidence(plane) => {
                let inputs = [plane, certainty[0]];
                steps.push(Step::new(&cell_mean::KERNEL, "sphere", samples, &inputs, &[self.confidence]));
            }
        }
        let spherical_flow::Params { focal, centre, .. } = pinhole(self.ideal);
        steps.push(Step::new(
            &cells::KERNEL,
            "sphere",
            cells::Params { columns, rows, width, height, cell, step, focal, centre },
            &[flow, turn, certainty[0], self.confidence.0],
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

/// The parameters of the kernel that computes nearness rate and divergence of the cells.
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
        least_confidence: view.least_confidence as f32,
    }
}

/// The parameters of the kernel that judges the cells' evidence.
fn confidence_params(view: &Sphere, ideal: &Camera, cells: &Cells) -> cell_confidence::Params {
    let [origin, pitch] = cells.origin_and_pitch().map(|pair| pair.map(|value| value as f32));
    cell_confidence::Params {
        columns: cells.size.width,
        rows: cells.size.height,
        pitch,
        origin,
        focal: [ideal.f_u as f32, ideal.f_v as f32],
        known_rad: if view.directional { KNOWN_RAD } else { 0.0 },
        near: NEAR,
    }
}

/// The parameters of the kernel that summarizes cells in sectors.
pub(super) fn sectors_params(view: &Sphere, cells: &Cells) -> sectors::Params {
    sectors::Params {
        columns: view.sectors[0],
        rows: view.sectors[1],
        cell_columns: cells.size.width,
        // A window's confidence is relative to all its cells: with half of them trusted it still counts.
        least_confidence: 0.5 * view.least_confidence as f32,
        least_both: view.least_confidence as f32,
        quantile: view.quantile as f32,
    }
}

/// An ideal camera as the kernels' parameters.
pub(super) fn pinhole(camera: &Camera) -> spherical_flow::Params {
    spherical_flow::Params {
        width: camera.size.width,
        height: camera.size.height,
        focal: [camera.f_u as f32, camera.f_v as f32],
        centre: [camera.u_0 as f32, camera.v_0 as f32],
    }
}
