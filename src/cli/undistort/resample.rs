//! A picture as another camera would show it, on either executor.

use glam::DMat3;

use crate::camera::Camera;
use crate::engine::Backend;
use crate::error::Result;
use crate::frame::{Image, PixelFormat, Size};
use crate::kernel::Kernel;
use crate::kernels::{lens_map, remap};

/// The map from one camera's picture to another's, computed once.
pub(super) struct Resample {
    backend: Backend,
    raw_size: Size,
    out_size: Size,
    map: Vec<f32>,
    certainty: Vec<f32>,
}

impl Resample {
    pub(super) fn new(backend: Backend, raw: &Camera, out: &Camera) -> Result<Self> {
        let params = lens_map::Params::new(out, raw);
        let motion = lens_map::motion(&DMat3::IDENTITY);
        let mask = vec![1.0; values(raw.size)];
        let mut resample = Self {
            backend,
            raw_size: raw.size,
            out_size: out.size,
            map: vec![0.0; 2 * values(out.size)],
            certainty: vec![0.0; values(out.size)],
        };
        let params = bytemuck::bytes_of(&params);
        let lengths = [2 * values(out.size), values(out.size)];
        let mut results = resample.run(&lens_map::KERNEL, params, &[&motion, &mask], &lengths)?.into_iter();
        resample.map = results.next().unwrap_or_default();
        resample.certainty = results.next().unwrap_or_default();
        Ok(resample)
    }

    /// Part of the result that the raw picture shows.
    pub(super) fn share(&self) -> f64 {
        let width = self.out_size.width as usize;
        let rows = self.certainty.chunks_exact(self.out_size.stride());
        let sum: f64 = rows.flat_map(|row| &row[..width]).map(|c| f64::from(*c)).sum();
        sum / self.out_size.pixels() as f64
    }

    /// The picture as the other camera shows it, in the same format. Outside the raw picture it is black.
    pub(super) fn apply(&self, image: &Image) -> Result<Image> {
        let (size, format) = (self.out_size, image.format);
        let params = remap::Params {
            width: size.width,
            height: size.height,
            in_width: self.raw_size.width,
            in_height: self.raw_size.height,
        };
        let channels = if format == PixelFormat::Gray16 { 1 } else { format.bytes() };
        let mut data = vec![0; size.pixels() * format.bytes()];
        for channel in 0..channels {
            let plane = plane(image, channel);
            let inputs: [&[f32]; 2] = [&plane, &self.map];
            let results = self.run(&remap::KERNEL, bytemuck::bytes_of(&params), &inputs, &[values(size)])?;
            let Some(plane) = results.first() else { continue };
            // How opaque a pixel is has nothing to do with how bright.
            let alpha = channel == 3;
            let rows = plane.chunks_exact(size.stride()).zip(self.certainty.chunks_exact(size.stride()));
            let found = rows.flat_map(|(row, certainty)| {
                row.iter()
                    .zip(certainty)
                    .take(size.width as usize)
                    .map(|(v, c)| if alpha { *v } else { v * c })
            });
            for (pixel, value) in data.chunks_exact_mut(format.bytes()).zip(found) {
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

    fn run(
        &self,
        kernel: &Kernel,
        params: &[u8],
        inputs: &[&[f32]],
        outputs: &[usize],
    ) -> Result<Vec<Vec<f32>>> {
        match &self.backend {
            Backend::Gpu(gpu) => {
                let extent = [self.out_size.width, self.out_size.height];
                gpu.run_kernel(kernel, params, inputs, outputs, extent)
            }
            Backend::Cpu => {
                let mut results: Vec<Vec<f32>> = outputs.iter().map(|len| vec![0.0; *len]).collect();
                let mut slices: Vec<&mut [f32]> = results.iter_mut().map(Vec::as_mut_slice).collect();
                (kernel.reference)(params, inputs, &mut slices);
                Ok(results)
            }
        }
    }
}

/// Values of a plane with its rows' surplus.
fn values(size: Size) -> usize {
    size.stride() * size.height as usize
}

/// One channel of a picture, as the kernels take it.
fn plane(image: &Image, channel: usize) -> Vec<f32> {
    let (size, bytes) = (image.size, image.format.bytes());
    let value = |pixel: &[u8]| match (image.format, pixel) {
        (PixelFormat::Gray16, &[low, high]) => f32::from(u16::from_ne_bytes([low, high])),
        _ => f32::from(pixel[channel]),
    };
    let mut plane = Vec::with_capacity(values(size));
    for row in image.data.chunks_exact(size.width as usize * bytes) {
        plane.extend(row.chunks_exact(bytes).map(value));
        let last = plane[plane.len() - 1];
        plane.resize(plane.len().next_multiple_of(4), last);
    }
    plane
}
