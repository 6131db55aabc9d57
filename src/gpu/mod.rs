//! The GPU executor: adapter, device, pipelines, and a plan's buffers on the device.

mod adapter;
mod executor;
mod guard;
mod reflect;

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

pub use adapter::{AdapterName, GpuOptions, adapters};
pub use executor::GpuExecutor;
pub use reflect::{Shape, reflect};
use wgpu::{Device, Features, Limits, PollType, Queue};

use crate::error::{Error, Result};
use crate::kernel::Kernel;
use crate::kernels::compare::POISON;

/// How long one thread keeps others from polling.
const SLICE: Duration = Duration::from_millis(5);

/// A device to compute on.
///
/// Cloning it is cheap and gives the same device.
#[derive(Clone)]
pub struct Gpu {
    pub(crate) device: Device,
    pub(crate) queue: Queue,
    name: AdapterName,
    lost: Arc<Mutex<Option<String>>>,
    polling: Arc<Mutex<()>>,
    /// How the device can be had again, if it is this crate's.
    options: Option<GpuOptions>,
}

impl Gpu {
    /// Opens a device.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] if none fits the options or the driver refuses, with the reason and what to do.
    pub fn new(options: &GpuOptions) -> Result<Self> {
        let adapter = adapter::choose(options)?;
        let name = AdapterName::new(&adapter.get_info());
        let wanted = Features::TIMESTAMP_QUERY | Features::TIMESTAMP_QUERY_INSIDE_PASSES;
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
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| Error::NoAdapter { reason: format!("{name} refuses a device: {error}") })?;
        let mut gpu = Self::with_name(device, queue, name);
        gpu.options = Some(options.clone());
        Ok(gpu)
    }

    /// Uses the caller's device. It is never rebuilt by this crate.
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
        Self { device, queue, name, lost, polling: Arc::default(), options: None }
    }

    /// Opens a device like this one anew, after a loss.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] if the device was the caller's, else as [`Gpu::new`].
    pub fn reopen(&self) -> Result<Self> {
        match &self.options {
            Some(options) => Self::new(options),
            None => Err(self.lost_error("the device belongs to the caller")),
        }
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

    /// The device, for callers who share it.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Its queue, for callers who share it.
    pub fn queue(&self) -> &Queue {
        &self.queue
    }

    /// Why the device is gone, if it is.
    pub fn lost(&self) -> Option<String> {
        self.lost.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).clone()
    }

    pub(crate) fn lost_error(&self, reason: impl Into<String>) -> Error {
        let reason = self.lost().unwrap_or_else(|| reason.into());
        Error::DeviceLost { adapter: self.name.to_string(), reason }
    }

    /// Waits until everything submitted is done.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] if the device was lost.
    pub fn finish(&self) -> Result<()> {
        self.poll(PollType::wait_indefinitely()).map(|_| ())
    }

    /// Polls the device. True if what was waited for is done, or if nothing submitted is left to do.
    pub(crate) fn poll(&self, kind: PollType) -> Result<bool> {
        let PollType::Wait { submission_index, timeout } = kind else {
            return self.poll_once(kind);
        };
        let deadline = timeout.map(|timeout| Instant::now() + timeout);
        loop {
            let left = deadline.map_or(SLICE, |deadline| deadline.saturating_duration_since(Instant::now()));
            let slice =
                PollType::Wait { submission_index: submission_index.clone(), timeout: Some(left.min(SLICE)) };
            if self.poll_once(slice)? {
                return Ok(true);
            }
            if left.is_zero() {
                return Ok(false);
            }
        }
    }

    /// Submits what was recorded.
    pub(crate) fn submit(&self, encoder: wgpu::CommandEncoder) -> wgpu::SubmissionIndex {
        let commands = encoder.finish();
        // A submission looks after finished mappings, as polling does.
        let _alone = self.polling.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        self.queue.submit([commands])
    }

    fn poll_once(&self, kind: PollType) -> Result<bool> {
        // wgpu asserts that nobody else empties the queue while it polls: one thread at a time, for a slice of time.
        let alone = self.polling.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        // It also panics where the driver reports a loss or is out of memory.
        let polled = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| self.device.poll(kind)));
        drop(alone);
        match polled {
            Ok(Ok(status)) => match self.lost() {
                Some(_) => Err(self.lost_error("")),
                None => Ok(status.wait_finished()),
            },
            Ok(Err(wgpu::PollError::Timeout)) => Ok(false),
            Ok(Err(error)) => Err(self.lost_error(error.to_string())),
            Err(_) => Err(self.lost_error("the driver failed while it was waited for")),
        }
    }

    /// Runs a kernel once, alone, on fresh buffers whose outputs are filled with [`POISON`].
    ///
    /// `inputs` are the kernel's, `outputs` the lengths of its results, and columns and rows what is computed. For tests
    /// and comparisons.
    ///
    /// # Errors
    /// [`Error::Kernel`] if the shader does not fit the kernel, [`Error::DeviceLost`] if the device was lost.
    pub fn run_kernel(
        &self,
        kernel: &Kernel,
        params: &[u8],
        inputs: &[&[f32]],
        outputs: &[usize],
        [columns, rows]: [u32; 2],
    ) -> Result<Vec<Vec<f32>>> {
        let poison: Vec<Vec<f32>> = outputs.iter().map(|len| vec![POISON; *len]).collect();
        executor::run_alone(self, kernel, params, inputs, poison, [columns, rows])
    }
}
