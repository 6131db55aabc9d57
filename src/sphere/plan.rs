//! The plan from a frame to the sectors of the view.

use super::back::{Back, pinhole};
use super::config::{Derotation, Sphere};
use super::front::{Front, Map};
use super::grid::{Cells, Grid};
use super::motion::MOTION_LEN;
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::flow::{Algorithm, Wanted};
use crate::frame::{PixelFormat, Plane};
use crate::kernels::prime;
use crate::plan::{BufId, Bufs, Fill, Plan, Port, PortKind, Shape, Step};
use crate::sphere::Motion;

/// What there is to look through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eye<'a> {
    /// The camera that takes the frames.
    pub(crate) raw: &'a Camera,
    /// The pinhole whose pictures the flow is computed of.
    pub(crate) ideal: &'a Camera,
    /// How far each of the frame's pixels is to be trusted.
    pub(crate) mask: Option<&'a Plane>,
    /// Whether the camera's turn is known.
    pub(crate) gyro: bool,
}

/// Fields that are read beside the sectors, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Fields {
    /// Nearness rate, divergence, error and trust of each cell.
    pub looming: bool,
    /// Trust, place and rate of each cell.
    pub cells: bool,
    /// The flow on the view sphere of each pixel.
    pub tangent: bool,
}

/// The plan for frames of this format, and the cells and sectors it sums the flow up in.
///
/// Its inputs are `frame` and `motion`; its outputs are `sectors`, `flow` (from the current frame back to the previous one)
/// and the [`Fields`] that are asked for. With `certainty`, what the frame does not show and what the mask hides is left
/// out of the estimator's neighbourhoods.
///
/// # Errors
/// [`Error::Parameter`] for a parameter that is out of range, [`Error::SizeMismatch`] for a mask of another size.
pub(crate) fn plan(
    algorithm: &Algorithm,
    certainty: bool,
    view: &Sphere,
    eye: Eye<'_>,
    format: PixelFormat,
    fields: Fields,
) -> Result<(Plan, Cells, Grid)> {
    view.validate()?;
    algorithm.validate()?;
    let primed = eye.gyro && view.derotation == Derotation::Primed;
    let size = eye.ideal.size;
    size.validate()?;
    eye.raw.size.validate()?;
    if let Some(mask) = eye.mask {
        mask.validate()?;
        if mask.size != eye.raw.size {
            return Err(Error::SizeMismatch {
                what: "mask".to_owned(),
                found: mask.size,
                expected: eye.raw.size,
            });
        }
    }
    let grid = Grid::over(eye.ideal, view.sectors)?;
    let cells = Cells::over(eye.ideal, view.cell);

    let mut bufs = Bufs::default();
    let front = Front::new(&mut bufs, eye, view, format);
    let motion = bufs.input("motion", MOTION_LEN);
    let found = bufs.computed("flow", Shape::planar(size, 2));
    let prime = primed.then(|| bufs.computed("flow of the turn", Shape::planar(size, 2)));
    let wanted = Wanted { initial_flow: primed, certainty, confidence: false, evidence: true };
    let stages = algorithm.stages(&mut bufs, size, wanted);
    let back = Back::new(&mut bufs, view, eye.ideal, &cells, &grid, fields);

    let expand = |steps: &mut Vec<Step>, parity: usize, map: Option<Map>, slot: usize, label: &str| {
        let gray = front.picture(steps, parity, map, label);
        let shown = map.map_or(front.certainty, |map| map.certainty);
        steps.extend(stages.ingest(gray, certainty.then_some(shown), slot));
    };
    let ingest = [0, 1].map(|parity| {
        let mut steps = vec![front.brightness(parity, format)];
        if front.turned.is_none() {
            expand(&mut steps, parity, front.map, parity, "undistort");
        }
        steps
    });
    // The flow leads from the current frame back to the one before, so that it is known at the current frame's pixels.
    let pair = [0, 1].map(|parity| {
        let mut steps = Vec::new();
        let slots = match front.turned {
            None => [parity, 1 - parity],
            Some(turned) => {
                expand(&mut steps, parity, front.map, 0, "undistort");
                steps.extend(front.make(turned, motion, "turn"));
                expand(&mut steps, 1 - parity, Some(turned), 1, "undistort and turn");
                [0, 1]
            }
        };
        if let Some(prime) = prime {
            steps.push(prime_step(eye.ideal, motion, prime));
        }
        steps.extend(stages.pair(slots, prime.unwrap_or(found), found));
        let evidence = stages.evidence(slots);
        let certainty = [front.certainty, front.turned.map_or(front.certainty, |map| map.certainty)];
        let turn = if front.turned.is_some() { front.still } else { motion };
        back.steps(&mut steps, evidence, certainty, found, [turn, motion]);
        steps
    });
    let frame_kind = PortKind::Frame { size: eye.raw.size, format };
    let unknown = Fill::Values(Motion::UNKNOWN.values().to_vec());
    let mut outputs = back.outputs();
    outputs.push(Port::output("flow", PortKind::Flow { size }, found));
    let plan = Plan {
        size: eye.raw.size,
        setup: front.setup(),
        ingest,
        pair,
        inputs: vec![
            Port::new("frame", frame_kind, front.frame, Fill::Required),
            Port::new("motion", PortKind::Raw { len: MOTION_LEN }, motion, unknown),
        ],
        outputs,
        carried: stages.carried(),
        bufs: bufs.finish(),
    };
    plan.validate()?;
    Ok((plan, cells, grid))
}

fn prime_step(ideal: &Camera, motion: BufId, flow: BufId) -> Step {
    Step::new(&prime::KERNEL, "turn", pinhole(ideal), &[motion], &[(flow, Shape::planar(ideal.size, 2))])
}
