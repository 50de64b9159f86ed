//! The kernels of costs, paths and the selection, in the plan of the device.

use super::Plan;
use crate::{
    dense::{
        config::{Cost, CostAggregation, Direction, Penalties, View},
        kernels::{
            CostVolume, FollowedPath, LaneCost, LanePath, LaneSelect, Lanes, LineBuffers, MapBuffer, Path, PathVolumes,
            Select, Selection, VolumeBand, pixels_per_thread,
        },
    },
    disparity::DisparityRange,
    gpu::{Gpu, SgmPlan},
};

/// Which paths are stored, and by whom the others are followed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Following {
    /// A thread per line; the selection follows the path of this direction itself.
    Lines(Direction),
    /// Threads across disparities, of a line and of a pixel; all paths are stored.
    Lanes { line: Lanes, pixel: Lanes },
}

impl Following {
    /// For `costs` over `range` on the device of `gpu`, and the directions of the stored paths.
    pub(super) fn new(gpu: &Gpu, costs: &CostAggregation, range: DisparityRange) -> (Self, &'static [Direction]) {
        let band = VolumeBand { width: 1, first_row: 0, rows: 1, range };
        let lanes = Lanes::of_line(gpu, &band).zip(Lanes::of_pixel(gpu, &band));
        let lanes = lanes.filter(|_| gpu.shapes().sgm == SgmPlan::Lanes);
        // Without any path the selection reads the costs.
        match (lanes, costs.directions()) {
            (Some((line, pixel)), directions @ [_, ..]) => (Self::Lanes { line, pixel }, directions),
            _ => {
                let (last, stored) = costs.last_and_stored();
                (Self::Lines(last), stored)
            }
        }
    }
}

/// The kernel of the matching costs.
pub(super) enum CostKernel {
    Lines(CostVolume),
    Lanes(LaneCost),
}

impl CostKernel {
    pub(super) fn new(gpu: &Gpu, following: Following, cost: &Cost, view: View) -> Self {
        match following {
            Following::Lines(_) => Self::Lines(CostVolume::new(gpu, cost, view, pixels_per_thread(gpu))),
            Following::Lanes { .. } => Self::Lanes(LaneCost::new(gpu, cost, view)),
        }
    }

    /// Plans the costs of `band`, of a view's transforms against those of the other view.
    pub(super) fn plan(&self, plan: &mut Plan, band: &VolumeBand, views: [&wgpu::Buffer; 2], volume: &wgpu::Buffer) {
        plan.run(match self {
            Self::Lines(kernel) => kernel.prepare(band, views, volume),
            Self::Lanes(kernel) => kernel.prepare(band, views, volume),
        });
    }
}

/// The kernel of the stored paths.
pub(super) enum PathKernel {
    /// None where no path is stored.
    Lines(Option<Path>),
    Lanes(LanePath),
}

impl PathKernel {
    pub(super) fn new(gpu: &Gpu, following: Following, penalties: &Penalties, words: u32, paths: usize) -> Self {
        match following {
            Following::Lines(_) => Self::Lines((paths > 0).then(|| Path::new(gpu, penalties, words))),
            Following::Lanes { line, .. } => Self::Lanes(LanePath::new(gpu, penalties, line)),
        }
    }

    /// Plans stored `paths` through `band`: the volume of the first begins as `volumes` tells.
    pub(super) fn plan(
        &self,
        plan: &mut Plan,
        band: &VolumeBand,
        paths: &[FollowedPath],
        lines: LineBuffers<'_>,
        volumes: PathVolumes,
    ) {
        match self {
            Self::Lines(None) => {}
            Self::Lines(Some(kernel)) => {
                for (&(direction, goes_on), number) in paths.iter().zip(0..) {
                    let start = volumes.start + number * volumes.volume_words;
                    plan.run(kernel.prepare(band, direction, lines, start, goes_on));
                }
            }
            Self::Lanes(kernel) if !paths.is_empty() => plan.run(kernel.prepare(band, paths, lines, volumes)),
            Self::Lanes(_) => {}
        }
    }
}

/// The kernel of the selection.
pub(super) enum SelectKernel {
    Lines(Select, Direction),
    Lanes(LaneSelect),
}

impl SelectKernel {
    pub(super) fn new(
        gpu: &Gpu,
        following: Following,
        penalties: &Penalties,
        words: u32,
        selection: Selection,
    ) -> Self {
        match following {
            Following::Lines(last) => Self::Lines(Select::new(gpu, penalties, words, selection), last),
            Following::Lanes { pixel, .. } => Self::Lanes(LaneSelect::new(gpu, pixel, selection)),
        }
    }

    /// Plans the selection of the disparities of `band`, whose map is cleared.
    pub(super) fn plan(
        &self,
        plan: &mut Plan,
        band: &VolumeBand,
        lines: LineBuffers<'_>,
        volumes: PathVolumes,
        matches: MapBuffer<'_>,
    ) {
        plan.run(match self {
            Self::Lines(kernel, last) => kernel.prepare(band, *last, lines, volumes, matches),
            Self::Lanes(kernel) => kernel.prepare(band, lines.paths, volumes, matches),
        });
    }
}
