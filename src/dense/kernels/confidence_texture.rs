//! Confidences of a map, to a texture. `shaders/dense/confidence_texture.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [16, 8];

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
    }
}

/// The kernel that writes confidences.
#[derive(Debug)]
pub struct ConfidenceTexture(Kernel);

impl ConfidenceTexture {
    /// The format of the texture.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "confidence_texture",
            source: include_str!("../../../shaders/dense/confidence_texture.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Map(wgpu::TextureFormat::R32Uint)],
            constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Writes packed `confidences` of a map of this size.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        confidences: &wgpu::Buffer,
        texels: &wgpu::TextureView,
    ) -> Dispatch {
        let groups = [width.div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&Params { width, height }, &[confidences, texels], groups)
    }
}
