//! Comparison of the two executors, step by step: whether a GPU computes what the CPU computes.
//!
//! Each step of a plan runs on both with the same inputs (the CPU's), and every value must lie within the bound that its
//! kernel states. Beside that, each side computes the whole plan on its own, so that errors accumulate.
//!
//! ```no_run
//! use viewsphere::crosscheck::crosscheck;
//! use viewsphere::eval::Scene;
//! use viewsphere::flow::{self, Algorithm, FlowOptions};
//! use viewsphere::frame::{PixelFormat, Size};
//! use viewsphere::gpu::{Gpu, GpuOptions};
//!
//! # fn main() -> viewsphere::Result<()> {
//! let size = Size::new(640, 480);
//! let scene = Scene::new(size)?;
//! let plan = flow::plan(&Algorithm::default(), size, PixelFormat::Gray8, FlowOptions::default())?;
//! let gpu = Gpu::new(&GpuOptions::default())?;
//! let report = crosscheck(&gpu, &plan, &[scene.frame(0), scene.frame(1)], None, 1.0)?;
//! assert_eq!(report.breaches, 0, "{:?}", report.first_beyond_bound);
//! # Ok(())
//! # }
//! ```

mod report;

use glam::{DMat3, DVec3};
pub use report::{Own, Report, Spread, StepFigures, Worst};

use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::eval::endpoint_error;
use crate::frame::{Image, Plane};
use crate::gpu::Gpu;
use crate::kernel::Bound;
use crate::kernels::compare::{Difference, POISON, compare};
use crate::plan::{BufId, Content, Given, Outputs, Plan, Shape, Step, Value};
use crate::runner::Runner;
use crate::sphere::{Heading, Motion};

/// The CPU, and the GPU twice: with its inputs corrected before every step, and running independently.
struct Sides<'a> {
    plan: &'a Plan,
    cpu: Runner,
    corrected: Runner,
    alone: Runner,
    /// The factor that multiplies every bound.
    factor: f32,
}

