//! The buffers of the method's parts.

use crate::flow::Level;
use crate::frame::Size;
use crate::kernels::block_mean::{self, blocks_of};
use crate::kernels::{resample_x, resample_y, steadiness, surroundings, tables, upsample};
use crate::plan::{BufId, Bufs, Shape, Step};

/// Radius and standard deviation in pixels of the window over which expected slopes are averaged.
const SLOPE_WINDOW: (usize, f64) = (18, 6.0);
/// Radius and standard deviation in pixels of what the confidence takes for near a pixel.
const NEAR_WINDOW: (u32, f64) = (9, 3.0);
/// The same for what is around it, in blocks of four pixels.
const AROUND_WINDOW: (u32, f64) = (24, 8.0);

/// The weights of a Gaussian window along columns and along rows.
pub(super) struct Window {
    pub(super) radius: usize,
    pub(super) y: BufId,
    pub(super) x: BufId,
}

impl Window {
    pub(super) fn new(bufs: &mut Bufs, name: &str, (radius, sigma): (usize, f64)) -> Self {
        let weights = tables::gauss(sigma, 2 * radius as u32 + 1);
        Self {
            radius,
            y: bufs.constant(format!("{name}, columns"), tables::window_from(&weights, radius)),
            x: bufs.constant(format!("{name}, rows"), tables::window_from(&weights, radius.next_multiple_of(4))),
        }
    }
}

/// The slopes that are expected of the flow.
pub(super) struct Slopes {
    /// Those of the coarsest level before any are known.
    pub(super) zero: BufId,
    /// For each level, finest first; those of levels that are left out are never read.
    pub(super) of_level: Vec<BufId>,
    /// For each level, the tables for reading the coarser one's.
    pub(super) place: Vec<Option<[BufId; 2]>>,
    pub(super) window: Window,
}

impl Slopes {
    pub(super) fn new(bufs: &mut Bufs, levels: &[Level], finest: usize) -> Self {
        let coarsest = levels[levels.len() - 1].size;
        let zero = bufs.constant("no slope", vec![0.0; Shape::planar(coarsest, 4).len()]);
        let of_level = levels.iter().enumerate().map(|(k, level)| match k < finest {
            true => zero,
            false => bufs.computed(format!("slopes, level {k}"), Shape::planar(level.size, 4)),
        });
        let of_level = of_level.collect();
        let place = (0..levels.len()).map(|k| {
            let (fine, coarse) = (levels[k].size, levels.get(k + 1).filter(|_| k >= finest)?.size);
            let mut table = |what: &str, inner, out| {
                bufs.constant(format!("{what} of level {}, slopes", k + 1), tables::place(inner, out))
            };
            Some([table("columns", coarse.width, fine.width), table("rows", coarse.height, fine.height)])
        });
        let place = place.collect();
        Self { zero, of_level, place, window: Window::new(bufs, "window of slopes", SLOPE_WINDOW) }
    }
}

/// The buffers of the misfit and what follows from it.
pub(super) struct Fit {
    pub(super) squared_misfit: BufId,
    pub(super) agreement: BufId,
    /// What the non-local step makes of the misfit, if there is one.
    pub(super) weight: Option<BufId>,
}

impl Fit {
    pub(super) fn new(bufs: &mut Bufs, size: Size, nonlocal: bool) -> Self {
        let plane = Shape::planar(size, 1);
        Self {
            squared_misfit: bufs.computed("squared misfit", plane),
            agreement: bufs.computed("agreement", plane),
            weight: nonlocal.then(|| bufs.computed("weight of the fit", plane)),
        }
    }
}

/// The buffers of the confidence: the geometric mean of the agreement near a pixel and further around, less where the flow
/// bends.
pub(super) struct Confidence {
    /// The result, at the size of the images.
    pub(super) plane: BufId,
    steady: BufId,
    near: Average,
    blocks: BufId,
    around: Average,
    /// If the finest computed level is not the images' own.
    enlarged: Option<Enlarged>,
}

/// An average of a plane over a Gaussian.
struct Average {
    size: Size,
    gauss: BufId,
    taps: u32,
    /// The tables that keep columns and rows where they are.
    place: [BufId; 2],
    columns: BufId,
    result: BufId,
}

