//! The driver's compiled code on disk, so that the next process need not compile it again. Native only, and the `gpu`
//! module's only unsafe code.

use std::fs::{self, DirBuilder};
use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use wgpu::{Device, ErrorFilter, Features, PipelineCache, PipelineCacheDescriptor};

use super::blocking;
use crate::atomic_file::write_bytes;

/// The beginning of a file, with the version of its format.
const MAGIC: &[u8; 8] = b"VSPIPE01";

/// A pipeline cache, and the file that keeps it from one process to the next.
///
/// The cache never causes a failure: a file that cannot be read, is damaged or is not ours is ignored and replaced; one
/// that cannot be written is not written. If two processes save concurrently, the last one's file stays.
pub(super) struct DiskCache {
    cache: PipelineCache,
    file: PathBuf,
    /// The hash of the file's content; `None` if it has no usable content.
    saved: Mutex<Option<u64>>,
}

impl DiskCache {
    /// The cache of a device in a folder. `None` if the device has no [`Features::PIPELINE_CACHE`].
    pub(super) fn open(device: &Device, folder: &Path) -> Option<Self> {
        if !device.features().contains(Features::PIPELINE_CACHE) {
            return None;
        }
        let file = folder.join(wgpu::util::pipeline_cache_key(&device.adapter_info())?);
        let bytes = fs::read(&file).unwrap_or_default();
        let data = unseal(&bytes);
        let (cache, saved) = match data.and_then(|data| create(device, Some(data))) {
            Some(cache) => (cache, data.map(hash)),
            None => (create(device, None)?, None),
        };
        Some(Self { cache, file, saved: Mutex::new(saved) })
    }

    pub(super) fn cache(&self) -> &PipelineCache {
        &self.cache
    }

    /// Writes the file, unless its content is already the same.
    pub(super) fn save(&self) {
        let Some(data) = self.cache.get_data() else { return };
        let mut saved = self.saved.lock().unwrap_or_else(PoisonError::into_inner);
        if *saved == Some(hash(&data)) {
            return;
        }
        if let Some(folder) = self.file.parent() {
            let mut builder = DirBuilder::new();
            builder.recursive(true);
            #[cfg(unix)]
            std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
            // If that fails, writing fails, too.
            let _ = builder.create(folder);
        }
        if write_bytes(&self.file, &seal(&data)).is_ok() {
            *saved = Some(hash(&data));
        }
    }
}

/// Creates a pipeline cache from the data of an earlier one, or an empty one. `None` if wgpu refuses.
fn create(device: &Device, data: Option<&[u8]>) -> Option<PipelineCache> {
    let filters = [ErrorFilter::OutOfMemory, ErrorFilter::Validation];
    let [memory, validation] = filters.map(|filter| device.push_error_scope(filter));
    #[allow(unsafe_code, reason = "create_pipeline_cache is unsafe")]
    // SAFETY: `data` must come from `PipelineCache::get_data`. It comes from a file that `save` has written: nothing
    // else writes our magic number followed by the hash of the rest, and damage on the way would show in the hash. wgpu
    // compares the header that it has put before the driver's data with the adapter, the driver's version and the
    // pointers' size, and with `fallback` leaves data of another one alone. Only a file that was forged on purpose
    // passes all that. Who can write into the folder can do that; so it must be the user's own, as the documentation of
    // `GpuOptions::pipeline_cache` says, and whoever can write into the user's own folders can act as the user anyway.
    let cache = unsafe {
        device.create_pipeline_cache(&PipelineCacheDescriptor {
            label: Some("viewsphere"),
            data,
            fallback: true,
        })
    };
    let errors = [blocking::block_on(validation.pop()), blocking::block_on(memory.pop())];
    errors.iter().all(Option::is_none).then_some(cache)
}

/// The content of a file: the magic number, the hash of the data, the data.
fn seal(data: &[u8]) -> Vec<u8> {
    [MAGIC, &hash(data).to_le_bytes(), data].concat()
}

/// The data of a file. `None` if it is damaged or not ours.
fn unseal(bytes: &[u8]) -> Option<&[u8]> {
    let (expected, data) = bytes.strip_prefix(MAGIC)?.split_first_chunk()?;
    (hash(data) == u64::from_le_bytes(*expected)).then_some(data)
}

/// A hash of the data. Another version of Rust may hash differently: then the file counts as damaged and is replaced.
fn hash(data: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(data);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_sealed_is_read_again() {
        for data in [&b""[..], b"x", &[7; 1000]] {
            assert_eq!(unseal(&seal(data)), Some(data));
        }
    }

    #[test]
    fn a_damaged_or_foreign_file_is_ignored() {
        let sealed = seal(b"compiled code");
        for at in 0..sealed.len() {
            assert_eq!(unseal(&sealed[..at]), None, "cut at {at}");
            let mut damaged = sealed.clone();
            damaged[at] ^= 1;
            assert_eq!(unseal(&damaged), None, "byte {at} changed");
        }
        let longer = [&sealed[..], b"more"].concat();
        assert_eq!(unseal(&longer), None);
        assert_eq!(unseal(b"WGPUPLCH, a cache as wgpu gives it"), None);
        assert_eq!(unseal(b""), None);
    }
}
