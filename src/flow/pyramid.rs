//! The image pyramid: each level is smoothed and sampled from the full image.

use super::Level;
use crate::frame::Size;
use crate::kernels::{binomial, resample_x, resample_y, tables};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The buffers that reduce a full image to the levels of a pyramid.
pub(super) struct Pyramid {
    size: Size,
    /// The image reduced in height only; `None` if the full image is the only level.
    columns: Option<BufId>,
    /// For each level that is computed, but the full image.
    reductions: Vec<Option<Reduction>>,
}

/// The tables for sampling the full image on one level.
struct Reduction {
    level: Level,
    gauss: BufId,
    place_x: BufId,
    place_y: BufId,
}

impl Pyramid {
    /// Allocates the buffers for images of this size and these levels, finest first, of which those that `is_used` tells
    /// are computed.
    pub(super) fn new(
        bufs: &mut Bufs,
        size: Size,
        levels: &[Level],
        is_used: impl Fn(usize) -> bool,
    ) -> Self {
        let is_reduced = |k: usize| k > 0 && is_used(k);
        let columns = (0..levels.len()).find(|k| is_reduced(*k)).map(|k| {
            let columns = Size::new(size.width, levels[k].size.height);
            bufs.computed("smoothed columns", Shape::planar(columns, 1))
        });
        let reduction = |(k, &level): (usize, &Level)| {
            is_reduced(k).then(|| Reduction {
                level,
                gauss: bufs.constant(format!("Gaussian, level {k}"), tables::gauss(level.sigma, level.taps)),
                place_x: bufs
                    .constant(format!("columns, level {k}"), tables::place(size.width, level.size.width)),
                place_y: bufs
                    .constant(format!("rows, level {k}"), tables::place(size.height, level.size.height)),
            })
        };
        Self { size, columns, reductions: levels.iter().enumerate().map(reduction).collect() }
    }

    /// The steps that reduce a full image to level `k`, in `image`.
    pub(super) fn reduce(&self, steps: &mut Vec<Step>, k: usize, full: BufId, image: BufId) {
        let label = format!("level {k}");
        let (Some(reduction), Some(columns)) = (&self.reductions[k], self.columns) else {
            assert_eq!(k, 0, "a level that is not computed");
            let (params, plane) = (binomial::Params::new(self.size), Shape::planar(self.size, 1));
            steps.push(Step::new(&binomial::KERNEL, label, params, &[full], &[(image, plane)]));
            return;
        };
        let Size { width, height } = reduction.level.size;
        let taps = reduction.level.taps;
        steps.push(Step::new(
            &resample_y::KERNEL,
            label.clone(),
            resample_y::Params { width: self.size.width, height, in_height: self.size.height, taps },
            &[full, reduction.gauss, reduction.place_y],
            &[(columns, Shape::planar(Size::new(self.size.width, height), 1))],
        ));
        steps.push(Step::new(
            &resample_x::KERNEL,
            label,
            resample_x::Params { width, height, in_width: self.size.width, taps },
            &[columns, reduction.gauss, reduction.place_x],
            &[(image, Shape::planar(reduction.level.size, 1))],
        ));
    }
}
