//! The threads that share a line or a pixel, 16 disparities each.

use super::volume_band::VolumeBand;

/// How the disparities of a pixel are shared out among consecutive threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lanes {
    /// Vectors of 16 disparities per pixel of a volume.
    pub quads: u32,
    /// Threads per line or pixel: the power of two that is not less.
    pub lanes: u32,
}

impl Lanes {
    /// Threads per workgroup.
    pub const WORKGROUP: u32 = 64;

    /// For the disparities of `band`; none where a workgroup does not suffice.
    pub fn of(band: &VolumeBand) -> Option<Self> {
        let quads = band.words() / 4;
        let lanes = quads.next_power_of_two();
        (lanes <= Self::WORKGROUP).then_some(Self { quads, lanes })
    }

    /// Lines or pixels per workgroup.
    pub fn per_workgroup(self) -> u32 {
        Self::WORKGROUP / self.lanes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disparity::DisparityRange;

    #[test]
    fn threads_suffice_for_all_disparities() {
        let of = |count| {
            let range = DisparityRange { min: 0, count };
            Lanes::of(&VolumeBand { width: 1, first_row: 0, rows: 1, range })
        };
        for (count, expected) in [(1, (1, 1, 64)), (33, (3, 4, 16)), (1024, (64, 64, 1))] {
            let lanes = of(count).expect("threads for so many disparities");
            assert_eq!((lanes.quads, lanes.lanes, lanes.per_workgroup()), expected, "{count}");
        }
        assert_eq!(of(1025), None);
    }
}
