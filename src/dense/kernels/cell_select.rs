//! The selection of disparities within cells, by the summed costs of all paths. `shaders/dense/cell_select.wgsl`.

use super::{
    cell_layout::{GRAIN, LevelBand, layout_constants},
    line_buffers::PathVolumes,
    map_buffer::MapBuffer,
    select::Selection,
    selection::selection_constants,
};
use crate::{
    dense::config::SUM_INDEX_BITS,
    disparity::DisparityRange,
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: [u32; 2] = [16, 4];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        top: u32,
        volumes_start: u32,
        volume_grains: u32,
        min_disparity: i32,
        disparities: u32,
        uniqueness: u32,
        confidence_offset: u32,
        key_offset: u32,
        columns: u32,
        cells: u32,
    }
}

/// The kernel that sums the costs of all paths and selects disparities within cells.
#[derive(Debug)]
pub struct CellSelect {
    kernel: Kernel,
    selection: Selection,
}

impl CellSelect {
    /// Source, bindings and constants of the kernel; all paths are stored.
    pub fn stage(selection: Selection) -> Stage {
        let mut constants = vec![
            ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
            ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
            ("GRAIN", GRAIN.into()),
            ("PATHS", selection.stored.into()),
            ("KEYS", selection.keys.into()),
        ];
        constants.extend(selection_constants(selection.interpolation, selection.kind, SUM_INDEX_BITS));
        constants.extend(layout_constants());
        Stage {
            name: "cell_select",
            source: include_str!("../../../shaders/dense/cell_select.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write, Binding::Words],
            constants,
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, selection: Selection) -> Self {
        Self { kernel: Kernel::new(gpu, &Self::stage(selection)), selection }
    }

    /// Selects the disparities of `band` among those of `range` that cells have. Results are written by the layout of
    /// `matches`, the winners' keys behind them.
    pub fn prepare(
        &self,
        band: &LevelBand<'_>,
        range: DisparityRange,
        paths: &wgpu::Buffer,
        volumes: PathVolumes,
        matches: MapBuffer<'_>,
    ) -> Dispatch {
        let &LevelBand { layout, width, top, rows, .. } = band;
        let params = Params {
            width,
            rows,
            top,
            volumes_start: volumes.start / GRAIN,
            volume_grains: volumes.volume_words / GRAIN,
            min_disparity: range.min,
            disparities: range.count,
            uniqueness: self.selection.uniqueness,
            confidence_offset: matches.layout.confidence_offset(),
            key_offset: matches.layout.key_offset(),
            columns: layout.columns,
            cells: layout.cells,
        };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.kernel.dispatch(&params, &[paths, matches.buffer, &layout.words.view], groups)
    }
}
