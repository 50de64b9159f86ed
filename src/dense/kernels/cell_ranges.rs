//! The disparity range of each cell, from a half-size map. `shaders/dense/cell_ranges.wgsl`.

use super::cells::{CELL, CellBand, REACH};
use crate::{
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

/// Disparities added at either end of a cell's range: without 2 of them a winner has no rival two disparities away, and
/// a cell without texture passes for unique.
pub const MARGIN: u32 = 2;

/// Least percentage of pixels with a disparity in a cell and around it; below, the whole range is searched.
pub const LEAST: u32 = 10;

/// Side of the blocks of the map that determine a range, in pixels: each contributes its third smallest and its third
/// largest disparity.
pub const BLOCK: u32 = 4;

/// Blocks along a side: from one cell to the next, in and around one cell, and read by a workgroup.
const STEP: u32 = CELL / 2 / BLOCK;
const AROUND: u32 = STEP + REACH / BLOCK;
const BLOCKS: u32 = 16;
/// Cells along a side whose blocks a workgroup reads completely.
const CELLS: u32 = (BLOCKS - AROUND) / STEP + 1;

/// A sentinel above any disparity, and less than half of `i32::MAX`.
const FAR: i64 = 1 << 24;

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_row: i32,
        columns: u32,
        cell_rows: u32,
        min_disparity: i32,
        disparities: u32,
    }
}

/// The kernel that finds the range of each cell.
#[derive(Debug)]
pub struct CellRanges(Kernel);

impl CellRanges {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "cell_ranges",
            source: include_str!("../../../shaders/dense/cell_ranges.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("SIDE", (CELL / 2).into()),
                ("REACH", (REACH / 2).into()),
                ("MARGIN", MARGIN.into()),
                ("LEAST", LEAST.into()),
                ("BLOCK", BLOCK.into()),
                ("BLOCKS", BLOCKS.into()),
                ("STEP", STEP.into()),
                ("AROUND", AROUND.into()),
                ("CELLS", CELLS.into()),
                ("FAR", FAR),
                ("SCALE", SCALE.into()),
                ("SCALE_BITS", SCALE.trailing_zeros().into()),
                ("NONE", NONE.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Writes the range of each cell of `band` to `ranges`. `map` holds the rows of the half-size map that `band`
    /// names, one `i32` per pixel.
    pub fn prepare(&self, band: &CellBand, map: &wgpu::Buffer, ranges: &wgpu::Buffer) -> Dispatch {
        let params = Params {
            width: band.map_width,
            rows: band.map_rows,
            first_row: band.map_start,
            columns: band.columns,
            cell_rows: band.rows,
            min_disparity: band.range.min,
            disparities: band.range.count,
        };
        let groups = [band.columns.div_ceil(CELLS), band.rows.div_ceil(CELLS), 1];
        self.0.dispatch(&params, &[map, ranges], groups)
    }
}
