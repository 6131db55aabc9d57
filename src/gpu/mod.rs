//! The GPU executor: adapter, device, pipelines, and a plan's buffers on the device.
//!
//! Slow calls are asynchronous: [`Gpu::open`], [`Gpu::finished`], [`GpuExecutor::open`]. The blocking calls
//! ([`Gpu::new`], [`Gpu::finish`], [`GpuExecutor::new`]) are thin wrappers of these, and native only, because in a
//! browser no thread may wait. The pipelines on disk ([`GpuOptions::pipeline_cache`]) and compilation on several
//! threads are native only, too.

mod adapter;
mod blocking;
mod disk_cache;
mod executor;
mod finished;
mod flops;
mod guard;
mod pipelines;
mod reflect;
mod tuning;

use std::sync::{Arc, Mutex};

pub use adapter::{AdapterName, GpuOptions};
pub use blocking::adapters;
pub(crate) use blocking::block_on;
use disk_cache::DiskCache;
pub use executor::GpuExecutor;
pub use finished::Finished;
pub use flops::FlopCounter;
use pipelines::Pipelines;
pub use reflect::{DispatchShape, reflect, reflect_variant};
pub use tuning::{AdapterClass, Tuning};
use wgpu::{Device, Features, Limits, Queue};

use crate::error::{Error, Result};

/// A GPU device, and the kernels that are compiled for it.
///
/// Cloning it is cheap and gives the same device with the same kernels.
#[derive(Clone)]
pub struct Gpu {
    pub(crate) device: Device,
    pub(crate) queue: Queue,
    name: AdapterName,
    tuning: Arc<Tuning>,
    pipelines: Arc<Pipelines>,
    lost: Arc<Mutex<Option<String>>>,
    polling: Arc<Mutex<()>>,
    /// How the device can be reopened, if it is this crate's.
    options: Option<GpuOptions>,
}

impl Gpu {
    /// Opens a device.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] if no adapter fits the options or the driver refuses, with the reason and what to do.
    pub async fn open(options: &GpuOptions) -> Result<Self> {
        let adapter = adapter::choose(options).await?;
        let name = AdapterName::new(&adapter.get_info());
        let mut wanted = Features::TIMESTAMP_QUERY | Features::TIMESTAMP_QUERY_INSIDE_PASSES;
        wanted.set(Features::PIPELINE_CACHE, options.pipeline_cache.is_some());
        let limits = adapter.limits();
        let storage_buffers = limits.max_storage_buffers_per_shader_stage;
        if storage_buffers < reflect::MAX_STORAGE_BUFFERS as u32 {
            let expected = reflect::MAX_STORAGE_BUFFERS;
            let reason =
                format!("{name} allows {storage_buffers} storage buffers a stage, {expected} are needed");
            return Err(Error::NoAdapter { reason });
        }
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("viewsphere"),
            required_features: adapter.features() & wanted,
            required_limits: Limits {
                max_buffer_size: limits.max_buffer_size,
                max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
                ..Limits::default().or_worse_values_from(&limits)
            },
            ..Default::default()
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|error| Error::NoAdapter { reason: format!("{name} refuses a device: {error}") })?;
        let disk = options.pipeline_cache.as_ref().and_then(|folder| DiskCache::open(&device, folder));
        let mut gpu = Self::with_name(device, queue, name);
        gpu.pipelines = Arc::new(Pipelines::new(disk));
        gpu.tuning = Arc::new(options.tuning.clone());
        gpu.options = Some(options.clone());
        Ok(gpu)
    }

    /// Uses the caller's device. This crate never reopens it.
    pub fn from_device(device: Device, queue: Queue) -> Self {
        let name = AdapterName::new(&device.adapter_info());
        Self::with_name(device, queue, name)
    }

    fn with_name(device: Device, queue: Queue, name: AdapterName) -> Self {
        let lost = Arc::new(Mutex::new(None));
        let note = lost.clone();
        device.set_device_lost_callback(move |reason, message| {
            let text =
                if message.is_empty() { format!("{reason:?}") } else { format!("{reason:?}: {message}") };
            *note.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(text);
        });
        let pipelines = Arc::new(Pipelines::new(None));
        Self {
            device,
            queue,
            name,
            tuning: Arc::default(),
            pipelines,
            lost,
            polling: Arc::default(),
            options: None,
        }
    }

    /// The same device with another tuning. Kernels that are already compiled are not compiled again.
    #[must_use]
    pub fn with_tuning(&self, tuning: Tuning) -> Self {
        Self { tuning: Arc::new(tuning), ..self.clone() }
    }

    /// The tuning in use.
    pub fn tuning(&self) -> &Tuning {
        &self.tuning
    }

    /// The number of pipelines that this device keeps: one per kernel and set of constants that was used.
    pub fn pipelines(&self) -> usize {
        self.pipelines.len()
    }

    /// Reopens a device like this one, after a loss.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] if the device was the caller's, else as [`Gpu::open`].
    pub async fn open_again(&self) -> Result<Self> {
        let Some(options) = &self.options else {
            return Err(self.lost_error("the device belongs to the caller"));
        };
        let opened = Self::open(options).await?;
        Ok(Self { tuning: self.tuning.clone(), ..opened })
    }

    /// The adapter in use.
    pub fn adapter(&self) -> &AdapterName {
        &self.name
    }

    /// The device's limits.
    pub fn limits(&self) -> Limits {
        self.device.limits()
    }

    /// The features in use.
    pub fn features(&self) -> Features {
        self.device.features()
    }

    /// The device, for callers that share it.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Its queue, for callers that share it.
    pub fn queue(&self) -> &Queue {
        &self.queue
    }

    /// The reason of the device's loss; `None` if it is not lost.
    pub fn lost(&self) -> Option<String> {
        self.lost.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).clone()
    }

    pub(crate) fn lost_error(&self, reason: impl Into<String>) -> Error {
        let reason = self.lost().unwrap_or_else(|| reason.into());
        Error::DeviceLost { adapter: self.name.to_string(), reason }
    }

    /// A future that is ready when everything submitted so far is done.
    ///
    /// In a browser it becomes ready by itself; elsewhere something must poll the device, as [`Gpu::finish`] and the
    /// engine do. Its error is [`Error::DeviceLost`], if the device was lost.
    pub fn finished(&self) -> Finished {
        Finished::new(self)
    }

    /// Submits recorded commands.
    pub(crate) fn submit(&self, encoder: wgpu::CommandEncoder) -> wgpu::SubmissionIndex {
        let commands = encoder.finish();
        // A submission handles finished mappings, as polling does.
        let _alone = self.polling.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        self.queue.submit([commands])
    }
}
