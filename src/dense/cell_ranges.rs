//! The range of each cell, from a map of half the size. `shaders/cell_ranges.wgsl`.

use super::cells::{CELL, CellBand, REACH};
use crate::{
    disparity::{NONE, SCALE},
    gpu::{Binding, Context, Dispatch, Kernel, ShaderType, Stage, shader_struct, uniform_buffer},
};

/// Per cent of a cell's smallest disparities, and of its largest, that are taken for wrong.
pub const OUTLIERS: u32 = 3;

/// Disparities that are searched beyond the rest, at either end.
pub const MARGIN: u32 = 3;

/// Per cent of a cell's pixels that must have a disparity, or the whole range is searched.
pub const LEAST: u32 = 10;

/// Disparities that are told apart; of longer ranges neighbours are taken together.
const BINS: u32 = 1024;

/// The bits by which an index of so many disparities is shifted to tell no more of them apart than there are bins.
pub fn bin_bits(disparities: u32) -> u32 {
    (0..32).find(|bits| (disparities - 1) >> bits < BINS).unwrap_or(0)
}

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_row: i32,
        columns: u32,
        coarse_min: i32,
        coarse_disparities: u32,
        bin_bits: u32,
        min_disparity: i32,
        disparities: u32,
    }
}

/// The kernel that finds each cell's range.
pub struct CellRanges(Kernel);

impl CellRanges {
    /// What the kernel is made of.
    pub fn stage() -> Stage {
        Stage {
            name: "cell_ranges",
            source: include_str!("../../shaders/cell_ranges.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("SIDE", (CELL / 2).into()),
                ("REACH", (REACH / 2).into()),
                ("OUTLIERS", OUTLIERS.into()),
                ("MARGIN", MARGIN.into()),
                ("LEAST", LEAST.into()),
                ("BINS", BINS.into()),
                ("SCALE", SCALE.into()),
                ("NONE", NONE.into()),
            ],
        }
    }

    /// Compiles it.
    pub fn new(device: &Context<'_>) -> Self {
        Self(Kernel::new(device, &Self::stage()))
    }

    /// Writes to `ranges` what is to be searched in each cell of `band`, of whose `map` the rows that it names
    /// are there, a word a pixel.
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        band: &CellBand,
        map: &wgpu::Buffer,
        ranges: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params {
            width: band.map_width,
            rows: band.map_rows,
            first_row: band.map_start,
            columns: band.columns,
            coarse_min: band.map_range.min,
            coarse_disparities: band.map_range.count,
            bin_bits: bin_bits(band.map_range.count),
            min_disparity: band.range.min,
            disparities: band.range.count,
        };
        let groups = [band.columns, band.rows, 1];
        self.0.dispatch(device, &[&uniform_buffer(device, "cell_ranges", &params), map, ranges], groups)
    }
}
