//! Selection of disparities by the summed costs of all paths, with threads across disparities.
//! `shaders/dense/lane_select.wgsl`.

use super::{
    lanes::Lanes,
    line_buffers::PathVolumes,
    map_buffer::MapBuffer,
    select::Selection,
    selection::{SELECTION_OPERATIONS, selection_constants},
    volume_band::VolumeBand,
};
use crate::{
    dense::config::SUM_INDEX_BITS,
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

shader_struct! {
    struct Params {
        width: u32,
        volumes_start: u32,
        volume_quads: u32,
        quads: u32,
        lanes: u32,
        min_disparity: i32,
        disparities: u32,
        uniqueness: u32,
        confidence_offset: u32,
        key_offset: u32,
    }
}

/// The kernel that sums the costs of all paths and selects disparities.
#[derive(Debug)]
pub struct LaneSelect {
    kernel: Kernel,
    lanes: Lanes,
    /// Number of paths.
    paths: u32,
    uniqueness: u32,
}

impl LaneSelect {
    /// Source, bindings and constants of the kernel, with so many threads per workgroup; all paths of `selection` are stored.
    pub fn stage(selection: Selection, threads: u32) -> Stage {
        let mut constants =
            vec![("WORKGROUP", threads.into()), ("PATHS", selection.stored.into()), ("KEYS", selection.keys.into())];
        constants.extend(selection_constants(selection.interpolation, selection.kind, SUM_INDEX_BITS));
        Stage {
            name: "lane_select",
            source: include_str!("../../../shaders/dense/lane_select.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants,
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, lanes: Lanes, selection: Selection) -> Self {
        let kernel = Kernel::new(gpu, &Self::stage(selection, lanes.threads));
        Self { kernel, lanes, paths: selection.stored, uniqueness: selection.uniqueness }
    }

    /// Selects the disparities of `band` by the path costs in `paths`. `matches` must be cleared to 0 before; results are
    /// written by its layout, the winners' keys behind them.
    pub fn prepare(
        &self,
        band: &VolumeBand,
        paths: &wgpu::Buffer,
        PathVolumes { start, volume_words }: PathVolumes,
        matches: MapBuffer<'_>,
    ) -> Dispatch {
        let params = Params {
            width: band.width,
            volumes_start: start / 4,
            volume_quads: volume_words / 4,
            quads: self.lanes.busy,
            lanes: self.lanes.lanes,
            min_disparity: band.range.min,
            disparities: band.range.count,
            uniqueness: self.uniqueness,
            confidence_offset: matches.layout.confidence_offset(),
            key_offset: matches.layout.key_offset(),
        };
        let groups = [band.width.div_ceil(self.lanes.per_workgroup()), band.rows, 1];
        let operations = u64::from(self.paths) + SELECTION_OPERATIONS;
        self.kernel.dispatch(&params, &[paths, matches.buffer], groups).counting(operations * band.values())
    }
}
