//! Disparities from a buffer to a texture. `shaders/dense/map_texture.wgsl`.

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

/// What a texel of a map holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapTexel {
    /// The disparity in 1/256 px, or [`crate::disparity::NONE`]: [`wgpu::TextureFormat::R32Sint`].
    FixedPoint,
    /// The disparity in pixels, or [`crate::disparity::NONE_IN_PIXELS`]: [`wgpu::TextureFormat::R32Float`].
    Pixels,
}

impl MapTexel {
    /// Both.
    pub const ALL: [Self; 2] = [Self::FixedPoint, Self::Pixels];

    /// What a texture of this format holds; `None` for any other.
    pub fn new(format: wgpu::TextureFormat) -> Option<Self> {
        Self::ALL.into_iter().find(|texel| texel.format() == format)
    }

    /// The format of a texture that holds it.
    pub fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::FixedPoint => wgpu::TextureFormat::R32Sint,
            Self::Pixels => wgpu::TextureFormat::R32Float,
        }
    }
}

/// Where rows of disparities lie in their buffer, and where they go.
#[derive(Clone, Copy, Debug)]
pub struct MapRows {
    /// Pixels of a row.
    pub width: u32,
    /// Rows.
    pub rows: u32,
    /// The word of the first disparity.
    pub first_word: u32,
    /// The first row of the texture that is written.
    pub first_row: u32,
}

/// The kernel for one of the formats.
#[derive(Clone, Debug)]
pub struct MapTexture(Kernel);

impl MapTexture {
    /// What it is made of.
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

    /// Compiles it.
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
