//! The speed of plain copies in memory: the upper bound of a kernel's throughput.

use rayon::prelude::*;

use super::times::timed;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::quantile::median;

const ROUNDS: usize = 9;
/// Bytes copied per round: enough that the copy takes much longer than its launch.
const ROUND: usize = 64 << 20;
/// Values per chunk; each thread copies one chunk at a time.
const CHUNK: usize = 1 << 16;

/// The throughput of copies between two GPU buffers of `len` values each, bytes read plus bytes written, in GB/s.
pub(super) fn gpu(gpu: &Gpu, len: usize) -> Result<f64> {
    let size = 4 * len as u64;
    let buffer = |label| {
        gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    let (from, to) = (buffer("copied"), buffer("copy"));
    let copies = copies(len);
    let mut times = Vec::new();
    for _ in 0..ROUNDS {
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for _ in 0..copies {
            encoder.copy_buffer_to_buffer(&from, 0, &to, 0, size);
        }
        let commands = encoder.finish();
        let (done, ms) = timed(|| {
            gpu.queue().submit([commands]);
            gpu.finish()
        });
        done?;
        times.push(ms);
    }
    Ok(rate(len, copies, times))
}

/// The throughput of copies between two slices of `len` values in main memory, on all threads, in GB/s.
pub(super) fn cpu(len: usize) -> f64 {
    let (from, mut to) = (vec![1.0_f32; len], vec![0.0_f32; len]);
    let copies = copies(len);
    let times = (0..ROUNDS).map(|_| {
        let copy = || {
            for _ in 0..copies {
                to.par_chunks_mut(CHUNK)
                    .zip(from.par_chunks(CHUNK))
                    .for_each(|(to, from)| to.copy_from_slice(from));
                std::hint::black_box(&mut to);
            }
        };
        timed(copy).1
    });
    rate(len, copies, times.collect())
}

fn copies(len: usize) -> usize {
    ROUND.div_ceil(4 * len)
}

/// From the median round.
fn rate(len: usize, copies: usize, ms: Vec<f64>) -> f64 {
    (2 * 4 * len * copies) as f64 / median(ms).unwrap_or(f64::NAN) / 1e6
}
