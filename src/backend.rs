//! The device that computes a plan.

use crate::gpu::Gpu;

/// The device that computes a plan.
#[derive(Clone)]
#[allow(clippy::large_enum_variant, reason = "few are made, and each lives as long as an engine")]
pub enum Backend {
    /// A GPU.
    Gpu(Gpu),
    /// The CPU, on the threads of rayon's pool.
    Cpu,
}

impl Backend {
    /// The adapter's name, or `cpu`. Unlike [`Engine::adapter`](crate::Engine::adapter) it does not name the number of
    /// threads, which does not change the results.
    pub fn name(&self) -> String {
        match self {
            Self::Gpu(gpu) => gpu.adapter().to_string(),
            Self::Cpu => "cpu".to_owned(),
        }
    }
}
