//! Tangent planes of the surfaces beside holes. `shaders/dense/tangent.wgsl`.

use crate::{
    disparity::{AT_END, DisparityRange, NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ROW_BITS, ShaderType, Stage, WordTexture, shader_struct},
    image::Size,
};

const WORKGROUP: u32 = 64;
/// Words of the bitmap per row of a workgroup's tile, and rows of the tile.
const TILE: [u32; 2] = [2, 8];

/// The plane that is fitted to a surface, and its bounds.
pub mod fit {
    use crate::disparity::SCALE;

    /// Distance of samples, in pixels.
    pub const STEP: i32 = 4;
    /// Samples on either side of the pixel, along a row or a column.
    pub const STEPS: i32 = 4;
    /// Fewest samples of a plane with slopes; with fewer the plane is level.
    pub const LEAST_SAMPLES: i32 = 8;
    /// Samples inside the picture per sample of a surface that is just not small.
    pub const SMALL_SHARE: i32 = 12;
    /// Mark of a small surface, above its colour.
    pub const SMALL: u32 = 1 << 24;
    /// Samples inside the picture per sample of a surface that is just no speck, and per sample with a disparity; the latter also per
    /// sample of a surface at an end of the range that is just not doubtful.
    pub const SPECK_SHARES: [i32; 2] = [8, 4];
    /// Mark of a doubtful pixel, above its colour.
    pub const DOUBTFUL: u32 = 1 << 25;
    /// Largest difference of a sample from the pixel's disparity, in 1/256 px.
    pub const TOLERANCE: i32 = 2 * SCALE;
    /// Units of a slope per 1/256 px per pixel.
    pub const SLOPE_UNITS: i32 = 16 * STEP;
    /// Largest slopes along a row and along a column, in units.
    pub const STEEPEST: [i32; 2] = [48 * SLOPE_UNITS, 128 * SLOPE_UNITS];
    /// Rounds of Gauss-Seidel.
    pub const ROUNDS: u32 = 3;
}

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        low_end: i32,
        high_end: i32,
    }
}

/// The kernel that fits planes beside holes.
#[derive(Debug)]
pub struct Tangents(Kernel);

impl Tangents {
    /// How far the samples of a plane are from its pixel, in pixels.
    pub const RADIUS: u32 = (fit::STEP * fit::STEPS) as u32;

    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "tangent",
            source: include_str!("../../../shaders/dense/tangent.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Words, Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP.into()),
                ("TILE_WORDS", TILE[0].into()),
                ("TILE_ROWS", TILE[1].into()),
                ("STEP", fit::STEP.into()),
                ("STEPS", fit::STEPS.into()),
                ("SIDE", (2 * fit::STEPS + 1).into()),
                ("LEAST_SAMPLES", fit::LEAST_SAMPLES.into()),
                ("SMALL_SHARE", fit::SMALL_SHARE.into()),
                ("SMALL", fit::SMALL.into()),
                ("SPECK_SHARE", fit::SPECK_SHARES[0].into()),
                ("KNOWN_SHARE", fit::SPECK_SHARES[1].into()),
                ("DOUBTFUL", fit::DOUBTFUL.into()),
                ("TOLERANCE", fit::TOLERANCE.into()),
                ("STEEPEST_X", fit::STEEPEST[0].into()),
                ("STEEPEST_Y", fit::STEEPEST[1].into()),
                ("ROUNDS", fit::ROUNDS.into()),
                ("SCALE", SCALE.into()),
                ("NONE", NONE.into()),
                ("ROW_BITS", ROW_BITS.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Words of the tangents of a map of `size`, three per pixel, and of the picture behind them.
    pub fn words(size: Size) -> u64 {
        4 * size.pixels()
    }

    /// The first word of the picture, one `u32` per pixel with red in its lowest byte.
    pub fn picture_offset(size: Size) -> u64 {
        3 * size.pixels()
    }

    /// Fits planes to the `disparities` beside holes, which `bitmaps` mark; the picture behind the `tangents` has the
    /// colours of the same pixels. Disparities at an end of the searched `range` are doubtful.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        range: DisparityRange,
        disparities: &WordTexture,
        bitmaps: &wgpu::Buffer,
        tangents: &wgpu::Buffer,
    ) -> Dispatch {
        let groups = [width.div_ceil(32 * TILE[0]), height.div_ceil(TILE[1]), 1];
        // No view sees farther than 0: there nothing goes on.
        let low_end = if range.min == 0 { NONE } else { SCALE * range.min + AT_END };
        let params = Params { width, height, low_end, high_end: SCALE * range.last() - AT_END };
        self.0.dispatch(&params, &[&disparities.view, bitmaps, tangents], groups)
    }
}
