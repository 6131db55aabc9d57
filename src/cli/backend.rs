//! What to compute on, and saying so.

use clap::{Args, ValueEnum};

use super::print;
use crate::error::{Error, Result};
use crate::gpu::{Gpu, GpuOptions};

/// What to compute on.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Backend")]
pub(super) struct BackendArgs {
    /// What to compute on. Without it: a real GPU if there is one, else the CPU; which one is said on stderr. `gpu`
    /// takes any adapter, also one that computes on the CPU such as lavapipe
    #[arg(long, value_enum)]
    pub(super) backend: Option<BackendArg>,
    /// Part of the name of the GPU adapter to use (see `viewsphere devices`)
    #[arg(long, value_name = "NAME")]
    pub(super) adapter: Option<String>,
}

/// The two executors.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BackendArg {
    /// wgpu
    Gpu,
    /// All cores
    Cpu,
}

impl BackendArgs {
    /// The device to compute on, or none for the CPU. Says on stderr which one it is.
    pub(super) fn open(&self) -> Result<Option<Gpu>> {
        let gpu = self.find()?;
        match &gpu {
            Some(gpu) => print::note(format_args!("computing on {}", gpu.adapter())),
            None if self.backend.is_some() => print::note("computing on the CPU"),
            None => {}
        }
        Ok(gpu)
    }

    fn find(&self) -> Result<Option<Gpu>> {
        match (self.backend, &self.adapter) {
            (Some(BackendArg::Cpu), None) => Ok(None),
            (Some(BackendArg::Cpu), Some(adapter)) => {
                Err(Error::parameter("--adapter", adapter, "none beside --backend cpu"))
            }
            (None, None) => match Gpu::new(&GpuOptions::default()) {
                Ok(gpu) => Ok(Some(gpu)),
                Err(Error::NoAdapter { reason }) => {
                    print::note(format_args!("computing on the CPU: no usable GPU adapter: {reason}"));
                    Ok(None)
                }
                Err(error) => Err(error),
            },
            _ => self.gpu().map(Some),
        }
    }

    /// The adapter that is named, or any: for those who asked for a GPU.
    pub(super) fn gpu(&self) -> Result<Gpu> {
        Gpu::new(&GpuOptions { adapter: self.adapter.clone(), allow_software: true })
    }
}
