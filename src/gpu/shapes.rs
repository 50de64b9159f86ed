//! The kernels of stages that have two: how the threads of a device share the work.

use std::{fmt, str::FromStr};

use crate::{
    error::{Error, Result},
    names::names,
};

/// How the threads of a device share the work of semi-global matching over one range for all pixels. The result is the
/// same, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SgmPlan {
    /// A thread per line of pixels, which holds all disparities of a pixel in registers: for CPUs.
    Lines,
    /// A thread per few disparities, and all paths at once; the threads of a line exchange what they need of each other: for
    /// GPUs. Ranges of more than 4,096 disparities are matched by [`Self::Lines`].
    Lanes,
}

names!(SgmPlan, "the plan of semi-global matching", { Lines => "lines", Lanes => "lanes" });

/// By what the threads of a line exchange path costs with [`SgmPlan::Lanes`]. The result is the same, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exchange {
    /// Workgroup memory, with one barrier per pixel.
    Memory,
    /// Shuffles, where the device has [`wgpu::Features::SUBGROUP`] and its subgroups hold the threads of a line; else
    /// [`Self::Memory`].
    Subgroups,
}

names!(Exchange, "the exchange between the threads of a line", { Memory => "memory", Subgroups => "subgroups" });

/// Where the threads of a kernel keep the windows of their pixels. The result is the same, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Windows {
    /// In registers: a thread walks down the rows of a few columns. For lavapipe, which loads for one thread after the other,
    /// from workgroup memory too.
    Rows,
    /// In workgroup memory: a workgroup loads a tile and its halo. For all other devices: the registers of GPUs are too few.
    Tiles,
}

names!(Windows, "the place of windows", { Rows => "rows", Tiles => "tiles" });

/// The kernels of the stages that have two, and the sizes of workgroups: what is fastest differs between devices, and the result
/// is the same, bit for bit. `hsad tune` measures.
///
/// As text, one `name=value` per field:
///
/// ```
/// use hsad::gpu::Shapes;
///
/// let text = "sgm=lanes lane_disparities=8 lane_threads=64 exchange=subgroups block_match=tiles census=tiles support=tiles \
///             weighted_median=tiles";
/// assert_eq!(text.parse::<Shapes>()?.to_string(), text);
/// # hsad::Result::Ok(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shapes {
    /// Costs, paths and selection of semi-global matching.
    pub sgm: SgmPlan,
    /// Disparities per thread of the paths with [`SgmPlan::Lanes`], one of [`Self::LANE_DISPARITIES`]: fewer give more threads, of which
    /// each has a shorter way to the next pixel, but more to exchange. At least as many as let a workgroup hold a line.
    pub lane_disparities: u32,
    /// Threads per workgroup of the paths and the selection with [`SgmPlan::Lanes`], one of [`Self::LANE_THREADS`]; at least as
    /// many as share a line.
    pub lane_threads: u32,
    /// By what the threads of a line exchange path costs with [`SgmPlan::Lanes`].
    pub exchange: Exchange,
    /// Windows of block matching.
    pub block_match: Windows,
    /// Windows of the census transform.
    pub census: Windows,
    /// Windows of the removal of speckles.
    pub support: Windows,
    /// Windows of the weighted median.
    pub weighted_median: Windows,
}

impl Shapes {
    /// Values of [`Self::lane_disparities`].
    pub const LANE_DISPARITIES: [u32; 3] = [4, 8, 16];

    /// Values of [`Self::lane_threads`].
    pub const LANE_THREADS: [u32; 4] = [32, 64, 128, 256];

    /// What the class of an adapter tells, without measuring.
    pub(super) fn of(adapter: &wgpu::AdapterInfo) -> Self {
        let is_cpu = adapter.device_type == wgpu::DeviceType::Cpu;
        // Other drivers for CPUs take minutes to compile kernels with windows in registers.
        let windows = if adapter.driver == super::handle::LAVAPIPE { Windows::Rows } else { Windows::Tiles };
        Self {
            sgm: if is_cpu { SgmPlan::Lines } else { SgmPlan::Lanes },
            lane_disparities: 8,
            lane_threads: 64,
            exchange: Exchange::Subgroups,
            block_match: windows,
            census: windows,
            support: windows,
            weighted_median: windows,
        }
    }
}

impl fmt::Display for Shapes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sgm, lane_disparities, lane_threads, exchange, block_match, census, support, weighted_median } =
            self;
        write!(
            f,
            "sgm={sgm} lane_disparities={lane_disparities} lane_threads={lane_threads} exchange={exchange} block_match={block_match} census={census} \
             support={support} weighted_median={weighted_median}"
        )
    }
}

impl FromStr for Shapes {
    type Err = Error;

    /// Reads what `Display` writes.
    fn from_str(text: &str) -> Result<Self> {
        let unknown = || Error::Parameter {
            name: "the shapes of kernels",
            value: format!("'{text}'"),
            expected: "one name=value per field of Shapes".into(),
        };
        let mut values = text.split_whitespace().map(|part| part.split_once('=').ok_or_else(unknown));
        let mut value = |name: &str| match values.next() {
            Some(Ok((found, value))) if found == name => Ok(value),
            _ => Err(unknown()),
        };
        let number = |text: &str| text.parse::<u32>().map_err(|_| unknown());
        let shapes = Self {
            sgm: value("sgm")?.parse()?,
            lane_disparities: number(value("lane_disparities")?)?,
            lane_threads: number(value("lane_threads")?)?,
            exchange: value("exchange")?.parse()?,
            block_match: value("block_match")?.parse()?,
            census: value("census")?.parse()?,
            support: value("support")?.parse()?,
            weighted_median: value("weighted_median")?.parse()?,
        };
        let is_known = Self::LANE_DISPARITIES.contains(&shapes.lane_disparities)
            && Self::LANE_THREADS.contains(&shapes.lane_threads)
            && values.next().is_none();
        is_known.then_some(shapes).ok_or_else(unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_display_writes_is_read() {
        let text = "sgm=lines lane_disparities=4 lane_threads=128 exchange=memory block_match=rows census=tiles support=rows weighted_median=rows";
        assert_eq!(text.parse::<Shapes>().expect("shapes").to_string(), text);
        for wrong in
            ["", "sgm=lines", &text.replace("128", "100"), &text.replace("rows", "row"), &format!("{text} more=1")]
        {
            assert!(wrong.parse::<Shapes>().is_err(), "{wrong}");
        }
    }
}
