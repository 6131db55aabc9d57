//! The plan from two frames and points to the points' places in the second frame.

use super::TrackParameters;
use crate::error::{Error, Result};
use crate::flow::gray_step;
use crate::frame::{PixelFormat, Size};
use crate::kernels::{patches, pyr_down, track_points};
use crate::plan::{BufId, Bufs, Fill, Plan, Port, PortKind, Shape, Step};

/// The largest number of points of a plan: every GPU dispatches that many workgroups.
pub const MAX_POINTS: usize = 65535;

/// The sizes of the pyramid's levels, the full image first. A level is half of the one before it, rounded up; levels that
/// are not larger than the window in both directions are left out.
pub fn pyramid(size: Size, parameters: &TrackParameters) -> Vec<Size> {
    let [columns, rows] = parameters.window;
    let mut levels = vec![size];
    while levels.len() <= parameters.levels as usize {
        let half = pyr_down::halved(levels[levels.len() - 1]);
        if half.width <= columns || half.height <= rows {
            break;
        }
        levels.push(half);
    }
    levels
}

/// The plan that follows up to `capacity` points from the previous frame into the current one, and with `backward` back
/// again. As in OpenCV, the pyramid's levels of 8-bit frames are rounded to whole gray levels; those of 16-bit frames are
/// not.
///
/// Inputs are `frame`; `points`, for each point x and y in pixels of the previous frame, 1, and 0; and `initial`, for each
/// point x and y where the search begins, 1, and 0. Points beyond those given are zeros, and absent. Outputs are `tracked`
/// and, with `backward`, `returned`: for each point x and y, 1 or 0 for found or lost, and the mean absolute difference of
/// the windows in gray levels.
///
/// # Errors
/// [`Error::Parameter`] for a parameter, size or capacity that is out of range.
pub fn plan(
    size: Size,
    format: PixelFormat,
    parameters: &TrackParameters,
    capacity: usize,
    backward: bool,
) -> Result<Plan> {
    size.validate()?;
    parameters.validate(size)?;
    if !(1..=MAX_POINTS).contains(&capacity) {
        return Err(Error::parameter("number of points", capacity, format_args!("1 to {MAX_POINTS}")));
    }
    let mut bufs = Bufs::default();
    let frame_kind = PortKind::Frame { size, format };
    let frame = bufs.input("frame", frame_kind.len());
    let [points, initial] = ["points", "initial"].map(|name| bufs.input(name, 4 * capacity));
    let levels = pyramid(size, parameters);
    let image = |bufs: &mut Bufs, k: usize, size: Size, frames: &str| {
        bufs.computed(format!("level {k}, {frames} frames"), Shape::planar(size, 1))
    };
    let images = (levels.iter().enumerate())
        .map(|(k, size)| ["even", "odd"].map(|frames| image(&mut bufs, k, *size, frames)));
    let images: Vec<[BufId; 2]> = images.collect();
    let follow = Follow::new(&mut bufs, parameters, levels, images, capacity);
    let tracked = bufs.computed("tracked points", states(capacity));
    let returned = backward.then(|| bufs.computed("returned points", states(capacity)));
    let pair = [0, 1].map(|parity| {
        let mut steps = Vec::new();
        follow.steps(&mut steps, "forward", [1 - parity, parity], [points, initial, tracked]);
        if let Some(returned) = returned {
            follow.steps(&mut steps, "backward", [parity, 1 - parity], [tracked, tracked, returned]);
        }
        steps
    });
    let ingest = [0, 1].map(|parity| {
        let mut steps = vec![gray_step(size, format, frame, follow.images[0][parity])];
        for (k, pair) in follow.images.windows(2).enumerate() {
            let shape = Shape::planar(follow.levels[k + 1], 1);
            let params = pyr_down::Params::new(follow.levels[k], format != PixelFormat::Gray16);
            let label = format!("level {}", k + 1);
            steps.push(Step::new(
                &pyr_down::KERNEL,
                label,
                params,
                &[pair[0][parity]],
                &[(pair[1][parity], shape)],
            ));
        }
        steps
    });
    let raw = PortKind::Raw { len: 4 * capacity };
    let inputs = vec![
        Port::new("frame", frame_kind, frame, Fill::Required),
        Port::new("points", raw, points, Fill::Value(0.0)),
        Port::new("initial", raw, initial, Fill::Value(0.0)),
    ];
    let mut outputs = vec![Port::output("tracked", raw, tracked)];
    outputs.extend(returned.map(|returned| Port::output("returned", raw, returned)));
    let (setup, carried) = (Vec::new(), Vec::new());
    let plan = Plan { size, bufs: bufs.finish(), setup, ingest, pair, inputs, outputs, carried };
    plan.validate()?;
    Ok(plan)
}

