//! The plan from a frame to the sectors of the view.

use super::aggregate::{Aggregation, pinhole};
use super::config::{Derotation, Sphere};
use super::grid::{Cells, Grid};
use super::motion::MOTION_LEN;
use super::rectify::{Map, Rectification};
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::flow::{Algorithm, Wanted};
use crate::frame::{PixelFormat, Plane};
use crate::kernels::rotational_flow;
use crate::plan::{BufId, Bufs, Fill, Plan, Port, PortKind, Shape, Step};
use crate::sphere::Motion;

/// The cameras that a plan rectifies between.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cameras<'a> {
    /// The camera that takes the frames.
    pub(crate) raw: &'a Camera,
    /// The ideal camera, in whose image the flow is computed.
    pub(crate) ideal: &'a Camera,
    /// The certainty of each pixel of the raw frame.
    pub(crate) mask: Option<&'a Plane>,
    /// Whether the camera's rotation is known.
    pub(crate) gyro: bool,
}

/// Outputs that are read back beside the sectors, in this order. [`Cue`](crate::Cue) states their layout.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ExtraOutputs {
    /// Nearness rate, divergence, standard error and confidence of each cell: [`Cue::looming`](crate::Cue::looming).
    pub looming: bool,
    /// Confidence, place and rate of each cell: [`Cue::cells`](crate::Cue::cells).
    pub cells: bool,
    /// The flow on the view sphere at each pixel: [`Cue::spherical_flow`](crate::Cue::spherical_flow).
    pub spherical_flow: bool,
}

/// The plan for frames of this format, and the cells and sectors over which it aggregates the flow.
///
/// Its inputs are `frame` and `motion`; its outputs are `sectors`, `flow` (from the current frame back to the previous
/// one) and the [`ExtraOutputs`] that are asked for. With `certainty`, pixels outside the frame and pixels that the
/// mask hides are excluded from the estimator's neighbourhoods.
///
/// # Errors
/// [`Error::Parameter`] for a parameter that is out of range, [`Error::SizeMismatch`] for a mask of another size.
pub(crate) fn plan(
    algorithm: &Algorithm,
    certainty: bool,
    view: &Sphere,
    cameras: Cameras<'_>,
    format: PixelFormat,
    fields: ExtraOutputs,
) -> Result<(Plan, Cells, Grid)> {
    view.validate()?;
    algorithm.validate()?;
    let primed = cameras.gyro && view.derotation == Derotation::Primed;
    let size = cameras.ideal.size;
    size.validate()?;
    cameras.raw.size.validate()?;
    if let Some(mask) = cameras.mask {
        mask.validate()?;
        if mask.size != cameras.raw.size {
            return Err(Error::SizeMismatch {
                what: "mask".to_owned(),
                found: mask.size,
                expected: cameras.raw.size,
            });
        }
    }
    let grid = Grid::over(cameras.ideal, view.sectors)?;
    let cells = Cells::over(cameras.ideal, view.cell);

    let mut bufs = Bufs::default();
    let rectify = Rectification::new(&mut bufs, cameras, view, format);
    if rectify.turned.is_some() && algorithm.frames() > 2 {
        let found = format_args!("{} of {} frames", algorithm.name(), algorithm.frames());
        return Err(Error::parameter(
            "algorithm",
            found,
            "one of 2 frames where they are derotated before the flow",
        ));
    }
    let motion = bufs.input("motion", MOTION_LEN);
    let found = bufs.computed("flow", Shape::planar(size, 2));
    let rotational = primed.then(|| bufs.computed("rotational flow", Shape::planar(size, 2)));
    let wanted =
        Wanted { initial_flow: primed, certainty, backward: true, evidence: true, ..Wanted::default() };
    let stages = algorithm.stages(&mut bufs, size, wanted);
    let aggregate = Aggregation::new(&mut bufs, view, cameras.ideal, &cells, &grid, fields);

    let expand = |steps: &mut Vec<Step>, parity: usize, map: Option<Map>, slot: usize, label: &str| {
        let gray = rectify.picture(steps, parity, map, label);
        let shown = map.map_or(rectify.certainty, |map| map.certainty);
        steps.extend(stages.ingest(gray, certainty.then_some(shown), slot));
    };
    let ingest = [0, 1].map(|parity| {
        let mut steps = vec![rectify.brightness(parity, format)];
        if rectify.turned.is_none() {
            expand(&mut steps, parity, rectify.map, parity, "undistort");
        }
        steps
    });
    // The flow leads from the current frame back to the previous one, so that it is known at the current frame's
    // pixels.
    let pair = [0, 1].map(|parity| {
        let mut steps = Vec::new();
        let slots = match rectify.turned {
            None => [parity, 1 - parity],
            Some(turned) => {
                expand(&mut steps, parity, rectify.map, 0, "undistort");
                steps.extend(rectify.make(turned, motion, "rotation"));
                expand(&mut steps, 1 - parity, Some(turned), 1, "undistort and rotate");
                [0, 1]
            }
        };
        if let Some(rotational) = rotational {
            steps.push(rotational_flow_step(cameras.ideal, motion, rotational));
        }
        steps.extend(stages.pair(parity, slots, rotational.unwrap_or(found), found));
        let evidence = stages.evidence(slots);
        let certainty = [rectify.certainty, rectify.turned.map_or(rectify.certainty, |map| map.certainty)];
        let turn = if rectify.turned.is_some() { rectify.still } else { motion };
        aggregate.steps(&mut steps, evidence, certainty, found, [turn, motion]);
        steps
    });
    let frame_kind = PortKind::Frame { size: cameras.raw.size, format };
    let unknown = Fill::Values(Motion::UNKNOWN.values().to_vec());
    let mut outputs = aggregate.outputs();
    outputs.push(Port::output("flow", PortKind::Flow { size }, found));
    let plan = Plan {
        size: cameras.raw.size,
        setup: rectify.setup(),
        ingest,
        pair,
        inputs: vec![
            Port::new("frame", frame_kind, rectify.frame, Fill::Required),
            Port::new("motion", PortKind::Raw { len: MOTION_LEN }, motion, unknown),
        ],
        outputs,
        carried: stages.carried(),
        bufs: bufs.finish(),
    };
    plan.validate()?;
    Ok((plan, cells, grid))
}

fn rotational_flow_step(ideal: &Camera, motion: BufId, flow: BufId) -> Step {
    Step::new(
        &rotational_flow::KERNEL,
        "rotation",
        pinhole(ideal),
        &[motion],
        &[(flow, Shape::planar(ideal.size, 2))],
    )
}
