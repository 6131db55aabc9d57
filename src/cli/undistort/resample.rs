//! Resampling of an image to another camera, on either backend.

use crate::backend::Backend;
use crate::camera::Camera;
use crate::error::Result;
use crate::frame::{Image, PixelFormat, Plane, Size};
use crate::kernels::{remap, undistort_map};
use crate::plan::{Bufs, Fill, Plan, Port, PortKind, Shape, Step, Value};
use crate::runner::Runner;
use crate::sphere::{MOTION_LEN, Motion};

/// The map from one camera's image to another's, computed once, and the runner that resamples images by it.
pub(super) struct Resample {
    runner: Runner,
    raw_size: Size,
    out_size: Size,
    certainty: Plane,
}

impl Resample {
    pub(super) fn new(backend: &Backend, raw: &Camera, out: &Camera) -> Result<Self> {
        let runner = Runner::new(backend, plan(raw, out)?)?;
        let values = runner.read(runner.plan().setup[0].outputs[1].0, Shape::planar(out.size, 1).len())?;
        let mut certainty = Plane { size: out.size, data: vec![0.0; out.size.pixels()] };
        crate::plan::pack::unpack_plane(&values, out.size, &mut certainty.data);
        Ok(Self { runner, raw_size: raw.size, out_size: out.size, certainty })
    }

    /// The share of the result that the raw image covers.
    pub(super) fn share(&self) -> f64 {
        let sum: f64 = self.certainty.data.iter().map(|c| f64::from(*c)).sum();
        sum / self.out_size.pixels() as f64
    }

    /// The image as the other camera shows it, in the same format. Pixels outside the raw image are black.
    pub(super) fn apply(&mut self, image: &Image) -> Result<Image> {
        let (size, format) = (self.out_size, image.format);
        let channels = if format == PixelFormat::Gray16 { 1 } else { format.bytes() };
        let mut data = vec![0; size.pixels() * format.bytes()];
        for channel in 0..channels {
            let plane = Plane { size: self.raw_size, data: channel_of(image, channel) };
            let outputs = self.runner.run(&[("picture", Some(Value::Plane(&plane)))])?;
            let found =
                outputs.plane("resampled").unwrap_or_else(|| unreachable!("the plan has this output"));
            // Opacity is not brightness: it stays where the colours fade to black.
            let alpha = channel == 3;
            let values = found.data.iter().zip(&self.certainty.data);
            let values = values.map(|(v, c)| if alpha { *v } else { v * c });
            for (pixel, value) in data.chunks_exact_mut(format.bytes()).zip(values) {
                match (format, pixel) {
                    (PixelFormat::Gray16, pixel) => {
                        pixel.copy_from_slice(&(value.round() as u16).to_ne_bytes());
                    }
                    (_, pixel) => pixel[channel] = value.round() as u8,
                }
            }
        }
        Ok(Image { size, format, data })
    }
}

/// A plan that computes the map once, and then resamples one channel of an image per run.
fn plan(raw: &Camera, out: &Camera) -> Result<Plan> {
    let (from, to) = (Shape::planar(raw.size, 1), Shape::planar(out.size, 1));
    let mut bufs = Bufs::default();
    let picture = bufs.input("picture", from.len());
    let still = bufs.constant("no rotation", Motion::UNKNOWN.values()[..MOTION_LEN].to_vec());
    let mask = bufs.constant("mask", vec![1.0; from.len()]);
    let places = bufs.computed("map", Shape::planar(out.size, 2));
    let certainty = bufs.computed("certainty", to);
    let resampled = bufs.computed("resampled", to);
    let map = Step::new(
        &undistort_map::KERNEL,
        "once",
        undistort_map::Params::new(out, raw),
        &[still, mask],
        &[(places, Shape::planar(out.size, 2)), (certainty, to)],
    );
    let params = remap::Params {
        width: out.size.width,
        height: out.size.height,
        in_width: raw.size.width,
        in_height: raw.size.height,
    };
    let resample = Step::new(&remap::KERNEL, "picture", params, &[picture, places], &[(resampled, to)]);
    let input = PortKind::Plane { size: raw.size, range: None };
    let output = PortKind::Plane { size: out.size, range: None };
    let mut plan = Plan::single(
        out.size,
        bufs.finish(),
        vec![resample],
        vec![Port::new("picture", input, picture, Fill::Required)],
        vec![Port::output("resampled", output, resampled)],
    );
    plan.setup = vec![map];
    plan.validate()?;
    Ok(plan)
}

/// The values of one channel of an image, row by row.
fn channel_of(image: &Image, channel: usize) -> Vec<f32> {
    let bytes = image.format.bytes();
    let value = |pixel: &[u8]| match (image.format, pixel) {
        (PixelFormat::Gray16, &[low, high]) => f32::from(u16::from_ne_bytes([low, high])),
        _ => f32::from(pixel[channel]),
    };
    image.data.chunks_exact(bytes).map(value).collect()
}
