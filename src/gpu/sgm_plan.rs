//! How the threads of a device share the work of semi-global matching.

use crate::names::names;

/// How the threads of a device share the work of semi-global matching over one range for all pixels. The result is the
/// same, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SgmPlan {
    /// A thread per line of pixels, which holds all disparities of a pixel in registers: for CPUs.
    Lines,
    /// A thread per 16 disparities, and all paths at once; the threads of a line exchange what they need of each other: for
    /// GPUs. Ranges of more than 1,024 disparities are matched by [`Self::Lines`].
    Lanes,
}

names!(SgmPlan, "the plan of semi-global matching", { Lines => "lines", Lanes => "lanes" });

impl SgmPlan {
    /// The plan for an adapter, if none is chosen.
    pub(super) fn of(adapter: &wgpu::AdapterInfo) -> Self {
        if adapter.device_type == wgpu::DeviceType::Cpu { Self::Lines } else { Self::Lanes }
    }
}
