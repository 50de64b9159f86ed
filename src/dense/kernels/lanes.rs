//! The threads that share a line or a pixel.

use super::volume_band::VolumeBand;
use crate::gpu::{Exchange, Gpu, Shapes};

/// How the disparities of a pixel are shared out among consecutive threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lanes {
    /// Words of a thread, of four disparities each: 1, 2 or 4.
    pub words: u32,
    /// Threads per pixel that have disparities.
    pub busy: u32,
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

    /// The threads of a line for the disparities of `band`, in the shape chosen for `gpu`; none where a workgroup does not suffice.
    pub fn of_line(gpu: &Gpu, band: &VolumeBand) -> Option<Self> {
        let device = &gpu.device;
        let has_subgroups = device.features().contains(wgpu::Features::SUBGROUP);
        let subgroup = if has_subgroups { device.adapter_info().subgroup_min_size } else { 0 };
        Self::shared_out(band, gpu.shapes(), subgroup)
    }

    /// The threads of a pixel, for the selection: 16 disparities each, since all pixels give threads enough.
    pub fn of_pixel(gpu: &Gpu, band: &VolumeBand) -> Option<Self> {
        Self::shared_out(band, Shapes { lane_disparities: 16, ..gpu.shapes() }, 0)
    }

    /// In the shape that is asked for, or with more disparities per thread and threads per workgroup, where a line needs them;
    /// subgroups have at least `subgroup` threads.
    fn shared_out(band: &VolumeBand, shapes: Shapes, subgroup: u32) -> Option<Self> {
        let sizes = Shapes::LANE_DISPARITIES.into_iter().filter(|&disparities| disparities >= shapes.lane_disparities);
        sizes.map(|disparities| disparities / 4).find_map(|words| {
            let busy = band.words() / words;
            let lanes = busy.next_power_of_two();
            let threads = shapes.lane_threads.max(lanes);
            let exchange = if lanes <= subgroup { shapes.exchange } else { Exchange::Memory };
            (threads <= Self::MOST_THREADS).then_some(Self { words, busy, lanes, threads, exchange })
        })
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
        let text = "sgm=lanes lane_disparities=8 lane_threads=64 exchange=subgroups block_match=tiles census=tiles support=tiles \
                    weighted_median=tiles";
        let shapes: Shapes = text.parse().expect("shapes");
        let of = |count, subgroup| {
            let range = DisparityRange { min: 0, count };
            Lanes::shared_out(&VolumeBand { width: 1, first_row: 0, rows: 1, range }, shapes, subgroup)
        };
        for (count, expected) in [
            (1, (2, 2, 2, 32)),
            (33, (2, 6, 8, 8)),
            (1024, (2, 128, 128, 1)),
            (2048, (2, 256, 256, 1)),
            (4096, (4, 256, 256, 1)),
        ] {
            let lanes = of(count, 32).expect("threads for so many disparities");
            assert_eq!((lanes.words, lanes.busy, lanes.lanes, lanes.per_workgroup()), expected, "{count}");
            assert_eq!(lanes.exchange == Exchange::Subgroups, lanes.lanes <= 32, "{count}");
        }
        assert_eq!(of(1, 0).map(|lanes| lanes.exchange), Some(Exchange::Memory), "without subgroups");
        assert_eq!(of(4097, 32), None);
    }
}
