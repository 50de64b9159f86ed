//! What the program keeps in the user's cache folder per adapter: compiled kernels, and what `hsad tune` has measured.

use hsad::{
    Backend, Gpu,
    gpu::{PipelineFile, cache_folder},
};

/// An open backend, and the file of its pipeline cache, if the device has one.
pub struct CachedBackend {
    pub backend: Backend,
    file: Option<PipelineFile>,
}

impl CachedBackend {
    /// Gives a device the shapes of kernels and the pipeline cache that earlier runs have left. A file that cannot be read is a
    /// record in the log.
    pub fn new(backend: Backend) -> Self {
        let Backend::Gpu(gpu) = backend else { return Self { backend, file: None } };
        let gpu = tuned(gpu);
        let file = cache_folder().and_then(|folder| {
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

    /// Keeps device memory for the next pairs: see [`Gpu::keeping`].
    pub fn keeping(self, bytes: u64) -> Self {
        let backend = match self.backend {
            Backend::Gpu(gpu) => Backend::Gpu(gpu.keeping(bytes)),
            Backend::Cpu => Backend::Cpu,
        };
        Self { backend, ..self }
    }

    /// Leaves what was compiled to later runs. A failure is a record in the log.
    pub fn save(&self) {
        if let Some(Err(error)) = self.file.as_ref().map(PipelineFile::save) {
            log::warn!("the pipeline cache is not saved: {error}");
        }
    }
}

/// The device with the shapes of kernels that `hsad tune` has found, if it has. A file that cannot be read is a record in the log.
pub fn tuned(gpu: Gpu) -> Gpu {
    let Some(folder) = cache_folder() else { return gpu };
    gpu.clone().with_kept_shapes(&folder).unwrap_or_else(|error| {
        log::warn!("the shapes of kernels are not those of hsad tune: {error}");
        gpu
    })
}
