//! Filling of holes along rays. `shaders/dense/fill.wgsl`.

use std::ops::Range;

use super::{
    bitmap::Bitmaps,
    map_buffer::{MapBuffer, MapLayout},
    tangent::fit,
};
use crate::{
    dense::config::{FILLED, View},
    disparity::{DisparityRange, NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: u32 = 64;
/// Words of the bitmap per row of a workgroup's tile, and rows of the tile.
const TILE: [u32; 2] = [2, 8];

/// The rays, and the prices of what they find.
pub mod rays {
    /// Longest ray, in rows; rays along the row have no limit.
    pub const LONGEST: u32 = 128;
    /// The largest change by continuation of a plane, in 1/256 px.
    pub const FARTHEST: i32 = 1024;
    /// Price of a difference of 1 in the channel that differs most.
    pub const COLOUR: i32 = 4;
    /// Largest difference in colour that counts.
    pub const COLOUR_LIMIT: i32 = 64;
    /// Price of a partner at which no disparity points.
    pub const UNCLAIMED: i32 = 32;
    /// Price of a partner at which a smaller disparity points.
    pub const HIDING: i32 = 256;
    /// Price of a small surface.
    pub const OF_SMALL: i32 = 128;
    /// Price of a doubtful pixel.
    pub const OF_DOUBTFUL: i32 = 1024;
    /// Largest number of doubtful pixels that a ray passes.
    pub const PASSED: i32 = 8;
    /// Base-2 logarithm of the price that halves the weight.
    pub const HALVING_BITS: u32 = 3;
    /// Base-2 logarithm of the price that lowers the confidence by 1.
    pub const PRICE_BITS: u32 = 4;
}

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        least: i32,
        most: i32,
        direction: i32,
        confidence_offset: u32,
        first_tile_row: u32,
    }
}

/// What the filling reads beside the map.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'b> {
    /// From [`super::Tangents`].
    pub tangents: &'b wgpu::Buffer,
    /// From [`super::Project`].
    pub projected: &'b wgpu::Buffer,
    /// From [`super::Bitmaps`].
    pub bitmaps: &'b wgpu::Buffer,
}

/// The kernel that fills holes.
#[derive(Debug)]
pub struct Fill(Kernel);

impl Fill {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "fill",
            source: include_str!("../../../shaders/dense/fill.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP.into()),
                ("TILE_WORDS", TILE[0].into()),
                ("TILE_ROWS", TILE[1].into()),
                ("RAY", rays::LONGEST.into()),
                ("MARGIN", Bitmaps::MARGIN.into()),
                ("SLOPE_BITS", fit::SLOPE_UNITS.ilog2().into()),
                ("FARTHEST", rays::FARTHEST.into()),
                ("COLOUR", rays::COLOUR.into()),
                ("COLOUR_LIMIT", rays::COLOUR_LIMIT.into()),
                ("UNCLAIMED", rays::UNCLAIMED.into()),
                ("HIDING", rays::HIDING.into()),
                ("OF_SMALL", rays::OF_SMALL.into()),
                ("SMALL", fit::SMALL.into()),
                ("OF_DOUBTFUL", rays::OF_DOUBTFUL.into()),
                ("DOUBTFUL", fit::DOUBTFUL.into()),
                ("PASSED", rays::PASSED.into()),
                ("HALVING_BITS", rays::HALVING_BITS.into()),
                ("FILLED", FILLED.into()),
                ("PRICE_BITS", rays::PRICE_BITS.into()),
                ("SCALE", SCALE.into()),
                ("SCALE_BITS", SCALE.ilog2().into()),
                ("NONE", NONE.into()),
                ("ABOVE", i32::MAX.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Fills the holes in `rows` of a map of `view`, whose confidences are 0 there, with disparities within `range`. A few
    /// rows around these may be filled too.
    pub fn prepare(
        &self,
        range: DisparityRange,
        view: View,
        Surroundings { tangents, projected, bitmaps }: Surroundings<'_>,
        map: MapBuffer<'_>,
        rows: Range<u32>,
    ) -> Dispatch {
        let MapBuffer { buffer, layout } = map;
        let tile_rows = rows.start / TILE[1]..rows.end.div_ceil(TILE[1]);
        let MapLayout { width, rows: height } = layout;
        let params = Params {
            width,
            height,
            least: range.min * SCALE,
            most: range.last() * SCALE,
            direction: view.direction(),
            confidence_offset: layout.confidence_offset(),
            first_tile_row: tile_rows.start,
        };
        let groups = [width.div_ceil(32 * TILE[0]), tile_rows.len() as u32, 1];
        self.0.dispatch(&params, &[tangents, projected, bitmaps, buffer], groups)
    }
}
