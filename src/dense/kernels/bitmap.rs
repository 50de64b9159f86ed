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
    }
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
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Words, Binding::Write],
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
        rows + 3 * u64::from(height.div_ceil(32)) * u64::from(width + 2 * Self::MARGIN)
    }

    /// Writes the bitmaps of `disparities`.
    pub fn prepare(&self, Size { width, height }: Size, disparities: &WordTexture, bitmaps: &wgpu::Buffer) -> Dispatch {
        let groups = [
            (width + 2 * Self::MARGIN).max(height).div_ceil(WORKGROUP[0]),
            height.div_ceil(32).max(width.div_ceil(32)).div_ceil(WORKGROUP[1]),
            4,
        ];
        self.0.dispatch(&Params { width, height }, &[&disparities.view, bitmaps], groups)
    }
}
