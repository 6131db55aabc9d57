//! Compiled kernels: each one is compiled once for a device, with the constants of its tuning.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;
use wgpu::{ComputePipeline, ErrorFilter, PipelineCompilationOptions, ShaderSource};

use super::disk_cache::DiskCache;
use super::{Gpu, blocking, reflect};
use crate::error::{Error, Result};
use crate::kernel::{Kernel, Layout, Variant};

/// A kernel's pipeline, and the area that a workgroup covers.
#[derive(Clone)]
pub(super) struct Pipeline {
    pub(super) pipeline: ComputePipeline,
    pub(super) shape: reflect::DispatchShape,
}

/// The pipelines of a device, kept as long as the device.
pub(super) struct Pipelines {
    compiled: Mutex<HashMap<Key, Pipeline>>,
    disk: Option<DiskCache>,
}

/// A requested kernel.
type Wanted<'a> = (Key, &'a Kernel, &'static Variant);

/// The key of a pipeline. The kernel's name is not part of it: tests run mutated shaders under the kernel's name. The
/// Rust side is: a shader that fits one kernel may be refused for another.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Key {
    source: &'static str,
    params: Layout,
    inputs: &'static [&'static str],
    outputs: &'static [&'static str],
    /// The constants' names and the bits of their values.
    constants: Vec<(&'static str, u64)>,
}

impl Key {
    fn new(kernel: &Kernel, variant: &Variant) -> Self {
        let Kernel { source, params, inputs, outputs, .. } = *kernel;
        let constants = variant.constants.iter().map(|(name, value)| (*name, value.to_bits())).collect();
        Self { source, params, inputs, outputs, constants }
    }
}

impl Pipelines {
    pub(super) fn new(disk: Option<DiskCache>) -> Self {
        Self { compiled: Mutex::default(), disk }
    }

    pub(super) fn len(&self) -> usize {
        self.lock().len()
    }

    /// The pipelines of kernels, in the kernels' order. Missing ones are compiled.
    ///
    /// Two threads that request the same new kernel concurrently may both compile it; the first result is kept.
    ///
    /// # Errors
    /// [`Error::Kernel`] if a shader does not fit its kernel or does not compile, [`Error::DeviceLost`] if the device
    /// was lost.
    pub(super) async fn get(&self, gpu: &Gpu, kernels: &[&Kernel]) -> Result<Vec<Pipeline>> {
        let mut wanted = Vec::with_capacity(kernels.len());
        for &kernel in kernels {
            let variant = gpu.tuning.variant(gpu.name.class, kernel)?;
            wanted.push((Key::new(kernel, variant), kernel, variant));
        }
        let missing = self.missing(&wanted);
        // The lock is not held meanwhile: a rayon thread that waits for others takes other work, which may need the
        // lock.
        let new = self.compile_all(gpu, &missing).await?;
        if let Some(disk) = self.disk.as_ref().filter(|_| !missing.is_empty()) {
            disk.save();
        }
        let mut compiled = self.lock();
        for ((key, ..), pipeline) in missing.iter().zip(new) {
            compiled.entry(key.clone()).or_insert(pipeline);
        }
        Ok(wanted.iter().map(|(key, ..)| compiled[key].clone()).collect())
    }

    /// The kernels that are not compiled yet, each once.
    fn missing<'a>(&self, wanted: &'a [Wanted<'a>]) -> Vec<&'a Wanted<'a>> {
        let compiled = self.lock();
        let mut missing: Vec<&Wanted<'_>> = Vec::new();
        for new in wanted.iter().filter(|(key, ..)| !compiled.contains_key(key)) {
            if !missing.iter().any(|(key, ..)| *key == new.0) {
                missing.push(new);
            }
        }
        missing
    }

    /// Compiles kernels on all threads of rayon's pool; without threads, one after the other.
    async fn compile_all(&self, gpu: &Gpu, kernels: &[&Wanted<'_>]) -> Result<Vec<Pipeline>> {
        if !cfg!(target_arch = "wasm32") && kernels.len() > 1 {
            let compile =
                |(_, kernel, variant): &&Wanted<'_>| blocking::block_on(self.compile(gpu, kernel, variant));
            // The first kernel's error, not that of the fastest thread.
            return kernels.par_iter().map(compile).collect::<Vec<_>>().into_iter().collect();
        }
        let mut compiled = Vec::new();
        for (_, kernel, variant) in kernels {
            compiled.push(self.compile(gpu, kernel, variant).await?);
        }
        Ok(compiled)
    }

    async fn compile(&self, gpu: &Gpu, kernel: &Kernel, variant: &Variant) -> Result<Pipeline> {
        let shape = reflect::reflect_variant(kernel, variant)?;
        let (pipeline, error) = self.create(gpu, kernel, variant);
        let error = error.await;
        if gpu.lost().is_some() {
            return Err(gpu.lost_error(""));
        }
        match error {
            None => Ok(Pipeline { pipeline, shape }),
            Some(error) => {
                // The message runs over several lines; an error is one.
                let text = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
                let problem = format!("does not compile on {}: {text}", gpu.name);
                Err(Error::Kernel { kernel: kernel.name.to_owned(), problem })
            }
        }
    }

    /// Compiles a kernel on the device. The future returns wgpu's error, if there was one.
    fn create(
        &self,
        gpu: &Gpu,
        kernel: &Kernel,
        variant: &Variant,
    ) -> (ComputePipeline, impl Future<Output = Option<wgpu::Error>> + use<>) {
        // Each thread has its own error scopes, so the caller's do not apply here; and a failed pipeline must not be
        // kept.
        let filters = [ErrorFilter::OutOfMemory, ErrorFilter::Internal, ErrorFilter::Validation];
        let [memory, internal, validation] = filters.map(|filter| gpu.device.push_error_scope(filter));
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(kernel.name),
            source: ShaderSource::Wgsl(kernel.source.into()),
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(kernel.name),
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: PipelineCompilationOptions {
                constants: variant.constants,
                ..Default::default()
            },
            cache: self.disk.as_ref().map(DiskCache::cache),
        });
        let (validation, internal, memory) = (validation.pop(), internal.pop(), memory.pop());
        (pipeline, async { memory.await.or(internal.await).or(validation.await) })
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<Key, Pipeline>> {
        self.compiled.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
