//! The results of a crosscheck.

use crate::kernel::Bound;
use crate::kernels::compare::Difference;
use crate::plan::{Shape, Step};
use crate::quantile::nearest_rank;

/// The results of a crosscheck.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Report {
    /// The name of the GPU adapter.
    pub adapter: String,
    /// The frames' width in pixels.
    pub width: u32,
    /// The frames' height in pixels.
    pub height: u32,
    /// The number of values beyond their bound, over all steps: 0 if the two backends agree.
    pub breaches: usize,
    /// Every output of every step, in the order in which the steps run.
    pub steps: Vec<StepFigures>,
    /// The endpoint difference of the two flow fields, each computed independently, in pixels; zeros for a plan without
    /// the output `flow`.
    pub flow: Spread,
    /// The first step of the independent runs with any difference.
    pub first_difference: Option<String>,
    /// The first step of the independent runs with a difference beyond its kernel's bound.
    pub first_beyond_bound: Option<String>,
}

/// The figures of one output of one step.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StepFigures {
    /// The kernel's name.
    pub kernel: &'static str,
    /// The step: `once` for a step of the setup, else the frame (0 or 1) and the step's label.
    pub step: String,
    /// The output's name.
    pub output: &'static str,
    /// The differences, given the same inputs.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub spread: Spread,
    /// The part of the bound that is the same for every value.
    pub bound_absolute: f32,
    /// The part of the bound that is this factor times the value's magnitude.
    pub bound_relative: f32,
    /// Statistics of the per-value bounds, where the kernel gives them.
    pub bound_own: Option<Own>,
    /// The reason for the bound.
    pub reason: &'static str,
    /// The largest ratio of a value's difference to its bound.
    pub share_of_bound: f32,
    /// The number of values compared.
    pub values: usize,
    /// The number of values beyond their bound.
    pub breaches: usize,
    /// The value that exceeds its bound the most, if there is one.
    pub worst: Option<Worst>,
}

/// Statistics of the per-value bounds of one output.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Own {
    /// The median.
    pub median: f32,
    /// The 99.9th percentile (nearest rank).
    pub p999: f32,
    /// The largest.
    pub max: f32,
}

/// Statistics of the differences between two sets of values.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Spread {
    /// The largest difference; infinite if one value is NaN or infinite and the other is not the same.
    pub max: f32,
    /// The 99.9th percentile (nearest rank).
    pub p999: f32,
    /// The mean.
    pub mean: f64,
}

/// The value that exceeds its bound the most.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Worst {
    /// The column of the value's pixel.
    pub column: usize,
    /// The row of the value's pixel.
    pub row: usize,
    /// The channel of the value.
    pub channel: usize,
    /// The CPU's value.
    pub cpu: f32,
    /// The GPU's value.
    pub gpu: f32,
    /// The bound of their difference.
    pub bound: f32,
}

impl StepFigures {
    pub(super) fn new(
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
    use crate::kernels::compare::{POISON, compare};

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
