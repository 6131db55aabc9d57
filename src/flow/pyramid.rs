//! The image pyramid: each level is smoothed and sampled from the full image.

use super::Level;
use crate::frame::Size;
use crate::kernels::{binomial, resample_x, resample_y, tables};
use crate::plan::{BufId, Bufs, Shape, Step};

/// The buffers that reduce a full image to the levels of a pyramid.
pub(super) struct Pyramid {
    size: Size,
    /// The image reduced in height only.
    columns: BufId,
    /// For each level but the finest.
    reductions: Vec<Reduction>,
}

/// The tables for sampling the full image on one level.
struct Reduction {
    level: Level,
    gauss: BufId,
    place_x: BufId,
    place_y: BufId,
}

impl Pyramid {
    /// Allocates the buffers for images of this size and these levels, finest first.
    pub(super) fn new(bufs: &mut Bufs, size: Size, levels: &[Level]) -> Self {
        let columns = bufs.computed("smoothed columns", Shape::planar(size, 1));
        let reduction = |(k, &level): (usize, &Level)| Reduction {
            level,
            gauss: bufs.constant(format!("Gaussian, level {k}"), tables::gauss(level.sigma, level.taps)),
            place_x: bufs
                .constant(format!("columns, level {k}"), tables::place(size.width, level.size.width)),
            place_y: bufs.constant(format!("rows, level {k}"), tables::place(size.height, level.size.height)),
        };
        Self { size, columns, reductions: levels.iter().enumerate().skip(1).map(reduction).collect() }
    }

    /// The steps that reduce a full image to level `k`, in `image`.
    pub(super) fn reduce(&self, steps: &mut Vec<Step>, k: usize, full: BufId, image: BufId) {
        let label = format!("level {k}");
        let Some(reduction) = k.checked_sub(1).map(|k| &self.reductions[k]) else {
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
            &[(self.columns, Shape::planar(Size::new(self.size.width, height), 1))],
        ));
        steps.push(Step::new(
            &resample_x::KERNEL,
            label,
            resample_x::Params { width, height, in_width: self.size.width, taps },
            &[self.columns, reduction.gauss, reduction.place_x],
            &[(image, Shape::planar(reduction.level.size, 1))],
        ));
    }
}
