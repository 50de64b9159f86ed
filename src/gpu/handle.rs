//! The handle of a device.

use std::{any::Any, sync::Arc};

use web_time::Duration;
use wgpu::WasmNotSend;

use super::{
    device::{DeviceChoice, adapters, find},
    guard::guarded,
    pipelines::Pipelines,
    shapes::{SgmPlan, Shapes},
    shelf::Shelf,
    waits::Waits,
};
use crate::error::{Error, Result};

/// The name of lavapipe's driver.
pub(super) const LAVAPIPE: &str = "llvmpipe";

/// A device, its queue, and optionally the application's pipeline cache. Everything that computes on a device is
/// created with a `Gpu`.
///
/// A `Gpu` and its clones keep the last 64 kernels that were compiled with any of them: whatever is built later compiles
/// only what it alone needs.
///
/// An application with its own device wraps its handles, which are cheap to clone:
///
/// ```
/// use hsad::{Gpu, wgpu};
///
/// fn wrap(device: &wgpu::Device, queue: &wgpu::Queue, cache: &wgpu::PipelineCache) -> Gpu {
///     Gpu::new(device.clone(), queue.clone()).with_cache(cache.clone())
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// The device's queue.
    pub queue: wgpu::Queue,
    /// The pipeline cache for kernels, of the same device.
    pub cache: Option<wgpu::PipelineCache>,
    /// The kernels of the stages that have two.
    shapes: Shapes,
    /// Compiled kernels, shared by clones.
    pub(super) pipelines: Arc<Pipelines>,
    /// Detectors and matchers that are not in use, shared by clones.
    shelf: Arc<Shelf>,
    /// Shared by clones.
    pub(super) waits: Arc<Waits>,
}

