//! Blocking wrappers of the asynchronous calls. Native only: in a browser no thread may wait, and devices poll
//! themselves.

use std::future::Future;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::pin;
use std::task::{Context, Poll, Waker};
use std::time::{Duration, Instant};

use wgpu::{Adapter, PollType};

use super::{Gpu, GpuOptions, adapter, executor};
use crate::error::Result;
use crate::kernel::Kernel;
use crate::kernels::compare::POISON;

/// The longest time for which one thread keeps others from polling.
const SLICE: Duration = Duration::from_millis(5);

/// Waits for a future that needs no polling of a device, such as that of an error scope.
pub(crate) fn block_on<F: Future>(future: F) -> F::Output {
    pollster::block_on(future)
}

/// All adapters of this machine. Native only: it blocks.
pub fn adapters() -> Vec<Adapter> {
    block_on(adapter::list())
}

impl Gpu {
    /// Opens a device. Native only: it blocks. [`Gpu::open`] is the asynchronous form.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub fn new(options: &GpuOptions) -> Result<Self> {
        block_on(Self::open(options))
    }

    /// Reopens a device like this one, after a loss. Native only: it blocks. [`Gpu::open_again`] is the asynchronous
    /// form.
    ///
    /// # Errors
    /// As [`Gpu::open_again`].
    pub fn reopen(&self) -> Result<Self> {
        block_on(self.open_again())
    }

    /// Waits until everything submitted is done. Native only: it blocks. [`Gpu::finished`] is the asynchronous form.
    ///
    /// # Errors
    /// [`Error::DeviceLost`](crate::Error::DeviceLost) if the device was lost.
    pub fn finish(&self) -> Result<()> {
        self.poll(PollType::wait_indefinitely()).map(|_| ())
    }

    /// Waits for a future and polls the device meanwhile.
    pub(crate) fn wait_for<T>(&self, future: impl Future<Output = Result<T>>) -> Result<T> {
        let mut future = pin!(future);
        let mut context = Context::from_waker(Waker::noop());
        loop {
            match future.as_mut().poll(&mut context) {
                Poll::Ready(result) => return result,
                Poll::Pending => self.finish()?,
            }
        }
    }

    /// Polls the device. Returns true if the awaited submission is done, or if no submission is left.
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

    fn poll_once(&self, kind: PollType) -> Result<bool> {
        // wgpu asserts that no other thread empties the queue while it polls: so one thread at a time, for a limited
        // time.
        let alone = self.polling.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        // It also panics if the driver reports a loss or is out of memory.
        let polled = catch_unwind(AssertUnwindSafe(|| self.device.poll(kind)));
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
    /// `inputs` are the kernel's input buffers, `outputs` the lengths of its outputs in `f32` values; columns and rows
    /// are the size of the computed image. For tests and comparisons. Native only: it blocks.
    ///
    /// # Errors
    /// [`Error::Kernel`](crate::Error::Kernel) if the shader does not fit the kernel,
    /// [`Error::DeviceLost`](crate::Error::DeviceLost) if the device was lost.
    pub fn run_kernel(
        &self,
        kernel: &Kernel,
        params: &[u8],
        inputs: &[&[f32]],
        outputs: &[usize],
        [columns, rows]: [u32; 2],
    ) -> Result<Vec<Vec<f32>>> {
        let poison: Vec<Vec<f32>> = outputs.iter().map(|len| vec![POISON; *len]).collect();
        self.wait_for(executor::run_alone(self, kernel, params, inputs, poison, [columns, rows]))
    }
}
