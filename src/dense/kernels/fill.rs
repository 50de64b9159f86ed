//! Filling of holes along rows. `shaders/dense/fill.wgsl`.

use crate::{
    disparity::{DisparityRange, NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ROW_BITS, ShaderType, Stage, WordTexture, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [16, 4];

/// The slope of a surface that is extrapolated into a hole, and its bounds.
pub mod surface {
    /// Most disparities from which a slope is estimated.
    pub const RUN: i32 = 32;
    /// Fewest disparities for a slope; with fewer the last disparity is repeated.
    pub const SHORTEST: i32 = 12;
    /// The steepest extrapolated slope, in 1/256 px per pixel.
    pub const STEEPEST: i32 = 32;
    /// The largest change along an extrapolated slope, in 1/256 px.
    pub const FARTHEST: i32 = 1024;
}

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        least: i32,
        most: i32,
    }
}

/// The kernel that fills holes.
#[derive(Debug)]
pub struct Fill(Kernel);

impl Fill {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "fill",
            source: include_str!("../../../shaders/dense/fill.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Words, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("RUN", surface::RUN.into()),
                ("SHORTEST", surface::SHORTEST.into()),
                ("STEEPEST", surface::STEEPEST.into()),
                ("FARTHEST", surface::FARTHEST.into()),
                ("SCALE", SCALE.into()),
                ("NONE", NONE.into()),
                ("ROW_BITS", ROW_BITS.into()),
                ("NOTHING", i32::MAX.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Copies `disparities` to `filled` and fills the holes of each row with disparities within `range`.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        range: DisparityRange,
        disparities: &WordTexture,
        filled: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params { width, height, least: range.min * SCALE, most: range.last() * SCALE };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[&disparities.view, filled], groups)
    }
}