/// The confidence of a level that is enlarged to the images' size.
#[derive(Clone, Copy)]
struct Enlarged {
    from: BufId,
    place: [BufId; 2],
}

impl Average {
    fn new(bufs: &mut Bufs, name: &str, size: Size, (radius, sigma): (u32, f64)) -> Self {
        let (plane, taps) = (Shape::planar(size, 1), 2 * radius + 1);
        Self {
            size,
            gauss: bufs.constant(format!("{name}, Gaussian"), tables::gauss(sigma, taps)),
            taps,
            place: [
                bufs.constant(format!("{name}, own columns"), tables::place(size.width, size.width)),
                bufs.constant(format!("{name}, own rows"), tables::place(size.height, size.height)),
            ],
            columns: bufs.computed(format!("{name}, columns"), plane),
            result: bufs.computed(name.to_owned(), plane),
        }
    }

    /// The steps that average `of`.
    fn steps(&self, steps: &mut Vec<Step>, of: BufId) {
        let (Size { width, height }, taps, plane) = (self.size, self.taps, Shape::planar(self.size, 1));
        let [place_x, place_y] = self.place;
        steps.push(Step::new(
            &resample_y::KERNEL,
            Confidence::LABEL,
            resample_y::Params { width, height, in_height: height, taps },
            &[of, self.gauss, place_y],
            &[(self.columns, plane)],
        ));
        steps.push(Step::new(
            &resample_x::KERNEL,
            Confidence::LABEL,
            resample_x::Params { width, height, in_width: width, taps },
            &[self.columns, self.gauss, place_x],
            &[(self.result, plane)],
        ));
    }
}

impl Confidence {
    /// Buffers for the finest computed level, of size `own`, and images of size `size`.
    pub(super) fn new(bufs: &mut Bufs, own: Size, size: Size) -> Self {
        let (plane, blocks) = (Shape::planar(own, 1), blocks_of(own));
        Self {
            plane: bufs.computed("confidence", Shape::planar(size, 1)),
            steady: bufs.computed("steady agreement", plane),
            near: Average::new(bufs, "agreement nearby", own, NEAR_WINDOW),
            blocks: bufs.computed("agreement of blocks", Shape::planar(blocks, 1)),
            around: Average::new(bufs, "agreement around", blocks, AROUND_WINDOW),
            enlarged: (own != size).then(|| Enlarged {
                from: bufs.computed("confidence of the finest level", plane),
                place: [
                    bufs.constant("columns of the confidence", tables::place(own.width, size.width)),
                    bufs.constant("rows of the confidence", tables::place(own.height, size.height)),
                ],
            }),
        }
    }

    /// The label of its steps.
    pub(super) const LABEL: &str = "confidence";

    /// The steps from `agreement` and `flow` of the finest computed level to the confidence, enlarged to the size `full`.
    pub(super) fn judge(&self, steps: &mut Vec<Step>, agreement: BufId, flow: BufId, full: Size) {
        let (Size { width, height }, around) = (self.near.size, Shape::planar(self.around.size, 1));
        let plane = Shape::planar(self.near.size, 1);
        let params = steadiness::Params { width, height };
        steps.push(Step::new(&steadiness::KERNEL, Self::LABEL, params, &[agreement, flow], &[(self.steady, plane)]));
        self.near.steps(steps, self.steady);
        let params = block_mean::Params { width, height };
        steps.push(Step::new(&block_mean::KERNEL, Self::LABEL, params, &[self.steady], &[(self.blocks, around)]));
        self.around.steps(steps, self.blocks);
        let whole = self.enlarged.map_or(self.plane, |enlarged| enlarged.from);
        let params = surroundings::Params { width, height };
        let inputs = [self.near.result, self.around.result];
        steps.push(Step::new(&surroundings::KERNEL, Self::LABEL, params, &inputs, &[(whole, plane)]));
        if let Some(Enlarged { place: [place_x, place_y], .. }) = self.enlarged {
            let params = upsample::Params {
                width: full.width,
                height: full.height,
                in_width: width,
                in_height: height,
                scale: 1.0,
                channels: 1,
            };
            let output = [(self.plane, Shape::planar(full, 1))];
            steps.push(Step::new(&upsample::KERNEL, Self::LABEL, params, &[whole, place_x, place_y], &output));
        }
    }
}
