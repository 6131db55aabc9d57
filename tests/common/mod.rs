//! What the tests share: the adapter, chosen on purpose and named.
#![allow(dead_code, reason = "each test uses its part")]

pub(crate) mod feed;
pub(crate) mod flight;
pub(crate) mod pair;
pub(crate) mod sample;
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
        match Gpu::new(&GpuOptions { adapter, allow_software: true, ..GpuOptions::default() }) {
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

/// A folder of the data sets, which are not part of this crate: in the folder that `VIEWSPHERE_DATA` names, or in
/// `../shared/data`. Where it is not there a test is skipped, and says so.
pub(crate) fn data(name: &str) -> Option<std::path::PathBuf> {
    let beside = || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let folder = std::env::var_os("VIEWSPHERE_DATA").map_or_else(beside, std::path::PathBuf::from).join(name);
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
        return None;
    }
    Some(folder)
}
