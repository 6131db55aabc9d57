//! Turns wgpu's panics into errors.

use wgpu::ErrorFilter;

use super::Gpu;
use crate::error::{Error, Result};
use crate::plan::Plan;

impl Gpu {
    /// Runs `make`, which creates a plan's resources on the device, and turns wgpu's panics into errors.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::DeviceLost`], or [`Error::Kernel`] if wgpu's validation refuses something; and
    /// the errors of `make`.
    pub(crate) fn guarded<T>(&self, plan: &Plan, make: impl FnOnce() -> Result<T>) -> Result<T> {
        let memory = self.device.push_error_scope(ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(ErrorFilter::Validation);
        let made = make();
        let invalid = super::block_on(validation.pop());
        let full = super::block_on(memory.pop());
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
