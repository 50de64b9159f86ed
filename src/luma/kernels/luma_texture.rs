//! A texture's colours to packed luma, so that a renderer's pictures need not be read back.
//! `shaders/luma/luma_texture.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [16, 8];

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        grey: u32,
        linear: u32,
    }
}

/// How the texels of a format become luma.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TexelFormat {
    /// Whether red is all there is, and is the luma.
    pub grey: bool,
    /// Whether loads decode sRGB, so that levels have to be encoded again.
    pub srgb: bool,
}

impl TexelFormat {
    /// The formats that become luma.
    ///
    /// - Of bytes, and of bytes that are declared sRGB, luma is that of the bytes, as if they came out of a file.
    /// - Halves are grey or colour levels as a screen shows them, from 0 to 1; what lies beyond is cut off, and what is not a
    ///   number gives some luma or other. Linear light has to be made ready for a screen first.
    pub const ALL: [wgpu::TextureFormat; 7] = [
        wgpu::TextureFormat::Rgba8Unorm,
        wgpu::TextureFormat::Rgba8UnormSrgb,
        wgpu::TextureFormat::Bgra8Unorm,
        wgpu::TextureFormat::Bgra8UnormSrgb,
        wgpu::TextureFormat::R8Unorm,
        wgpu::TextureFormat::R16Float,
        wgpu::TextureFormat::Rgba16Float,
    ];

    /// How `format` is read; `None` for one that is not among [`Self::ALL`].
    pub fn new(format: wgpu::TextureFormat) -> Option<Self> {
        Self::ALL.contains(&format).then(|| Self { grey: format.components() == 1, srgb: format.is_srgb() })
    }
}

/// The stage.
pub fn stage() -> Stage {
    Stage {
        name: "luma_texture",
        source: include_str!("../../../shaders/luma/luma_texture.wgsl"),
        bindings: &[Binding::Uniform(Params::SHAPE), Binding::Picture, Binding::Write],
        constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
    }
}

/// The kernel.
#[derive(Clone, Debug)]
pub struct LumaTexture(Kernel);

impl LumaTexture {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// Turns the texels of `picture`, whose view has `size` pixels and this format, into packed `luma`.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        format: TexelFormat,
        picture: &wgpu::TextureView,
        luma: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params { width, height, grey: format.grey.into(), linear: format.srgb.into() };
        let groups = [width.div_ceil(4).div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[picture, luma], groups)
    }
}
