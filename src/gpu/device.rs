//! Which adapter to use, and opening it.

use std::{fmt, str::FromStr};

use crate::error::{Error, Result};

/// What someone asked for with `--device`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// The best adapter there is: discrete, then integrated, then virtual, then software.
    #[default]
    Best,
    /// By index in [`list_adapters`], or by part of the name, whatever the case.
    Named(String),
    /// No GPU: the CPU twins.
    Cpu,
}

impl FromStr for DeviceChoice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> std::result::Result<Self, Self::Err> {
        Ok(match text.to_ascii_lowercase().as_str() {
            "best" => Self::Best,
            "cpu" => Self::Cpu,
            _ => Self::Named(text.into()),
        })
    }
}

/// An opened device. The stages borrow `device` and `queue`; anyone with a device of their own
/// passes theirs instead and never needs this.
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue. With another device's nothing works, and wgpu tells that to its handler of uncaptured errors.
    pub queue: wgpu::Queue,
    /// What the adapter says of itself.
    pub info: wgpu::AdapterInfo,
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Gpu").field("info", &self.info).finish_non_exhaustive()
    }
}

impl Gpu {
    /// Opens the chosen adapter, with its own limits for the size of buffers.
    ///
    /// # Errors
    /// [`Error::NoAdapter`], [`Error::NoSuchDevice`] (which lists those that exist), or
    /// [`Error::Unsupported`] where the adapter refuses. [`DeviceChoice::Cpu`] is no adapter.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open(choice: &DeviceChoice) -> Result<Self> {
        pollster::block_on(Self::open_async(choice))
    }

    /// As [`Gpu::open`], without blocking.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub async fn open_async(choice: &DeviceChoice) -> Result<Self> {
        let mut adapters = adapters().await;
        if adapters.is_empty() {
            return Err(Error::NoAdapter);
        }
        let index = match choice {
            DeviceChoice::Best => 0,
            DeviceChoice::Named(wanted) => {
                let infos: Vec<_> = adapters.iter().map(wgpu::Adapter::get_info).collect();
                find(&infos, wanted).ok_or_else(|| Error::NoSuchDevice {
                    wanted: wanted.clone(),
                    available: (0..).zip(&infos).map(|(i, info)| format!("{i}: {}, ", info.name)).collect::<String>()
                        + "cpu",
                })?
            }
            DeviceChoice::Cpu => {
                return Err(Error::NoSuchDevice { wanted: "cpu".into(), available: "adapters only".into() });
            }
        };
        let adapter = adapters.swap_remove(index);
        let limits = adapter.limits();
        // Compute needs no more than the downlevel defaults, except that larger pictures fit in
        // one piece where the adapter has the room.
        let required_limits = wgpu::Limits {
            max_buffer_size: limits.max_buffer_size,
            max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
            ..wgpu::Limits::downlevel_defaults()
        };
        // Only to tell what kernels take; nothing needs it.
        let required_features = adapter.features() & wgpu::Features::TIMESTAMP_QUERY;
        let descriptor =
            wgpu::DeviceDescriptor { label: Some("hsad"), required_features, required_limits, ..Default::default() };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|e| Error::Unsupported(format!("{}: {e}", adapter.get_info().name)))?;
        Ok(Self { device, queue, info: adapter.get_info() })
    }
}

/// What each adapter says of itself, the best first. An index here is an index for `--device`.
#[cfg(not(target_arch = "wasm32"))]
pub fn list_adapters() -> Vec<wgpu::AdapterInfo> {
    pollster::block_on(list_adapters_async())
}

/// As [`list_adapters`], without blocking. A browser shows one at most.
pub async fn list_adapters_async() -> Vec<wgpu::AdapterInfo> {
    adapters().await.iter().map(wgpu::Adapter::get_info).collect()
}

async fn adapters() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let mut adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
    adapters.retain(|a| a.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS));
    // Stable, so that adapters of one kind keep the driver's order.
    adapters.sort_by_key(|a| match a.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

/// The adapter that `wanted` names: an index, or part of exactly the first name that holds it.
fn find(infos: &[wgpu::AdapterInfo], wanted: &str) -> Option<usize> {
    if let Ok(index) = wanted.parse::<usize>() {
        return (index < infos.len()).then_some(index);
    }
    let wanted = wanted.trim().to_lowercase();
    if wanted.is_empty() {
        return None;
    }
    infos.iter().position(|info| info.name.to_lowercase().contains(&wanted))
}

/// Whether this is lavapipe, where loads are the bottleneck, registers spill into the first cache, and few threads that
/// keep much are faster than many. Other drivers that compute on the CPU take minutes to compile such kernels.
pub(crate) fn is_lavapipe(device: &wgpu::Device) -> bool {
    device.adapter_info().driver == "llvmpipe"
}
