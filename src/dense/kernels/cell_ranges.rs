//! The range of each cell, from a map of half the size. `shaders/dense/cell_ranges.wgsl`.

use super::cells::{CELL, CellBand, REACH};
use crate::{
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

/// Disparities that are searched beyond the rest, at either end: with fewer a winner has no rival two disparities away,
/// and what shows nothing passes for unique.
pub const MARGIN: u32 = 2;

/// Per cent of a cell's pixels that must have a disparity, or the whole range is searched.
pub const LEAST: u32 = 10;

/// The side of the blocks of the map that have a say, each with its third smallest disparity and its third
/// largest.
pub const BLOCK: u32 = 4;

/// Blocks from one cell to the next, of those in and around a cell, and of those that a workgroup looks at, along a side.
const STEP: u32 = CELL / 2 / BLOCK;
const AROUND: u32 = STEP + REACH / BLOCK;
const BLOCKS: u32 = 16;
/// Cells along a side of which a workgroup has all blocks.
const CELLS: u32 = (BLOCKS - AROUND) / STEP + 1;

/// More than any disparity, and less than half of what an `i32` holds.
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

/// The kernel that finds each cell's range.
#[derive(Debug)]
pub struct CellRanges(Kernel);

impl CellRanges {
    /// What the kernel is made of.
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

    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Writes to `ranges` what is to be searched in each cell of `band`, of whose `map` the rows that it names
    /// are there, a word a pixel.
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
