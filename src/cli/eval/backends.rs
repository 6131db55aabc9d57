//! The backends to run on.

use clap::Args;

use crate::backend::Backend;
use crate::cli::backend::{BackendArg, BackendArgs};
use crate::error::Result;

/// The flags that choose backends.
#[derive(Args, Debug)]
#[command(next_help_heading = "Backend")]
pub(super) struct BackendList {
    /// Where to compute: gpu, cpu or both [default: a real GPU if there is one, else the CPU]. `gpu` takes any adapter,
    /// including software ones such as lavapipe
    #[arg(long, value_enum, value_name = "BACKEND,...", value_delimiter = ',')]
    backend: Vec<BackendArg>,
    /// Part of the name of the GPU adapter to use (see `viewsphere devices`)
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

/// An opened backend.
pub(super) struct Opened {
    pub(super) backend: Backend,
    args: BackendArgs,
}

impl BackendList {
    /// Opens all of them, each once, and names them on standard error unless `quiet`.
    pub(super) fn open(&self, quiet: bool) -> Result<Vec<Opened>> {
        let mut kinds: Vec<BackendArg> = Vec::new();
        for kind in &self.backend {
            if !kinds.contains(kind) {
                kinds.push(*kind);
            }
        }
        let args = |backend: Option<BackendArg>| {
            let adapter =
                self.adapter.clone().filter(|_| kinds.len() < 2 || backend == Some(BackendArg::Gpu));
            BackendArgs { backend, adapter }
        };
        let mut all: Vec<BackendArgs> = kinds.iter().map(|kind| args(Some(*kind))).collect();
        if all.is_empty() {
            all.push(args(None));
        }
        all.into_iter().map(|args| Ok(Opened { backend: args.open(quiet)?, args })).collect()
    }
}

impl Opened {
    /// `cpu` or `gpu`.
    pub(super) fn kind(&self) -> &'static str {
        match self.backend {
            Backend::Cpu => "cpu",
            Backend::Gpu(_) => "gpu",
        }
    }

    /// Opens a GPU again after an error, as the device may be lost. If that fails, the next use will tell.
    pub(super) fn renew(&mut self) {
        if let Ok(backend) = self.args.open_like(&self.backend) {
            self.backend = backend;
        }
    }
}
