//! What wgpu would panic about, as errors.

use wgpu::ErrorFilter;

use super::Gpu;
use crate::error::{Error, Result};
use crate::plan::Plan;

impl Gpu {
    /// Makes what a plan needs on the device, and turns what wgpu would panic about into errors.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::DeviceLost`], or [`Error::Kernel`] for what wgpu's validation refuses; and what
    /// `make` returns.
    pub(crate) fn guarded<T>(&self, plan: &Plan, make: impl FnOnce() -> Result<T>) -> Result<T> {
        let memory = self.device.push_error_scope(ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(ErrorFilter::Validation);
        let made = make();
        let invalid = pollster::block_on(validation.pop());
        let full = pollster::block_on(memory.pop());
        let made = made?;
        if full.is_some() {
            let adapter = self.adapter().to_string();
            return Err(Error::OutOfMemory { adapter, size: plan.size, needed: plan.bytes() });
        }
        match invalid {
            Some(_) if self.lost().is_some() => Err(self.lost_error("")),
            Some(error) => {
                // The message runs over several lines; an error is one.
                let problem = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
                Err(Error::Kernel { kernel: "plan".to_owned(), problem })
            }
            None => Ok(made),
        }
    }
}
