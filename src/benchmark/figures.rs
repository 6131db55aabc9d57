//! The results of a benchmark of the flow.

use super::times::Times;

/// The figures of one backend at one frame size.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StreamFigures {
    /// The name of the GPU adapter, or of the CPU backend.
    pub backend: String,
    /// The frames' width in pixels.
    pub width: u32,
    /// The frames' height in pixels.
    pub height: u32,
    /// The number of frames timed.
    pub frames: u32,
    /// Costs paid once.
    pub startup: Startup,
    /// The time of a frame, upload and readback included.
    pub frame_ms: Times,
    /// The total size of the engine's buffers.
    pub buffer_bytes: u64,
    /// The throughput of a plain copy, bytes read plus bytes written, in 10⁹ bytes/s.
    pub copy_gb_s: f64,
    /// The clock behind the kernels' times: `gpu`, `host`, or `none` where the device has none.
    pub clock: &'static str,
    /// Each kernel's figures, in the order in which they first run; those that only an option uses come last. Empty where
    /// the device has no clock.
    pub kernels: Vec<KernelFigures>,
}

/// Costs paid once.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Startup {
    /// Creation of buffers, pipelines and bind groups.
    pub engine_ms: f64,
    /// The first frame, with the work that the driver defers until then.
    pub first_frame_ms: f64,
    /// The first pair: the second frame, likewise.
    pub first_pair_ms: f64,
}

/// The figures of one kernel: all of its steps in a frame, summed.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct KernelFigures {
    /// The kernel's name.
    pub kernel: &'static str,
    /// Whether only an option uses it: an initial flow, a certainty or the confidence.
    pub optional: bool,
    /// The number of its steps in a frame.
    pub steps: usize,
    /// Their summed time.
    pub ms: Times,
    /// The bytes that they must at least read and write.
    pub bytes: u64,
    /// The floating-point operations of their shaders, as [`FlopCounter`](crate::gpu::FlopCounter) counts them. `None` where
    /// they depend on more than the parameters.
    pub flops: Option<u64>,
    /// Their throughput in 10⁹ bytes/s.
    pub gb_s: f64,
    /// Their throughput as a share of that of a plain copy. Work that stays in a cache can exceed 1.
    pub share_of_copy: f64,
}
