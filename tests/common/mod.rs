//! What the tests share: the adapter, chosen on purpose and named.
#![allow(dead_code, reason = "each test uses its part")]

pub(crate) mod pair;
pub(crate) mod sides;

use std::sync::OnceLock;

use viewsphere::gpu::{Gpu, GpuOptions};

/// The adapter that the tests run on: the one that `VIEWSPHERE_ADAPTER` names, or any.
///
/// Where there is none a test is skipped, and says so; but under `CI` that is a failure.
pub(crate) fn gpu() -> Option<Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    let open = || {
        let adapter = std::env::var("VIEWSPHERE_ADAPTER").ok();
        match Gpu::new(&GpuOptions { adapter, allow_software: true }) {
            Ok(gpu) => {
                eprintln!("testing on {}", gpu.adapter());
                Some(gpu)
            }
            Err(error) => {
                assert!(std::env::var_os("CI").is_none(), "{error}");
                eprintln!("skipped: {error}");
                None
            }
        }
    };
    GPU.get_or_init(open).clone()
}
