//! What to compute on, and saying so.

use clap::{Args, ValueEnum};

use super::print;
use crate::engine::Backend;
use crate::error::{Error, Result};
use crate::gpu::{Gpu, GpuOptions};

/// What to compute on.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Backend")]
pub(super) struct BackendArgs {
    /// What to compute on. Without it: a real GPU if there is one, else the CPU; which one is said on stderr, but for
    /// --quiet. `gpu` takes any adapter, also one that computes on the CPU such as lavapipe
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
    /// What to compute on. Says on stderr which it is.
    pub(super) fn open(&self) -> Result<Backend> {
        self.open_unless(false)
    }

    /// The same, and says nothing if `quiet`.
    pub(super) fn open_unless(&self, quiet: bool) -> Result<Backend> {
        self.open_with(&GpuOptions::default(), quiet)
    }

    /// The same, but an adapter that computes on the CPU comes before the CPU backend: where seeing the shaders run
    /// counts for more than speed. Says nothing if `quiet`.
    pub(super) fn open_for_shaders(&self, quiet: bool) -> Result<Backend> {
        self.open_with(&GpuOptions { allow_software: true, ..GpuOptions::default() }, quiet)
    }

    /// Whether nothing to compute on was named.
    pub(super) fn is_free(&self) -> bool {
        self.backend.is_none() && self.adapter.is_none()
    }

    /// Two of the same kind, on devices of their own: what happens to one does not happen to the other.
    pub(super) fn open_pair(&self, quiet: bool) -> Result<[Backend; 2]> {
        let first = self.open_unless(quiet)?;
        let second = self.open_like(&first)?;
        Ok([first, second])
    }

    /// Another one of the kind that was opened, on a device of its own. Says nothing.
    pub(super) fn open_like(&self, opened: &Backend) -> Result<Backend> {
        match (opened, self.backend, &self.adapter) {
            (Backend::Cpu, ..) => Ok(Backend::Cpu),
            (Backend::Gpu(_), None, None) => Gpu::new(&GpuOptions::default()).map(Backend::Gpu),
            (Backend::Gpu(_), ..) => self.gpu().map(Backend::Gpu),
        }
    }

    fn open_with(&self, default: &GpuOptions, quiet: bool) -> Result<Backend> {
        let say = |text: std::fmt::Arguments<'_>| {
            if !quiet {
                print::note(text);
            }
        };
        let backend = match (self.backend, &self.adapter) {
            (None, None) => match Gpu::new(default) {
                Ok(gpu) => Backend::Gpu(gpu),
                Err(Error::NoAdapter { reason }) => {
                    say(format_args!("computing on the CPU; no usable GPU adapter: {reason}"));
                    return Ok(Backend::Cpu);
                }
                Err(error) => return Err(error),
            },
            _ => self.named()?,
        };
        match &backend {
            Backend::Gpu(gpu) => say(format_args!("computing on {}", gpu.adapter())),
            Backend::Cpu => say(format_args!("computing on the CPU")),
        }
        Ok(backend)
    }

    /// All that can be computed on: the CPU, and before it a GPU where there is one, unless one of them is named.
    pub(super) fn open_all(&self) -> Result<Vec<Backend>> {
        if self.backend.is_some() {
            return Ok(vec![self.named()?]);
        }
        if self.adapter.is_some() {
            return Ok(vec![self.named()?, Backend::Cpu]);
        }
        match Gpu::new(&GpuOptions::default()) {
            Ok(gpu) => Ok(vec![Backend::Gpu(gpu), Backend::Cpu]),
            Err(Error::NoAdapter { reason }) => {
                print::note(format_args!("only the CPU; no usable GPU adapter: {reason}"));
                Ok(vec![Backend::Cpu])
            }
            Err(error) => Err(error),
        }
    }

    fn named(&self) -> Result<Backend> {
        self.check()?;
        match self.backend {
            Some(BackendArg::Cpu) => Ok(Backend::Cpu),
            _ => Ok(Backend::Gpu(self.gpu()?)),
        }
    }

    /// Checks that the two agree: for those who may have nothing to compute on what they name.
    pub(super) fn check(&self) -> Result<()> {
        match (self.backend, &self.adapter) {
            (Some(BackendArg::Cpu), Some(adapter)) => {
                Err(Error::parameter("--adapter", adapter, "none beside --backend cpu"))
            }
            _ => Ok(()),
        }
    }

    /// The adapter that is named, or any: for those who asked for a GPU.
    pub(super) fn gpu(&self) -> Result<Gpu> {
        Gpu::new(&GpuOptions { adapter: self.adapter.clone(), allow_software: true })
    }
}
