//! Adapters: finding, choosing and describing them.

use std::fmt;
use std::path::PathBuf;

use wgpu::{Adapter, AdapterInfo, Backends, DeviceType, Instance};

use super::tuning::{AdapterClass, Tuning};
use crate::error::{Error, Result};

/// The choice of an adapter, and its options.
#[derive(Clone, Debug, Default)]
pub struct GpuOptions {
    /// Part of the adapter's name, upper or lower case; `None` for the best adapter there is.
    pub adapter: Option<String>,
    /// Whether an adapter that computes on the CPU, such as lavapipe, may be taken without being named.
    ///
    /// Off by default: such an adapter is slower than the CPU executor.
    pub allow_software: bool,
    /// A folder that keeps the driver's compiled code from one process to the next, if the adapter supports it
    /// (`Features::PIPELINE_CACHE`); it is created when it is needed. `None`, the default, writes nothing. Native only.
    ///
    /// It must be a folder that only the user can write to: drivers trust what they have compiled. A file in it that is
    /// damaged or belongs to another driver is replaced. A folder that cannot be written to is no error.
    pub pipeline_cache: Option<PathBuf>,
    /// The variant of each kernel that the adapter runs: by default each kernel's first.
    pub tuning: Tuning,
}

/// The description of an adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterName {
    /// The device's name, as its driver reports it.
    pub name: String,
    /// The driver's name and version.
    pub driver: String,
    /// The graphics API, for example `Vulkan`.
    pub backend: String,
    /// Whether it computes on the CPU.
    pub software: bool,
    /// The class for which its kernels are tuned.
    pub class: AdapterClass,
}

impl AdapterName {
    pub(crate) fn new(info: &AdapterInfo) -> Self {
        let driver = format!("{} {}", info.driver, info.driver_info);
        Self {
            name: info.name.clone(),
            driver: driver.trim().to_owned(),
            backend: format!("{:?}", info.backend),
            software: info.device_type == DeviceType::Cpu,
            class: AdapterClass::of(info),
        }
    }
}

impl fmt::Display for AdapterName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.software { ", computes on the CPU" } else { "" };
        write!(f, "{} ({}, {}{kind})", self.name, self.backend, self.driver)
    }
}

/// All adapters of this machine.
pub(super) async fn list() -> Vec<Adapter> {
    instance().enumerate_adapters(Backends::all()).await
}

fn instance() -> Instance {
    Instance::new(wgpu::InstanceDescriptor {
        backends: Backends::all(),
        // Validation layers are for development of this crate, and are not installed everywhere.
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

/// Chooses an adapter: the named one, or one of the fastest kind there is.
///
/// # Errors
/// [`Error::NoAdapter`], which lists the adapters found and says what to do.
pub(super) async fn choose(options: &GpuOptions) -> Result<Adapter> {
    let mut found = list().await;
    let names: Vec<String> =
        found.iter().map(|adapter| AdapterName::new(&adapter.get_info()).to_string()).collect();
    let fail = |reason: String| Err(Error::NoAdapter { reason });
    if found.is_empty() {
        return fail(
            "no Vulkan driver answers; install the GPU's driver, or lavapipe to compute on the CPU \
             (Debian: apt-get install mesa-vulkan-drivers libvulkan1)"
                .to_owned(),
        );
    }
    if let Some(wanted) = &options.adapter {
        if wanted.trim().is_empty() {
            return Err(Error::parameter("adapter", "empty", "part of an adapter's name"));
        }
        let wanted_lower = wanted.to_lowercase();
        return match names.iter().position(|name| name.to_lowercase().contains(&wanted_lower)) {
            Some(i) => Ok(found.swap_remove(i)),
            None => fail(format!("none is called {wanted}; there are: {}", names.join("; "))),
        };
    }
    let rank = |adapter: &Adapter| match adapter.get_info().device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    };
    found.sort_by_key(rank);
    let best = found.swap_remove(0);
    if rank(&best) == 4 && !options.allow_software {
        return fail(format!(
            "only adapters that compute on the CPU are there ({}); name one to use it",
            names.join("; ")
        ));
    }
    Ok(best)
}
