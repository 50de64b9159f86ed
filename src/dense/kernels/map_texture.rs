//! Copies disparities from a buffer to a texture. `shaders/dense/map_texture.wgsl`.

use crate::{
    disparity::SCALE,
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: [u32; 2] = [16, 8];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_word: u32,
        first_row: u32,
    }
}

/// The value of a texel of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapTexel {
    /// The disparity in 1/256 px, or [`crate::disparity::NONE`]: [`wgpu::TextureFormat::R32Sint`].
    FixedPoint,
    /// The disparity in pixels, or [`crate::disparity::NONE_IN_PIXELS`]: [`wgpu::TextureFormat::R32Float`].
    Pixels,
}

impl MapTexel {
    /// Both kinds of texel.
    pub const ALL: [Self; 2] = [Self::FixedPoint, Self::Pixels];

    /// The texel of a texture of `format`; `None` for any format but the two.
    pub fn new(format: wgpu::TextureFormat) -> Option<Self> {
        Self::ALL.into_iter().find(|texel| texel.format() == format)
    }

    /// The format of a texture of such texels.
    pub fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::FixedPoint => wgpu::TextureFormat::R32Sint,
            Self::Pixels => wgpu::TextureFormat::R32Float,
        }
    }
}

/// Rows of disparities: their place in the buffer and in the texture.
#[derive(Clone, Copy, Debug)]
pub struct MapRows {
    /// Pixels per row.
    pub width: u32,
    /// Number of rows.
    pub rows: u32,
    /// Offset of the first disparity in the buffer, in words.
    pub first_word: u32,
    /// First row of the texture that is written.
    pub first_row: u32,
}

/// The copying kernel, for one kind of texel.
#[derive(Debug)]
pub struct MapTexture(Kernel);

impl MapTexture {
    /// Source, bindings and constants of the kernel.
    pub fn stage(texel: MapTexel) -> Stage {
        const PARAMS: Binding = Binding::Uniform(Params::SHAPE);
        let (source, bindings): (_, &[Binding]) = match texel {
            MapTexel::FixedPoint => (
                concat!("#import map_fixed_point\n", include_str!("../../../shaders/dense/map_texture.wgsl")),
                &[PARAMS, Binding::Read, Binding::Map(wgpu::TextureFormat::R32Sint)],
            ),
            MapTexel::Pixels => (
                concat!("#import map_pixels\n", include_str!("../../../shaders/dense/map_texture.wgsl")),
                &[PARAMS, Binding::Read, Binding::Map(wgpu::TextureFormat::R32Float)],
            ),
        };
        let mut constants = vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())];
        if texel == MapTexel::Pixels {
            constants.push(("SCALE", SCALE.into()));
        }
        Stage { name: "map_texture", source, bindings, constants }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, texel: MapTexel) -> Self {
        Self(Kernel::new(gpu, &Self::stage(texel)))
    }

    /// Copies rows of `disparities` to `map`.
    pub fn prepare(&self, rows: MapRows, disparities: &wgpu::Buffer, map: &wgpu::TextureView) -> Dispatch {
        let MapRows { width, rows, first_word, first_row } = rows;
        let params = Params { width, rows, first_word, first_row };
        let groups = [width.div_ceil(WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[disparities, map], groups)
    }
}