impl Gpu {
    /// Wraps a device and its own queue. With the queue of another device nothing works, and wgpu reports that only to
    /// the device's handler of uncaptured errors.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let shapes = Shapes::of(&device.adapter_info());
        Self {
            device,
            queue,
            cache: None,
            shapes,
            pipelines: Arc::default(),
            shelf: Arc::default(),
            waits: Arc::default(),
        }
    }

    /// Adds the application's pipeline cache. The kernels compiled so far are left to the clones without this cache.
    #[must_use]
    pub fn with_cache(self, cache: wgpu::PipelineCache) -> Self {
        let memory = self.shelf.most();
        Self { cache: Some(cache), shapes: self.shapes, ..Self::new(self.device, self.queue) }.keeping(memory)
    }

    /// Keeps the memory of pairs that were matched for the next pairs of the same size, range and parameters, whose detectors and matchers
    /// are built by then: at most `bytes` of the device besides what is in use, for those used last. It holds for [`crate::pipeline`] and
    /// [`crate::Pair`] on this `Gpu` and its clones; by default nothing is kept.
    #[must_use]
    #[cfg_attr(
        target_arch = "wasm32",
        expect(clippy::arc_with_non_send_sync, reason = "devices of browsers stay on their thread")
    )]
    pub fn keeping(self, bytes: u64) -> Self {
        Self { shelf: Arc::new(Shelf::new(bytes)), ..self }
    }

    /// Opens the chosen adapter, with its own limits for buffer sizes and the downlevel defaults for all others.
    ///
    /// # Errors
    /// [`Error::NoAdapter`]; [`Error::NoSuchDevice`], which lists the adapters; [`Error::Unsupported`] if the adapter
    /// refuses. [`DeviceChoice::Cpu`] is no adapter.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open(choice: &DeviceChoice) -> Result<Self> {
        super::block_on(Self::open_async(choice))
    }

    /// The asynchronous [`Gpu::open`].
    ///
    /// # Errors
    /// See [`Gpu::open`].
    pub async fn open_async(choice: &DeviceChoice) -> Result<Self> {
        let mut adapters = adapters().await;
        if adapters.is_empty() {
            return Err(Error::NoAdapter);
        }
        let index = match choice {
            DeviceChoice::Best => 0,
            DeviceChoice::Named(name) => {
                let infos: Vec<_> = adapters.iter().map(wgpu::Adapter::get_info).collect();
                find(&infos, name).ok_or_else(|| Error::NoSuchDevice {
                    wanted: name.clone(),
                    available: (0..).zip(&infos).map(|(i, info)| format!("{i}: {}, ", info.name)).collect::<String>()
                        + "cpu",
                })?
            }
            DeviceChoice::Cpu => {
                return Err(Error::Unsupported("the CPU twins are no GPU: Backend::open takes this choice".into()));
            }
        };
        let adapter = adapters.swap_remove(index);
        let limits = adapter.limits();
        // The kernels need only the downlevel defaults; larger buffer limits let larger pictures fit in one piece.
        let required_limits = wgpu::Limits {
            max_buffer_size: limits.max_buffer_size,
            max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
            max_texture_dimension_2d: limits.max_texture_dimension_2d,
            ..wgpu::Limits::downlevel_defaults()
        };
        // Timestamps only measure kernels, a pipeline cache only shortens their compilation, and what subgroups exchange goes
        // through workgroup memory without them: no kernel needs these features.
        let useful = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::PIPELINE_CACHE | wgpu::Features::SUBGROUP;
        let required_features = adapter.features() & useful;
        let descriptor =
            wgpu::DeviceDescriptor { label: Some("hsad"), required_features, required_limits, ..Default::default() };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|e| Error::Unsupported(format!("{}: {e}", adapter.get_info().name)))?;
        Ok(Self::new(device, queue))
    }

    /// Chooses the kernels of the stages that have two, for what is built with the result; else the class of the adapter decides.
    #[must_use]
    pub fn with_shapes(self, shapes: Shapes) -> Self {
        let memory = self.shelf.most();
        Self { shapes, ..self }.keeping(memory)
    }

    /// [`Self::with_shapes`] of semi-global matching alone.
    #[must_use]
    pub fn with_sgm_plan(self, sgm: SgmPlan) -> Self {
        let shapes = Shapes { sgm, ..self.shapes };
        self.with_shapes(shapes)
    }

    /// The kernels of the stages that have two.
    pub fn shapes(&self) -> Shapes {
        self.shapes
    }

    /// Describes the adapter of the device.
    pub fn info(&self) -> wgpu::AdapterInfo {
        self.device.adapter_info()
    }

    /// Whether the driver is lavapipe, where loads are the bottleneck, registers spill into the L1 cache, and few
    /// threads with much state are faster than many. Other CPU drivers take minutes to compile such kernels.
    pub(crate) fn is_lavapipe(&self) -> bool {
        self.info().driver == LAVAPIPE
    }

    /// Time in which the host has waited for results of the device, through this `Gpu` and its clones; what several threads wait at once
    /// counts once. Beside the time that has passed it tells whether the device is kept busy.
    pub fn awaited(&self) -> Duration {
        self.waits.total()
    }

    /// Whether anything is kept: see [`Self::keeping`].
    pub(crate) fn keeps(&self) -> bool {
        self.shelf.most() > 0
    }

    /// A clone that keeps nothing, for what is kept: it holds its `Gpu`, and what is kept would else hold itself.
    fn not_keeping(&self) -> Self {
        self.clone().keeping(0)
    }

    /// Takes a kept `T` that `fits` accepts, or builds one on a `Gpu` that keeps nothing.
    ///
    /// # Errors
    /// Those of `build`.
    pub(crate) async fn kept_or_built<T: Any, F: Future<Output = Result<T>>>(
        &self,
        fits: impl Fn(&T) -> bool,
        build: impl Fn(Self) -> F,
    ) -> Result<T> {
        match self.shelf.take(fits) {
            Some(kept) => Ok(kept),
            None => self.shelf.with_room(|| build(self.not_keeping())).await,
        }
    }

    /// What `build` creates on the device, as [`guarded`] does. Where there is no memory for it, what is kept makes room for a second attempt.
    ///
    /// # Errors
    /// As [`guarded`].
    pub(crate) async fn with_room<T>(&self, what: &str, build: impl Fn() -> Result<T>) -> Result<T> {
        self.shelf.with_room(|| guarded(self, what, &build)).await
    }

    /// Keeps a `T` that is not in use and takes `bytes` of the device.
    pub(crate) fn keep<T: Any + WasmNotSend>(&self, thing: T, bytes: u64) {
        self.shelf.put(thing, bytes);
    }

    /// Creates an encoder for the library's own submissions.
    pub(crate) fn encoder(&self, label: &'static str) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }
}
