//! The plan from frames to flow, for any estimator.

use super::{Algorithm, Wanted};
use crate::error::Result;
use crate::frame::{PixelFormat, Size};
use crate::kernels::luma;
use crate::plan::{BufId, Bufs, Fill, Plan, Port, PortKind, Shape, Step};

/// The options of a flow plan: its inputs beside frames, and its outputs beside flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FlowOptions {
    /// The beginning of a pair's search.
    pub initial: Initial,
    /// Whether each frame may have a certainty of its pixels, the input `certainty`: a plane of values from 0 to 1.
    /// Other values are clamped, and NaN becomes 0.
    pub certainty: bool,
    /// Whether the output `confidence` is computed: a plane of values from 0 to 1.
    pub confidence: bool,
}

/// The beginning of a pair's search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Initial {
    /// Zero motion.
    #[default]
    Zero,
    /// The input `initial_flow`, a field in pixels; zero motion for frames without one.
    Given,
    /// The input `initial_flow`, a field in pixels; the flow of the previous pair for frames without one.
    Previous,
}

/// The plan from frames of this size and format to the output `flow`: displacements in pixels from the previous frame
/// to the current one. Its input is `frame`; [`FlowOptions`] names the others.
///
/// # Errors
/// [`Error::Parameter`](crate::Error::Parameter) for a parameter or size that is out of range.
pub fn plan(algorithm: &Algorithm, size: Size, format: PixelFormat, options: FlowOptions) -> Result<Plan> {
    algorithm.validate()?;
    size.validate()?;
    let FlowOptions { initial, certainty, confidence } = options;
    let begins = initial != Initial::Zero;
    let mut bufs = Bufs::default();
    let frame_kind = PortKind::Frame { size, format };
    let frame = bufs.input("frame", frame_kind.len());
    let gray = bufs.computed("gray", Shape::planar(size, 1));
    let share = PortKind::Plane { size, range: Some([0.0, 1.0]) };
    let certainty = certainty.then(|| bufs.input("certainty", share.len()));
    let first = bufs.computed("flow", Shape::planar(size, 2));
    let second = if begins { bufs.computed("flow of odd frames", Shape::planar(size, 2)) } else { first };
    // A pair reads its initial flow where the previous pair has written its flow.
    let (flow, found) = ([first, second], [second, first]);
    let wanted =
        Wanted { initial_flow: begins, certainty: certainty.is_some(), confidence, ..Wanted::default() };
    let stages = algorithm.stages(&mut bufs, size, wanted);

    let mut inputs = vec![Port::new("frame", frame_kind, frame, Fill::Required)];
    inputs.extend(certainty.map(|buf| Port::new("certainty", share, buf, Fill::Value(1.0))));
    let mut carried = stages.carried();
    if begins {
        let if_absent = if initial == Initial::Previous { Fill::Keep } else { Fill::Value(0.0) };
        inputs.push(Port { name: "initial_flow", kind: PortKind::Flow { size }, bufs: found, if_absent });
    }
    if initial == Initial::Previous {
        carried.push(found);
    }
    let mut outputs =
        vec![Port { name: "flow", kind: PortKind::Flow { size }, bufs: flow, if_absent: Fill::Keep }];
    let plane = PortKind::Plane { size, range: None };
    outputs.extend(stages.confidence().map(|buf| Port::output("confidence", plane, buf)));

    let plan = Plan {
        size,
        setup: Vec::new(),
        ingest: [0, 1].map(|parity| {
            let mut steps = vec![gray_step(size, format, frame, gray)];
            steps.extend(stages.ingest(gray, certainty, parity));
            steps
        }),
        pair: [0, 1].map(|parity| stages.pair(parity, [1 - parity, parity], found[parity], flow[parity])),
        inputs,
        outputs,
        carried,
        bufs: bufs.finish(),
    };
    plan.validate()?;
    Ok(plan)
}

/// The brightness of a frame's pixels.
pub(crate) fn gray_step(size: Size, format: PixelFormat, frame: BufId, gray: BufId) -> Step {
    let params = luma::Params::new(size, format);
    Step::new(&luma::KERNEL, "frame", params, &[frame], &[(gray, Shape::planar(size, 1))])
}
