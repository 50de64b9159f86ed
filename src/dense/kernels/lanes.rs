//! The threads that share a line or a pixel, 16 disparities each.

use super::volume_band::VolumeBand;
use crate::gpu::{Exchange, Gpu};

/// How the disparities of a pixel are shared out among consecutive threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lanes {
    /// Vectors of 16 disparities per pixel of a volume.
    pub quads: u32,
    /// Threads per line or pixel: the power of two that is not less.
    pub lanes: u32,
    /// Threads per workgroup.
    pub threads: u32,
    /// By what the threads of a line exchange path costs.
    pub exchange: Exchange,
}

impl Lanes {
    /// Most threads of a workgroup, which all devices have.
    const MOST_THREADS: u32 = 256;

    /// For the disparities of `band`, in the shape chosen for `gpu`; none where a workgroup does not suffice.
    pub fn of(gpu: &Gpu, band: &VolumeBand) -> Option<Self> {
        let (shapes, device) = (gpu.shapes(), &gpu.device);
        let has_subgroups = device.features().contains(wgpu::Features::SUBGROUP);
        let subgroup = if has_subgroups { device.adapter_info().subgroup_min_size } else { 0 };
        Self::shared_out(band, shapes.lane_threads, shapes.exchange, subgroup)
    }

    /// In workgroups of `threads`, or of as many as share a line; subgroups have at least `subgroup` threads.
    fn shared_out(band: &VolumeBand, threads: u32, exchange: Exchange, subgroup: u32) -> Option<Self> {
        let quads = band.words() / 4;
        let lanes = quads.next_power_of_two();
        let threads = threads.max(lanes);
        let exchange = if lanes <= subgroup { exchange } else { Exchange::Memory };
        (threads <= Self::MOST_THREADS).then_some(Self { quads, lanes, threads, exchange })
    }

    /// Lines or pixels per workgroup.
    pub fn per_workgroup(self) -> u32 {
        self.threads / self.lanes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disparity::DisparityRange;

    #[test]
    fn threads_suffice_for_all_disparities() {
        let of = |count, subgroup| {
            let range = DisparityRange { min: 0, count };
            let band = VolumeBand { width: 1, first_row: 0, rows: 1, range };
            Lanes::shared_out(&band, 64, Exchange::Subgroups, subgroup)
        };
        for (count, expected) in [(1, (1, 1, 64)), (33, (3, 4, 16)), (1024, (64, 64, 1)), (4096, (256, 256, 1))] {
            let lanes = of(count, 32).expect("threads for so many disparities");
            assert_eq!((lanes.quads, lanes.lanes, lanes.per_workgroup()), expected, "{count}");
            assert_eq!(lanes.exchange == Exchange::Subgroups, lanes.lanes <= 32, "{count}");
        }
        assert_eq!(of(1, 0).map(|lanes| lanes.exchange), Some(Exchange::Memory), "without subgroups");
        assert_eq!(of(4097, 32), None);
    }
}
