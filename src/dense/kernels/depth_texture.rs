//! Depths of a map's disparities, to a texture. `shaders/dense/depth_texture.wgsl`.

use crate::{
    dense::reprojection::DepthTable,
    disparity::NONE,
    gpu::{Binding, Dispatch, Gpu, Kernel, ROW_BITS, ShaderType, Stage, WordTexture, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [16, 8];

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        first: i32,
        last: i32,
    }
}

/// The kernel that writes depths.
#[derive(Debug)]
pub struct DepthTexture(Kernel);

impl DepthTexture {
    /// The format of the texture.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "depth_texture",
            source: include_str!("../../../shaders/dense/depth_texture.wgsl"),
            bindings: &[
                Binding::Uniform(Params::SHAPE),
                Binding::Read,
                Binding::Words,
                Binding::Map(wgpu::TextureFormat::R32Float),
            ],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("NONE", NONE.into()),
                ("ROW_BITS", ROW_BITS.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Writes the depths of `disparities`, a map of this size, by `table`, whose words are in `words`.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        disparities: &wgpu::Buffer,
        table: &DepthTable,
        words: &WordTexture,
        depths: &wgpu::TextureView,
    ) -> Dispatch {
        let params = Params { width, height, first: table.first(), last: table.last() };
        let groups = [width.div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[disparities, &words.view, depths], groups)
    }
}
