//! Bitmaps of the pixels that have a disparity, along the axes of rays. `shaders/dense/bitmap.wgsl`.

use crate::{
    disparity::NONE,
    gpu::{Binding, Dispatch, Gpu, Kernel, ROW_BITS, ShaderType, Stage, WordTexture, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [32, 2];

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        first_row: u32,
        is_masked: u32,
    }
}

/// Which pixels of a view are shown.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'b> {
    /// Packed bytes, 0 for a hidden pixel.
    pub mask: &'b wgpu::Buffer,
    /// Row of the mask of the first row of the map.
    pub first_row: u32,
    /// Whether the mask hides pixels; else the buffer may have any content.
    pub is_masked: bool,
}

/// The kernel that makes bitmaps.
#[derive(Debug)]
pub struct Bitmaps(Kernel);

impl Bitmaps {
    /// Columns of the bitmaps beside the picture: pixels per word, since a diagonal crosses as many columns in one.
    pub const MARGIN: u32 = 32;

    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "bitmap",
            source: include_str!("../../../shaders/dense/bitmap.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Words, Binding::Write, Binding::Read],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("MARGIN", Self::MARGIN.into()),
                ("NONE", NONE.into()),
                ("ROW_BITS", ROW_BITS.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Words of the bitmaps of a map of `size`.
    pub fn words(Size { width, height }: Size) -> u64 {
        let rows = u64::from(height) * u64::from(width.div_ceil(32));
        2 * rows + 3 * u64::from(height.div_ceil(32)) * u64::from(width + 2 * Self::MARGIN)
    }

    /// Writes the bitmaps of `disparities`, a map of `size` in a view of which `shown` shows pixels.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        disparities: &WordTexture,
        shown: Shown<'_>,
        bitmaps: &wgpu::Buffer,
    ) -> Dispatch {
        let Shown { mask, first_row, is_masked } = shown;
        let groups = [
            (width + 2 * Self::MARGIN).max(height).div_ceil(WORKGROUP[0]),
            height.div_ceil(32).max(width.div_ceil(32)).div_ceil(WORKGROUP[1]),
            4,
        ];
        let params = Params { width, height, first_row, is_masked: is_masked.into() };
        self.0.dispatch(&params, &[&disparities.view, bitmaps, mask], groups)
    }
}
