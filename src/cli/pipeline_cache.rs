//! The pipeline cache of the program: in the user's cache folder, as `hsad/<vendor>-<device>.pipelines`.

use std::path::PathBuf;

use hsad::{Backend, gpu::PipelineFile};

/// An open backend, and the file of its pipeline cache, if the device has one.
pub struct CachedBackend {
    pub backend: Backend,
    file: Option<PipelineFile>,
}

impl CachedBackend {
    /// Gives a device the pipeline cache that earlier runs have left. A cache that cannot be read is a record in the log.
    pub fn new(backend: Backend) -> Self {
        let Backend::Gpu(gpu) = backend else { return Self { backend, file: None } };
        let file = folder().and_then(|folder| {
            PipelineFile::open(&gpu, &folder).unwrap_or_else(|error| {
                log::warn!("no pipeline cache: {error}");
                None
            })
        });
        let gpu = match &file {
            Some(file) => gpu.with_cache(file.cache().clone()),
            None => gpu,
        };
        Self { backend: Backend::Gpu(gpu), file }
    }

    /// Leaves what was compiled to later runs. A failure is a record in the log.
    pub fn save(&self) {
        if let Some(Err(error)) = self.file.as_ref().map(PipelineFile::save) {
            log::warn!("the pipeline cache is not saved: {error}");
        }
    }
}

/// The folder of this program in the user's cache folder (XDG Base Directory Specification; `%LOCALAPPDATA%` on Windows).
fn folder() -> Option<PathBuf> {
    let absolute = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let cache = absolute("XDG_CACHE_HOME").or_else(|| {
        if cfg!(windows) { absolute("LOCALAPPDATA") } else { absolute("HOME").map(|home| home.join(".cache")) }
    })?;
    Some(cache.join("hsad"))
}
