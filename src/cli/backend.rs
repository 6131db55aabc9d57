//! The choice of a backend, and the note that names it.

use clap::{Args, ValueEnum};

use super::{cache, print};
use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::gpu::{Gpu, GpuOptions};

/// The flags that choose a backend.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Backend")]
pub(super) struct BackendArgs {
    /// Where to compute [default: a real GPU if there is one, else the CPU]. The choice is named on standard error, unless
    /// a command's --quiet is given. `gpu` takes any adapter, including software ones such as lavapipe
    #[arg(long, value_enum)]
    pub(super) backend: Option<BackendArg>,
    /// Part of the name of the GPU adapter to use (see `viewsphere devices`)
    #[arg(long, value_name = "NAME")]
    pub(super) adapter: Option<String>,
}

/// The two backends.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BackendArg {
    /// wgpu: Vulkan, Metal or Direct3D 12
    Gpu,
    /// All CPU cores
    Cpu,
}

impl BackendArgs {
    /// Opens the backend and names it on standard error, unless `quiet`.
    pub(super) fn open(&self, quiet: bool) -> Result<Backend> {
        self.open_with(&options(), quiet)
    }

    /// The same, but an adapter that computes on the CPU comes before the CPU backend: where seeing the shaders run
    /// counts for more than speed. Says nothing if `quiet`.
    pub(super) fn open_for_shaders(&self, quiet: bool) -> Result<Backend> {
        self.open_with(&GpuOptions { allow_software: true, ..options() }, quiet)
    }

    /// Whether nothing to compute on was named.
    pub(super) fn is_free(&self) -> bool {
        self.backend.is_none() && self.adapter.is_none()
    }

    /// Opens two backends of the same kind on separate devices, so that the loss of one device does not affect the
    /// other.
    pub(super) fn open_pair(&self, quiet: bool) -> Result<[Backend; 2]> {
        let first = self.open(quiet)?;
        let second = self.open_like(&first)?;
        Ok([first, second])
    }

    /// Opens another backend of the same kind as `opened`, on a device of its own. Silent.
    pub(super) fn open_like(&self, opened: &Backend) -> Result<Backend> {
        match (opened, self.backend, &self.adapter) {
            (Backend::Cpu, ..) => Ok(Backend::Cpu),
            (Backend::Gpu(_), None, None) => Gpu::new(&options()).map(Backend::Gpu),
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

    /// Opens every backend: a GPU, where there is one, and then the CPU; or only the one that the flags name.
    pub(super) fn open_all(&self) -> Result<Vec<Backend>> {
        if self.backend.is_some() {
            return Ok(vec![self.named()?]);
        }
        if self.adapter.is_some() {
            return Ok(vec![self.named()?, Backend::Cpu]);
        }
        match Gpu::new(&options()) {
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

    /// Checks that `--backend` and `--adapter` agree, without opening anything.
    pub(super) fn check(&self) -> Result<()> {
        match (self.backend, &self.adapter) {
            (Some(BackendArg::Cpu), Some(adapter)) => {
                Err(Error::parameter("--adapter", adapter, "none beside --backend cpu"))
            }
            _ => Ok(()),
        }
    }

    /// Opens the named adapter, or the best one, software adapters included.
    pub(super) fn gpu(&self) -> Result<Gpu> {
        Gpu::new(&GpuOptions { adapter: self.adapter.clone(), allow_software: true, ..options() })
    }
}

/// The options for the best real GPU, with the user's cache of compiled kernels.
pub(super) fn options() -> GpuOptions {
    GpuOptions { pipeline_cache: cache::folder(), ..GpuOptions::default() }
}
