//! The choice of an adapter.

use std::{fmt, str::FromStr};

/// The requested device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// The best adapter: discrete, then integrated, then virtual, then software.
    #[default]
    Best,
    /// An adapter by its index in [`list_adapters`], by part of its name, ignoring case, or by its place on the PCI bus:
    /// `pci:0000:3b:00.0`.
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

/// The index of the adapter called `name`: an index, a place on the PCI bus behind `pci:`, or part of a name, of which the first match
/// counts.
pub(super) fn find(infos: &[wgpu::AdapterInfo], name: &str) -> Option<usize> {
    if let Ok(index) = name.parse::<usize>() {
        return (index < infos.len()).then_some(index);
    }
    let name = name.trim().to_lowercase();
    if let Some(address) = name.strip_prefix(PCI) {
        let wanted = pci_address(address)?;
        return infos.iter().position(|info| pci_address(&info.device_pci_bus_id) == Some(wanted));
    }
    if name.is_empty() {
        return None;
    }
    infos.iter().position(|info| info.name.to_lowercase().contains(&name))
}

/// What is in front of a place on the PCI bus.
const PCI: &str = "pci:";

/// The name of an adapter that no other adapter has: its place on the PCI bus, as [`DeviceChoice::Named`] takes it. `None` for adapters
/// that are on none, or whose driver does not tell.
pub fn pci_name(info: &wgpu::AdapterInfo) -> Option<String> {
    pci_address(&info.device_pci_bus_id).map(|_| format!("{PCI}{}", info.device_pci_bus_id.to_lowercase()))
}

/// Domain, bus, device and function of a place on the PCI bus: `0000:3b:00.0`, the domain of any length (nvidia-smi writes 8 digits), or
/// without it.
fn pci_address(text: &str) -> Option<[u32; 4]> {
    let (place, function) = text.rsplit_once('.')?;
    let number = |digits| u32::from_str_radix(digits, 16).ok();
    let mut parts = place.rsplit(':').map(number);
    let (device, bus) = (parts.next()??, parts.next()??);
    let domain = parts.next().unwrap_or(Some(0))?;
    parts.next().is_none().then_some([domain, bus, device, number(function)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adapters_are_found_by_index_name_and_place_on_the_bus() {
        let adapter = |name: &str, place: &str| wgpu::AdapterInfo {
            name: name.into(),
            device_pci_bus_id: place.into(),
            ..wgpu::AdapterInfo::new(wgpu::DeviceType::DiscreteGpu, wgpu::Backend::Vulkan)
        };
        let adapters = [
            adapter("NVIDIA H100", "0000:3b:00.0"),
            adapter("NVIDIA H100", "0001:3b:00.0"),
            adapter("NVIDIA L4", "0000:af:00.1"),
            adapter("llvmpipe", ""),
        ];
        for (name, index) in [
            ("2", Some(2)),
            ("4", None),
            ("h100", Some(0)),
            (" llvm", Some(3)),
            ("", None),
            ("pci:0000:3b:00.0", Some(0)),
            ("PCI:00000001:3B:00.0", Some(1)),
            ("pci:af:00.1", Some(2)),
            ("pci:0000:af:00.0", None),
            ("pci:0002:3b:00.0", None),
            ("pci:", None),
            ("pci:0000:3b:00", None),
            ("pci:0:0000:3b:00.0", None),
            ("pci:0000:zz:00.0", None),
        ] {
            assert_eq!(find(&adapters, name), index, "{name:?}");
        }
        let names = adapters.each_ref().map(pci_name);
        assert_eq!(names[1].as_deref(), Some("pci:0001:3b:00.0"));
        assert_eq!(find(&adapters, names[2].as_deref().expect("a place")), Some(2));
        assert_eq!(names[3], None);
    }
}