/// Compares a GPU with the CPU on a plan and a pair of frames.
///
/// `certainty` is the certainty of both frames, 0 to 1, in a plane of their size; it counts only where the plan has the
/// input `certainty`. Where it has the input `motion`, a rotation of 0.04 rad about a fixed axis is given. `factor` multiplies
/// every bound: 1 for the kernels' own, 0 to demand identical bits.
///
/// # Errors
/// [`Error::Parameter`] for a factor that is negative, NaN or infinite; what the frames, the certainty or the device fail
/// with. A breach of a bound is no error: see [`Report::breaches`].
pub fn crosscheck(
    gpu: &Gpu,
    plan: &Plan,
    pair: &[Image; 2],
    certainty: Option<&Plane>,
    factor: f32,
) -> Result<Report> {
    if !(factor.is_finite() && factor >= 0.0) {
        return Err(Error::parameter("factor", factor, "a finite number of 0 or more"));
    }
    let backend = Backend::Gpu(gpu.clone());
    let mut sides = Sides {
        plan,
        cpu: Runner::new(&Backend::Cpu, plan.clone())?,
        corrected: Runner::new(&backend, plan.clone())?,
        alone: Runner::new(&backend, plan.clone())?,
        factor,
    };
    let mut report = Report {
        adapter: gpu.adapter().to_string(),
        width: plan.size.width,
        height: plan.size.height,
        breaches: 0,
        steps: Vec::new(),
        flow: Spread::default(),
        first_difference: None,
        first_beyond_bound: None,
    };
    for step in &plan.setup {
        sides.compare(step, "once".to_owned(), &mut report)?;
    }
    let motion = turn().values();
    let certainty = certainty.filter(|_| plan.input("certainty").is_some()).map(Value::Plane);
    let motion = plan.input("motion").map(|_| Value::Raw(&motion));
    for (parity, image) in pair.iter().enumerate() {
        let frame = image.frame()?;
        let given: [Given<'_>; 3] =
            [("frame", Some(Value::Frame(&frame))), ("certainty", certainty), ("motion", motion)];
        sides.cpu.set(parity, &given)?;
        sides.alone.set(parity, &given)?;
        // The first frame has no previous one.
        let count = if parity == 0 { plan.ingest[0].len() } else { usize::MAX };
        for (index, step) in plan.steps(parity).enumerate().take(count) {
            sides.step(step, parity, index, &mut report)?;
        }
    }
    report.breaches = report.steps.iter().map(|step| step.breaches).sum();
    let [mut expected, mut found] = [(); 2].map(|()| Outputs::new(&plan.outputs));
    for (outputs, side) in [(&mut expected, &sides.cpu), (&mut found, &sides.alone)] {
        for (i, port) in plan.outputs.iter().enumerate() {
            outputs.unpack(i, &side.read(port.bufs[1], port.kind.len())?);
        }
    }
    if let (Some(expected), Some(found)) = (expected.flow("flow"), found.flow("flow")) {
        let error = endpoint_error(expected, found)?;
        // Only the statistics matter here, not the bound.
        report.flow = Spread::from(&compare(&vec![0.0; error.data.len()], &error.data, &Bound::default()));
    }
    Ok(report)
}

/// A rotation of some degrees, with a direction of motion off the camera's axis.
fn turn() -> Motion {
    let axis = DVec3::new(0.2, -0.5, 0.8).normalize();
    let heading = Heading { direction: DVec3::new(0.08, -0.03, 1.0).normalize(), error_rad: 0.02 };
    Motion { prev_from_cur: DMat3::from_axis_angle(axis, 0.04), heading }
}

impl Sides<'_> {
    fn step(&mut self, step: &Step, parity: usize, index: usize, report: &mut Report) -> Result<()> {
        for &input in &step.inputs {
            let buf = self.plan.buf(input);
            if !matches!(buf.content, Content::Constant(_)) {
                self.corrected.write(input, &self.cpu.read(input, buf.len)?);
            }
        }
        // Poison the outputs, so that a value that is not written cannot pass with its old content.
        for &(output, shape) in &step.outputs {
            let poison = vec![POISON; shape.len()];
            self.cpu.write(output, &poison);
            self.corrected.write(output, &poison);
        }
        self.cpu.step(parity, index)?;
        self.corrected.step(parity, index)?;
        self.alone.step(parity, index)?;
        self.compare(step, format!("frame {parity}, {}", step.label), report)
    }

    /// Compares a step's outputs on the GPU with those on the CPU.
    fn compare(&self, step: &Step, name: String, report: &mut Report) -> Result<()> {
        let outputs = step.outputs.iter().zip(step.kernel.outputs).zip(self.bounds(step)?);
        for ((&(id, shape), &output), bound) in outputs {
            let difference = self.difference(&self.corrected, id, shape, &bound)?;
            let alone = self.difference(&self.alone, id, shape, &bound)?;
            report.steps.push(StepFigures::new(step, name.clone(), output, shape, bound, &difference));
            let named = || Some(format!("{} ({name}): {output} by up to {:e}", step.kernel.name, alone.max));
            if alone.max != 0.0 && report.first_difference.is_none() {
                report.first_difference = named();
            }
            if alone.breaches > 0 && report.first_beyond_bound.is_none() {
                report.first_beyond_bound = named();
            }
        }
        Ok(())
    }

    /// The bound of each of the step's outputs.
    fn bounds(&self, step: &Step) -> Result<Vec<Bound>> {
        let read = |id: BufId, len: usize| self.cpu.read(id, len);
        let inputs: Result<Vec<_>> = step.inputs.iter().map(|&id| read(id, self.plan.buf(id).len)).collect();
        let expected: Result<Vec<_>> =
            step.outputs.iter().map(|&(id, shape)| read(id, shape.len())).collect();
        let (inputs, expected) = (inputs?, expected?);
        let inputs: Vec<&[f32]> = inputs.iter().map(Vec::as_slice).collect();
        let expected: Vec<&[f32]> = expected.iter().map(Vec::as_slice).collect();
        let bounds = step.kernel.bounds(&step.params, &inputs, &expected);
        Ok(bounds.into_iter().map(|bound| bound.times(self.factor)).collect())
    }

    fn difference(&self, side: &Runner, id: BufId, shape: Shape, within: &Bound) -> Result<Difference> {
        let (expected, found) = (self.cpu.read(id, shape.len())?, side.read(id, shape.len())?);
        Ok(compare(&expected, &found, within))
    }
}
