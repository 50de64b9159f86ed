//! `hsad devices`: lists the GPU adapters and the CPU.

use clap::Args;
use hsad::{
    Error,
    gpu::{block_on, list_adapters, pci_name},
    wgpu::{AdapterInfo, DeviceType},
};

use super::terminal;

/// List the devices that --device accepts
///
/// The first device is the best one and the default. 'cpu' is always available: it needs no driver,
/// takes longer, and computes the same disparities to the bit. GPUs of one name are told apart by
/// their places on the PCI bus.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad devices
  hsad match left.png right.png -o out --device 0
  hsad match left.png right.png -o out --device nvidia
  hsad match left.png right.png -o out --device pci:0000:3b:00.0")]
pub struct Devices {}

impl Devices {
    /// Prints the table.
    pub fn run(self) -> anyhow::Result<()> {
        let adapters = block_on(list_adapters());
        terminal::print(&table(&adapters))?;
        if adapters.is_empty() {
            terminal::warning(Error::NoAdapter);
        }
        Ok(())
    }
}

fn table(adapters: &[AdapterInfo]) -> String {
    let mut rows = vec![["index", "name", "type", "backend", "place", "driver"].map(String::from)];
    for (index, info) in adapters.iter().enumerate() {
        let driver = format!("{} {}", info.driver, info.driver_info);
        let place = pci_name(info).unwrap_or_else(|| "none".into());
        rows.push([index.to_string(), info.name.clone(), kind(info).into(), info.backend.to_string(), place, driver]);
    }
    rows.push(["cpu", "this machine's processor", "fallback", "none", "none", "none"].map(String::from));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..5).map(width).collect();
    let mut text = String::new();
    for row in &rows {
        for (cell, &width) in row.iter().zip(&widths) {
            text += &format!("{cell:width$}  ");
        }
        text += row[5].trim();
        text.push('\n');
    }
    text
}

fn kind(info: &AdapterInfo) -> &'static str {
    match info.device_type {
        DeviceType::DiscreteGpu => "discrete",
        DeviceType::IntegratedGpu => "integrated",
        DeviceType::VirtualGpu => "virtual",
        DeviceType::Cpu => "software",
        DeviceType::Other => "other",
    }
}
