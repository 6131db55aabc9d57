//! The comparison of the two backends.

use glam::{DMat3, DVec3};
use serde::Serialize;

use crate::backend::Backend;
use crate::error::Result;
use crate::eval::endpoint_error;
use crate::frame::{Image, Plane};
use crate::gpu::Gpu;
use crate::kernel::Bound;
use crate::kernels::compare::{Difference, POISON, compare};
use crate::plan::{BufId, Content, Given, Outputs, Plan, Shape, Step, Value};
use crate::quantile::nearest_rank;
use crate::runner::Runner;
use crate::sphere::{Heading, Motion};

/// The results of a crosscheck.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub(super) adapter: String,
    pub(super) width: u32,
    pub(super) height: u32,
    /// The number of values beyond their bound, over all steps.
    pub(super) breaches: usize,
    pub(super) steps: Vec<StepFigures>,
    /// The difference of the two flow fields, each computed independently, in pixels.
    pub(super) flow: Spread,
    /// In the independent runs: the first step with any difference, and the first with one beyond its kernel's bound.
    pub(super) first_difference: Option<String>,
    pub(super) first_beyond_bound: Option<String>,
}

/// The figures of one output of one step.
#[derive(Debug, Serialize)]
pub(super) struct StepFigures {
    pub(super) kernel: &'static str,
    pub(super) step: String,
    pub(super) output: &'static str,
    #[serde(flatten)]
    pub(super) spread: Spread,
    pub(super) bound_absolute: f32,
    pub(super) bound_relative: f32,
    /// Statistics of the per-value bounds, where the kernel gives them.
    pub(super) bound_own: Option<Own>,
    pub(super) reason: &'static str,
    /// The largest ratio of a value's difference to its bound.
    pub(super) share_of_bound: f32,
    pub(super) values: usize,
    pub(super) breaches: usize,
    pub(super) worst: Option<Worst>,
}

/// Statistics of the per-value bounds of one output.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Own {
    pub(super) median: f32,
    pub(super) p999: f32,
    pub(super) max: f32,
}

/// Statistics of the differences between two sets of values.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Spread {
    pub(super) max: f32,
    pub(super) p999: f32,
    pub(super) mean: f64,
}

/// The value that exceeds its bound the most.
#[derive(Debug, Serialize)]
pub(super) struct Worst {
    pub(super) column: usize,
    pub(super) row: usize,
    pub(super) channel: usize,
    pub(super) cpu: f32,
    pub(super) gpu: f32,
    pub(super) bound: f32,
}

/// The CPU, and the GPU twice: with its inputs corrected before every step, and running independently.
struct Sides<'a> {
    plan: &'a Plan,
    cpu: Runner,
    corrected: Runner,
    alone: Runner,
    /// The factor that multiplies every bound.
    factor: f32,
}

/// Runs the plan on a pair of frames on all sides, with every bound multiplied by `factor`.
pub(super) fn run(
    gpu: &Gpu,
    plan: &Plan,
    pair: &[Image; 2],
    certainty: Option<&Plane>,
    factor: f32,
) -> Result<Report> {
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

impl StepFigures {
    fn new(
        step: &Step,
        name: String,
        output: &'static str,
        shape: Shape,
        within: Bound,
        found: &Difference,
    ) -> Self {
        let worst = found.worst.map(|breach| {
            let [column, row, channel] = shape.place(breach.index);
            Worst { column, row, channel, cpu: breach.expected, gpu: breach.found, bound: breach.bound }
        });
        Self {
            kernel: step.kernel.name,
            step: name,
            output,
            spread: Spread::from(found),
            bound_absolute: within.absolute,
            bound_relative: within.relative,
            bound_own: Own::of(within.own),
            reason: step.kernel.tolerance.reason,
            share_of_bound: found.share,
            values: found.count,
            breaches: found.breaches,
            worst,
        }
    }
}

impl Own {
    fn of(mut bounds: Vec<f32>) -> Option<Self> {
        bounds.sort_unstable_by(f32::total_cmp);
        let rank = |thousandths| nearest_rank(&bounds, thousandths);
        Some(Self { median: rank(500)?, p999: rank(999)?, max: rank(1000)? })
    }
}

impl From<&Difference> for Spread {
    fn from(d: &Difference) -> Self {
        Self { max: d.max, p999: d.p999, mean: d.mean }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::flow::{self, FlowOptions};
    use crate::frame::{PixelFormat, Size};
    use crate::plan::Shape;

    /// Tests the check itself: it finds and locates a value that differs, and one that was never written.
    #[test]
    fn a_breach_is_counted_and_placed() {
        let size = Size::new(5, 3);
        let options = FlowOptions::default();
        let plan = flow::plan(&flow::Algorithm::default(), size, PixelFormat::Gray8, options).unwrap();
        let step = &plan.ingest[0][0];
        let shape = Shape::planar(size, 1);
        let expected = vec![1.0; shape.len()];
        let mut found = expected.clone();
        found[8 * 2 + 3] = 2.0;
        found[8] = POISON;
        let bound = Bound::default();
        let difference = compare(&expected, &found, &bound);
        let figures = StepFigures::new(step, "frame".to_owned(), "gray", shape, bound, &difference);
        assert_eq!((figures.breaches, figures.kernel), (2, "luma"));
        let worst = figures.worst.unwrap();
        assert_eq!((worst.column, worst.row, worst.channel, worst.cpu), (0, 1, 0, 1.0));
        assert!(figures.spread.max.is_infinite() && worst.gpu.is_nan());
    }
}
