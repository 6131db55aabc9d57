//! The flow of one pair of images, on either executor.

use viewsphere::Backend;
use viewsphere::flow::{self, Algorithm, FlowOptions, Initial};
use viewsphere::frame::{FlowField, Image, Plane};
use viewsphere::gpu::Gpu;
use viewsphere::kernels::compare::POISON;
use viewsphere::plan::{Content, Value};
use viewsphere::runner::Runner;

/// The executor of a plan.
#[derive(Clone, Copy)]
pub(crate) enum On<'a> {
    Cpu,
    Gpu(&'a Gpu),
}

impl On<'_> {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cpu => "CPU",
            Self::Gpu(_) => "GPU",
        }
    }

    fn backend(self) -> Backend {
        match self {
            Self::Cpu => Backend::Cpu,
            Self::Gpu(gpu) => Backend::Gpu(gpu.clone()),
        }
    }
}

/// The inputs beside the images.
#[derive(Clone, Copy, Default)]
pub(crate) struct Beside<'a> {
    pub(crate) initial_flow: Option<&'a FlowField>,
    /// The certainty of each image.
    pub(crate) certainty: Option<[&'a Plane; 2]>,
}

/// The flow from the first image to the second.
pub(crate) fn flow(
    on: On<'_>,
    algorithm: impl Into<Algorithm>,
    images: [&Image; 2],
    initial_flow: Option<&FlowField>,
) -> FlowField {
    flow_with(on, algorithm, images, Beside { initial_flow, certainty: None })
}

/// The flow from the first image to the second, with further inputs.
pub(crate) fn flow_with(
    on: On<'_>,
    algorithm: impl Into<Algorithm>,
    images: [&Image; 2],
    beside: Beside<'_>,
) -> FlowField {
    flow_of_last(on, algorithm, &images, beside)
}

/// The flow of the last pair of a stream, with further inputs, which are those of all frames of its parity.
///
/// All computed buffers are poisoned first, so that a step that reads an unwritten value is found.
pub(crate) fn flow_of_last(
    on: On<'_>,
    algorithm: impl Into<Algorithm>,
    images: &[&Image],
    beside: Beside<'_>,
) -> FlowField {
    let Beside { initial_flow, certainty } = beside;
    let options = FlowOptions {
        initial: if initial_flow.is_some() { Initial::Given } else { Initial::Zero },
        certainty: certainty.is_some(),
        confidence: false,
    };
    let plan = flow::plan(&algorithm.into(), images[0].size, images[0].format, options)
        .unwrap_or_else(|error| panic!("{error}"));
    let steps = [0, 1].into_iter().flat_map(|parity| plan.steps(parity));
    let outputs = steps.flat_map(|step| step.outputs.iter().map(|(id, _)| *id));
    let computed: Vec<_> = outputs.filter(|id| plan.buf(*id).content == Content::Computed).collect();
    let carried = plan.carried.clone();
    let mut runner = Runner::new(&on.backend(), plan).unwrap_or_else(|error| panic!("{error}"));
    for id in computed {
        let len = runner.plan().buf(id).len;
        runner.write(id, &vec![POISON; len]);
    }
    // The first pair has parity 1, and finds nothing carried.
    for [_, id] in carried {
        let len = runner.plan().buf(id).len;
        runner.write(id, &vec![0.0; len]);
    }
    let mut last = None;
    for (i, image) in images.iter().enumerate() {
        let parity = i % 2;
        let frame = image.frame().unwrap_or_else(|error| panic!("{error}"));
        let given = [
            ("frame", Some(Value::Frame(&frame))),
            ("certainty", certainty.map(|planes| Value::Plane(planes[parity]))),
            ("initial_flow", initial_flow.map(Value::Flow)),
        ];
        let outputs = runner.frame(parity, i > 0, &given).unwrap_or_else(|error| panic!("{error}"));
        if i > 0 {
            last = outputs.flow("flow").cloned();
        }
    }
    last.expect("the second frame makes a pair")
}
