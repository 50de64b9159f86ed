//! Conversion of a texture to packed luma, so that a renderer's pictures need not be read back.
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
        first_column: u32,
        first_row: u32,
    }
}

/// Conversion of a texture format to luma.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TexelFormat {
    /// Whether the format has only a red channel, which is the luma.
    pub grey: bool,
    /// Whether texture loads decode sRGB, so that the kernel must encode it again.
    pub srgb: bool,
}

impl TexelFormat {
    /// The accepted formats.
    ///
    /// - 8-bit formats, sRGB or not: luma is computed from the stored bytes, as if they came from a file.
    /// - 16-bit levels, `R16Unorm`, which needs the feature `TEXTURE_FORMAT_16BIT_NORM`: rounded to 8 bits.
    /// - Video, `NV12`, which needs the feature `TEXTURE_FORMAT_NV12`: the view must be of [`wgpu::TextureAspect::Plane0`], and its levels,
    ///   usually 16 to 235, are the luma as they are. wgpu does not tell a view's aspect.
    /// - Floats: grey or colour levels as displayed, 0 to 1. Values outside are clamped; NaN gives an unspecified
    ///   luma. Linear light must be tone-mapped and encoded for display first. Of a 32-bit float that lies halfway between two bytes
    ///   devices take either.
    pub const ALL: [wgpu::TextureFormat; 11] = [
        wgpu::TextureFormat::Rgba8Unorm,
        wgpu::TextureFormat::Rgba8UnormSrgb,
        wgpu::TextureFormat::Bgra8Unorm,
        wgpu::TextureFormat::Bgra8UnormSrgb,
        wgpu::TextureFormat::R8Unorm,
        wgpu::TextureFormat::R16Float,
        wgpu::TextureFormat::Rgba16Float,
        wgpu::TextureFormat::R16Unorm,
        wgpu::TextureFormat::R32Float,
        wgpu::TextureFormat::Rgba32Float,
        wgpu::TextureFormat::NV12,
    ];

    /// Those of [`Self::ALL`] that every device has, of 8 and 16 bits.
    pub(crate) const USUAL: [wgpu::TextureFormat; 7] = *Self::ALL.first_chunk().expect("seven of eleven");

    /// The conversion of `format`; `None` if it is not in [`Self::ALL`].
    pub fn new(format: wgpu::TextureFormat) -> Option<Self> {
        let grey = || format == wgpu::TextureFormat::NV12 || format.components() == 1;
        Self::ALL.contains(&format).then(|| Self { grey: grey(), srgb: format.is_srgb() })
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

/// The kernel that converts a texture to packed luma.
#[derive(Debug)]
pub struct LumaTexture(Kernel);

impl LumaTexture {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// Converts the texels of `picture`, a view of this format, from column and row `first` on, `size` pixels, to packed `luma`.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        format: TexelFormat,
        (picture, [first_column, first_row]): (&wgpu::TextureView, [u32; 2]),
        luma: &wgpu::Buffer,
    ) -> Dispatch {
        let (grey, linear) = (format.grey.into(), format.srgb.into());
        let params = Params { width, height, grey, linear, first_column, first_row };
        let groups = [width.div_ceil(4).div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[picture, luma], groups)
    }
}
