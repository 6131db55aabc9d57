//! `viewsphere devices`: the available GPU adapters and the CPU.

use clap::Args;
use serde::Serialize;
use wgpu::Features;

use super::{Outcome, print};
use crate::error::Result;
use crate::gpu::{AdapterName, Gpu, GpuOptions, adapters};

/// List the GPU adapters and whether they are usable.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  viewsphere devices
  viewsphere devices --json
  viewsphere flow a.png b.png --adapter llvmpipe     use one by a part of its name")]
pub(super) struct Devices {
    /// Print the list as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct List {
    /// The backend used when none is named.
    default: String,
    adapters: Vec<Device>,
    cpu_threads: usize,
}

#[derive(Serialize)]
struct Device {
    name: String,
    #[serde(rename = "type")]
    kind: String,
    class: String,
    backend: String,
    driver: String,
    max_buffer_bytes: u64,
    max_storage_binding_bytes: u64,
    max_storage_buffers_a_stage: u32,
    max_invocations: u32,
    max_workgroup_size: [u32; 3],
    timestamps: bool,
    usable: bool,
    why_not: Option<String>,
}

impl Devices {
    pub(super) fn run(&self) -> Result<Outcome> {
        let default = match Gpu::new(&GpuOptions::default()) {
            Ok(gpu) => gpu.adapter().to_string(),
            Err(error) => format!("the CPU; {error}"),
        };
        let cpu_threads = rayon::current_num_threads();
        let list = List { default, adapters: adapters().iter().map(Device::new).collect(), cpu_threads };
        if self.json {
            print::json(&list)?;
        } else {
            print::text(&list.text())?;
        }
        Ok(Outcome::Done)
    }
}

impl Device {
    fn new(adapter: &wgpu::Adapter) -> Self {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        // Only a request shows whether the adapter provides a usable device.
        let adapter_name = AdapterName::new(&info);
        let class = adapter_name.class;
        let named = GpuOptions {
            adapter: Some(adapter_name.to_string()),
            allow_software: true,
            ..GpuOptions::default()
        };
        let why_not = Gpu::new(&named).err().map(|error| error.to_string());
        Self {
            class: class.to_string(),
            kind: format!("{:?}", info.device_type),
            backend: format!("{:?}", info.backend),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            name: info.name,
            max_buffer_bytes: limits.max_buffer_size,
            max_storage_binding_bytes: limits.max_storage_buffer_binding_size,
            max_storage_buffers_a_stage: limits.max_storage_buffers_per_shader_stage,
            max_invocations: limits.max_compute_invocations_per_workgroup,
            max_workgroup_size: [
                limits.max_compute_workgroup_size_x,
                limits.max_compute_workgroup_size_y,
                limits.max_compute_workgroup_size_z,
            ],
            timestamps: adapter.features().contains(Features::TIMESTAMP_QUERY),
            usable: why_not.is_none(),
            why_not,
        }
    }

    fn text(&self) -> String {
        let mib = |bytes: u64| bytes >> 20;
        let [x, y, z] = self.max_workgroup_size;
        format!(
            "{}\n  type         {}\n  class        {}\n  backend      {}\n  driver       {}\n  usable       {}\n  buffers      \
             {} MiB at most, {} MiB bound, {} per stage\n  workgroups   {} invocations, {x}×{y}×{z}\n  timestamps   {}\n",
            self.name,
            if self.kind == "Cpu" {
                "software: computes on the CPU, taken only when asked for"
            } else {
                &self.kind
            },
            self.class,
            self.backend,
            self.driver,
            self.why_not.as_ref().map_or("yes".to_owned(), |reason| format!("no: {reason}")),
            mib(self.max_buffer_bytes),
            mib(self.max_storage_binding_bytes),
            self.max_storage_buffers_a_stage,
            self.max_invocations,
            if self.timestamps { "yes" } else { "no" },
        )
    }
}

impl List {
    fn text(&self) -> String {
        let mut text: String = self.adapters.iter().map(|device| device.text() + "\n").collect();
        if self.adapters.is_empty() {
            text.push_str("no GPU adapters\n\n");
        }
        text + &format!("CPU          {} threads\ndefault      {}\n", self.cpu_threads, self.default)
    }
}
