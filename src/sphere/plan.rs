//! The plan from a frame to the sectors of the view.

use super::back::{Back, pinhole};
use super::config::{Derotation, Sphere};
use super::front::{Front, Map};
use super::grid::{Cells, Grid};
use super::motion::MOTION_LEN;
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::flow::{Farneback, Parts};
use crate::frame::{PixelFormat, Plane};
use crate::kernels::prime;
use crate::plan::{BufId, Bufs, Plan, Shape, Step};

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
/// # Errors
/// [`Error::Parameter`] for a parameter that is out of range, [`Error::SizeMismatch`] for a mask of another size.
pub(crate) fn plan(
    flow: &Farneback,
    view: &Sphere,
    eye: Eye<'_>,
    format: PixelFormat,
    fields: Fields,
) -> Result<(Plan, Cells, Grid)> {
    view.validate()?;
    let primed = eye.gyro && view.derotation == Derotation::Primed;
    let flow = Farneback { initial_flow: primed, confidence: false, ..flow.clone() };
    flow.validate()?;
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
    let parts = Parts::new(&mut bufs, &flow, size);
    let back = Back::new(&mut bufs, view, eye.ideal, &cells, &grid, fields);

    let expand = |steps: &mut Vec<Step>, parity: usize, map: Option<Map>, slot: usize, label: &str| {
        let gray = front.picture(steps, parity, map, label);
        let certainty = map.map_or(front.certainty, |map| map.certainty);
        steps.extend(parts.expand(gray, flow.certainty.then_some(certainty), slot));
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
        steps.extend(parts.flow(slots, prime.unwrap_or(found), found));
        let [first, second] = slots.map(|slot| parts.finest(slot));
        let expansions = [first.quad, first.cross_term, second.quad, second.cross_term];
        let certainty = [front.certainty, front.turned.map_or(front.certainty, |map| map.certainty)];
        let turn = if front.turned.is_some() { front.still } else { motion };
        back.steps(&mut steps, expansions, certainty, found, [turn, motion]);
        steps
    });
    let plan = Plan {
        size: eye.raw.size,
        flow_size: size,
        setup: front.setup(),
        ingest,
        pair,
        frame: front.frame,
        certainty: None,
        motion: Some(motion),
        flow: [found; 2],
        initial_flow: false,
        confidence: None,
        fields: back.fields(),
        bufs: bufs.finish(),
    };
    plan.validate()?;
    Ok((plan, cells, grid))
}

fn prime_step(ideal: &Camera, motion: BufId, flow: BufId) -> Step {
    Step::new(&prime::KERNEL, "turn", pinhole(ideal), &[motion], &[(flow, Shape::planar(ideal.size, 2))])
}
