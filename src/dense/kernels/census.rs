//! The census transform, with the luma beside it, and the wide census transform. `shaders/dense/census.wgsl`
//! and `tile_census.wgsl`.

use super::{pad::PadParams, windows::Text};
use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, Windows, shader_struct},
    image::Size,
};

/// Words of four pixels on either side of a row, and rows above and below the picture, as far as the wide census looks.
const HALO_WORDS: u32 = 2;
pub(crate) const HALO_ROWS: u32 = 5;

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        stride: u32,
    }
}

/// The census kernel.
#[derive(Debug)]
pub struct Census {
    kernel: Kernel,
    /// Pixels per workgroup along x and y.
    tile: [u32; 2],
}

impl Census {
    /// Source, bindings and constants of the kernel. With `weak_spread`, it makes wide census transforms too: texture is
    /// weak where the sums of 3x3 lumas differ by at most that.
    pub fn stage(weak_spread: Option<u32>, windows: Windows) -> Stage {
        Self::text(windows).stage(
            &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            vec![("WIDE", weak_spread.is_some().into()), ("SPREAD", weak_spread.unwrap_or(0).into())],
        )
    }

    fn text(windows: Windows) -> Text {
        match windows {
            Windows::Rows => Text::rows("census", include_str!("../../../shaders/dense/census.wgsl"), Vec::new()),
            Windows::Tiles => Text {
                name: "tile_census",
                source: include_str!("../../../shaders/dense/tile_census.wgsl"),
                workgroup: [8, 8],
                pixels: [4, 1],
                constants: Vec::new(),
            },
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, weak_spread: Option<u32>, windows: Windows) -> Self {
        let kernel = Kernel::new(gpu, &Self::stage(weak_spread, windows));
        Self { kernel, tile: Self::text(windows).tile() }
    }

    /// The padding that the kernel needs of rows `first_row` to `first_row + rows` of a picture
    /// of `size`, from the buffer's first word. Rows outside the picture repeat its edge.
    pub fn padding(Size { width, height }: Size, first_row: i32, rows: u32) -> PadParams {
        PadParams {
            width,
            height,
            first_word: -HALO_WORDS.cast_signed(),
            first_row: first_row - HALO_ROWS.cast_signed(),
            rows: rows + 2 * HALO_ROWS,
            stride: Self::stride(width),
            offset: 0,
        }
    }

    /// Words per row of the padding.
    fn stride(width: u32) -> u32 {
        width.div_ceil(4) + 2 * HALO_WORDS
    }

    /// Transforms the rows in `padded`, laid out as [`Self::padding`] says, to two `u32` per pixel: the 24 census bits
    /// of its window above its luma, and those of the wide census above the mark of weak texture.
    pub fn prepare(
        &self,
        Size { width, height: rows }: Size,
        padded: &wgpu::Buffer,
        census: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params { width, rows, stride: Self::stride(width) };
        let groups = [width.div_ceil(self.tile[0]), rows.div_ceil(self.tile[1]), 1];
        self.kernel.dispatch(&params, &[padded, census], groups)
    }
}
