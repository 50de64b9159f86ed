//! The choice of an adapter.

use std::{fmt, str::FromStr};

/// The requested device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// The best adapter: discrete, then integrated, then virtual, then software.
    #[default]
    Best,
    /// An adapter by its index in [`list_adapters`], or by part of its name, ignoring case.
    Named(String),
    /// No adapter: the CPU twins.
    Cpu,
}

impl fmt::Display for DeviceChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Best => "best",
            Self::Cpu => "cpu",
            Self::Named(name) => name,
        })
    }
}

impl FromStr for DeviceChoice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text.to_ascii_lowercase().as_str() {
            "best" => Self::Best,
            "cpu" => Self::Cpu,
            _ => Self::Named(text.into()),
        })
    }
}

/// Describes the adapters, the best first; an index here is an index for [`DeviceChoice::Named`]. A browser shows at
/// most one adapter.
pub async fn list_adapters() -> Vec<wgpu::AdapterInfo> {
    adapters().await.iter().map(wgpu::Adapter::get_info).collect()
}

/// The adapters that can compute, the best first.
pub(super) async fn adapters() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let mut adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
    adapters.retain(|a| a.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS));
    // The sort is stable: adapters of one kind keep the driver's order.
    adapters.sort_by_key(|a| match a.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

/// The index of the adapter called `name`: an index, or part of a name, of which the first match counts.
pub(super) fn find(infos: &[wgpu::AdapterInfo], name: &str) -> Option<usize> {
    if let Ok(index) = name.parse::<usize>() {
        return (index < infos.len()).then_some(index);
    }
    let name = name.trim().to_lowercase();
    if name.is_empty() {
        return None;
    }
    infos.iter().position(|info| info.name.to_lowercase().contains(&name))
}
