//! Resampling of an image to another camera, on either backend.

use crate::backend::Backend;
use crate::camera::Camera;
use crate::error::Result;
use crate::frame::{Image, PixelFormat, Plane};
use crate::kernels::{remap, undistort_map};
use crate::plan::{Bufs, Fill, Given, Plan, Port, PortKind, Shape, Step, Value};
use crate::runner::Runner;
use crate::sphere::{MOTION_LEN, Motion};

/// The inputs and outputs of the plan, one of each per channel.
const CHANNELS: [(&str, &str); 4] = [
    ("channel 0", "resampled 0"),
    ("channel 1", "resampled 1"),
    ("channel 2", "resampled 2"),
    ("channel 3", "resampled 3"),
];

/// The map from one camera's image to another's, computed once, and the runner that resamples images by it.
pub(super) struct Resample {
    backend: Backend,
    raw: Camera,
    out: Camera,
    /// For images of as many channels as the last one.
    runner: Runner,
    certainty: Plane,
}

impl Resample {
    pub(super) fn new(backend: &Backend, raw: &Camera, out: &Camera) -> Result<Self> {
        let runner = Runner::new(backend, plan(raw, out, 1)?)?;
        let values = runner.read(runner.plan().setup[0].outputs[1].0, Shape::planar(out.size, 1).len())?;
        let mut certainty = Plane { size: out.size, data: vec![0.0; out.size.pixels()] };
        crate::plan::pack::unpack_plane(&values, out.size, &mut certainty.data);
        Ok(Self { backend: backend.clone(), raw: *raw, out: *out, runner, certainty })
    }

    /// The share of the result that the raw image covers.
    pub(super) fn share(&self) -> f64 {
        let sum: f64 = self.certainty.data.iter().map(|c| f64::from(*c)).sum();
        sum / self.out.size.pixels() as f64
    }

    /// The image as the other camera shows it, in the same format. Pixels outside the raw image are black.
    pub(super) fn apply(&mut self, image: &Image) -> Result<Image> {
        let (size, format) = (self.out.size, image.format);
        let channels = if format == PixelFormat::Gray16 { 1 } else { format.bytes() };
        if self.runner.plan().inputs.len() != channels {
            self.runner = Runner::new(&self.backend, plan(&self.raw, &self.out, channels)?)?;
        }
        let planes: Vec<Plane> = (0..channels)
            .map(|channel| Plane { size: self.raw.size, data: channel_of(image, channel) })
            .collect();
        let given: Vec<Given<'_>> = CHANNELS
            .iter()
            .zip(&planes)
            .map(|((name, _), plane)| (*name, Some(Value::Plane(plane))))
            .collect();
        let outputs = self.runner.run(&given)?;
        let mut data = vec![0; size.pixels() * format.bytes()];
        for (channel, (_, name)) in CHANNELS.iter().enumerate().take(channels) {
            let found = outputs.plane(name).unwrap_or_else(|| unreachable!("the plan has this output"));
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

/// A plan that computes the map once, and then resamples all channels of an image per run.
fn plan(raw: &Camera, out: &Camera, channels: usize) -> Result<Plan> {
    let (from, to) = (Shape::planar(raw.size, 1), Shape::planar(out.size, 1));
    let mut bufs = Bufs::default();
    let still = bufs.constant("no rotation", Motion::UNKNOWN.values()[..MOTION_LEN].to_vec());
    let mask = bufs.constant("mask", vec![1.0; from.len()]);
    let places = bufs.computed("map", Shape::planar(out.size, 2));
    let certainty = bufs.computed("certainty", to);
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
    let [input, output] = [raw.size, out.size].map(|size| PortKind::Plane { size, range: None });
    let (mut steps, mut inputs, mut outputs) = (Vec::new(), Vec::new(), Vec::new());
    for (channel, resampled) in &CHANNELS[..channels] {
        let (of_raw, of_out) = (bufs.input(*channel, from.len()), bufs.computed(*resampled, to));
        steps.push(Step::new(&remap::KERNEL, *channel, params, &[of_raw, places], &[(of_out, to)]));
        inputs.push(Port::new(channel, input, of_raw, Fill::Required));
        outputs.push(Port::output(resampled, output, of_out));
    }
    let mut plan = Plan::single(out.size, bufs.finish(), steps, inputs, outputs);
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