/// Four values for each point.
fn states(capacity: usize) -> Shape {
    Shape::planar(Size::new(4, capacity as u32), 1)
}

/// A row for each point: gray levels and gradients of its window's samples.
fn patches_shape(parameters: &TrackParameters, capacity: usize) -> Shape {
    let [columns, rows] = parameters.window;
    Shape::planar(Size::new(columns * rows, capacity as u32), 3)
}

/// The buffers and steps that follow points from one image to the other.
struct Follow {
    parameters: TrackParameters,
    levels: Vec<Size>,
    /// For each level, finest first, the images of even and odd frames.
    images: Vec<[BufId; 2]>,
    capacity: usize,
    patches: BufId,
    tensors: BufId,
    /// The points after a level, alternately.
    between: [BufId; 2],
}

impl Follow {
    fn new(
        bufs: &mut Bufs,
        parameters: &TrackParameters,
        levels: Vec<Size>,
        images: Vec<[BufId; 2]>,
        capacity: usize,
    ) -> Self {
        let patches = bufs.computed("patches", patches_shape(parameters, capacity));
        let tensors = bufs.computed("structure tensors", states(capacity));
        let between = [0, 1].map(|_| bufs.computed("points between levels", states(capacity)));
        Self { parameters: *parameters, levels, images, capacity, patches, tensors, between }
    }

    /// The steps that follow `points` of the image in the first slot into that in the second, from `initial` on.
    fn steps(
        &self,
        steps: &mut Vec<Step>,
        way: &str,
        [first, second]: [usize; 2],
        [points, initial, tracked]: [BufId; 3],
    ) {
        let TrackParameters {
            window: [window_width, window_height],
            iterations,
            epsilon,
            min_eigenvalue,
            ..
        } = self.parameters;
        let samples = f64::from(window_width) * f64::from(window_height);
        // OpenCV's gradients are 32 times as large and its squares have the factor 2⁻²⁰: from its limits to those of the
        // mean over the window in gray levels.
        let unit = 1024.0;
        let mut from = initial;
        for (k, size) in self.levels.iter().enumerate().rev() {
            let (Size { width, height }, scale) = (*size, 0.5_f32.powi(k as i32));
            let label = format!("{way}, level {k}");
            steps.push(Step::new(
                &patches::KERNEL,
                label.clone(),
                patches::Params { width, height, window_width, window_height, scale },
                &[self.images[k][first], points],
                &[
                    (self.patches, patches_shape(&self.parameters, self.capacity)),
                    (self.tensors, states(self.capacity)),
                ],
            ));
            let to = if k == 0 { tracked } else { self.between[k % 2] };
            let params = track_points::Params {
                width,
                height,
                window_width,
                window_height,
                scale,
                iterations,
                epsilon: (epsilon * epsilon) as f32,
                min_eigenvalue: (min_eigenvalue * unit) as f32,
                min_determinant: (f64::from(f32::EPSILON) * unit * unit / (samples * samples)) as f32,
                finest: u32::from(k == 0),
            };
            steps.push(Step::new(
                &track_points::KERNEL,
                label,
                params,
                &[self.images[k][second], self.patches, self.tensors, from],
                &[(to, states(self.capacity))],
            ));
            from = to;
        }
    }
}
