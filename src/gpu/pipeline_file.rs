//! A pipeline cache in a file, so that a driver compiles the kernels once and not at each start of a program.

use std::{
    fs,
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
};

use super::{
    Gpu,
    adapter_file::{key_of, path_of},
};
use crate::{
    error::{Error, Result},
    fnv::fnv1a,
    io::atomic::write_whole,
};

/// The pipeline cache of a device, and the file that keeps it between runs of a program.
///
/// Only Vulkan has such caches, and lavapipe leaves its one empty: it has a cache of its own. The caller chooses the
/// folder, which should be the user's own, since drivers trust what they read, as [`super::cache_folder`] is:
///
/// ```no_run
/// use hsad::{DeviceChoice, Gpu, gpu::PipelineFile};
/// # fn main() -> hsad::Result<()> {
/// let gpu = Gpu::open(&DeviceChoice::Best)?;
/// let file = PipelineFile::open(&gpu, "/home/me/.cache/my-program".as_ref())?;
/// let gpu = file.iter().fold(gpu, |gpu, file| gpu.with_cache(file.cache().clone()));
/// // ... whatever compiles kernels ...
/// file.iter().try_for_each(PipelineFile::save)
/// # }
/// ```
#[derive(Debug)]
pub struct PipelineFile {
    path: PathBuf,
    /// First line of the file.
    key: String,
    cache: wgpu::PipelineCache,
    /// Hash of the data in the file; `None`: there is no file, or another key's.
    stored: Option<u64>,
}

impl PipelineFile {
    /// Makes a pipeline cache from the file of the device's adapter in `folder`, or an empty one, if there is no file, or a
    /// damaged one, or one of another driver or another version of this library. `None` without
    /// [`wgpu::Features::PIPELINE_CACHE`], which [`Gpu::open`] asks for.
    ///
    /// # Errors
    /// [`Error::Io`] for a file that exists and cannot be read.
    pub fn open(gpu: &Gpu, folder: &Path) -> Result<Option<Self>> {
        if !gpu.device.features().contains(wgpu::Features::PIPELINE_CACHE) {
            return Ok(None);
        }
        let info = gpu.info();
        let path = path_of(&info, folder, "pipelines");
        let key = key_of(&info);
        let bytes = match fs::read(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
            read => read.map_err(|source| Error::Io { path: path.clone(), source })?,
        };
        let data = data_of(&bytes, &key);
        let descriptor = wgpu::PipelineCacheDescriptor { label: Some("hsad"), data, fallback: true };
        // SAFETY: the data come from `get_data` of a cache of this adapter and driver, as `key` says, and are whole, as
        // their hash says.
        let cache = unsafe { gpu.device.create_pipeline_cache(&descriptor) };
        Ok(Some(Self { path, key, cache, stored: data.map(hash_of) }))
    }

    /// The cache, for [`Gpu::with_cache`].
    pub fn cache(&self) -> &wgpu::PipelineCache {
        &self.cache
    }

    /// Writes the cache to the file, whole or not at all, if it has changed since [`Self::open`]. Creates the folder.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn save(&self) -> Result<()> {
        let Some(data) = self.cache.get_data().filter(|data| self.stored != Some(hash_of(data))) else { return Ok(()) };
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder).map_err(|source| Error::Io { path: folder.into(), source })?;
        }
        write_whole(&self.path, |file| {
            writeln!(file, "{}\n{:016x}", self.key, hash_of(&data))?;
            file.write_all(&data)
        })
    }
}

fn hash_of(data: &[u8]) -> u64 {
    fnv1a(data.iter().copied())
}

/// The data in a file with this key: behind two lines, the key and the hash of the data. `None` for another key, and for a
/// damaged file.
fn data_of<'a>(file: &'a [u8], key: &str) -> Option<&'a [u8]> {
    let (hash, data) = file.strip_prefix(key.as_bytes())?.strip_prefix(b"\n")?.split_at_checked(17)?;
    (hash == format!("{:016x}\n", hash_of(data)).as_bytes()).then_some(data)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_whole_data_of_the_same_key_are_used() {
        let (key, data) = ("hsad 1.2.3; a GPU; vulkan; a driver; 4.5", b"compiled\nkernels");
        let mut file = format!("{key}\n{:016x}\n", hash_of(data)).into_bytes();
        file.extend(data);
        assert_eq!(data_of(&file, key), Some(&data[..]));
        assert_eq!(data_of(&file, "hsad 1.2.4; a GPU; vulkan; a driver; 4.5"), None);
        for length in 0..file.len() {
            assert_eq!(data_of(&file[..length], key), None, "{length} bytes");
        }
        for byte in 0..file.len() {
            let mut damaged = file.clone();
            damaged[byte] ^= 4;
            assert_eq!(data_of(&damaged, key), None, "byte {byte}");
        }
    }
}
