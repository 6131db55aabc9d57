//! What a plan is computed on.

use crate::gpu::Gpu;

/// What a plan is computed on.
#[derive(Clone)]
pub enum Backend {
    /// A GPU.
    Gpu(Gpu),
    /// The CPU, on the threads of rayon's pool.
    Cpu,
}

impl Backend {
    /// The adapter's name, or `cpu`: unlike [`Engine::adapter`](crate::Engine::adapter) the same for any number of cores,
    /// which do not change the results.
    pub fn name(&self) -> String {
        match self {
            Self::Gpu(gpu) => gpu.adapter().to_string(),
            Self::Cpu => "cpu".to_owned(),
        }
    }
}
