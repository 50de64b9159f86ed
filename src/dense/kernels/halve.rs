//! Downscaling to half the size. `shaders/dense/halve.wgsl`.

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

/// The halving kernel.
#[derive(Debug)]
pub struct Halve(Kernel);

impl Halve {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "halve",
            source: include_str!("../../../shaders/dense/halve.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Downscales packed `luma` of a picture of this size to half its size, in `halved`.
    pub fn prepare(&self, Size { width, height }: Size, luma: &wgpu::Buffer, halved: &wgpu::Buffer) -> Dispatch {
        let words = width.div_ceil(2).div_ceil(4);
        let groups = [words.div_ceil(WORKGROUP[0]), height.div_ceil(2).div_ceil(WORKGROUP[1]), 1];
        let params = Params { width, height };
        self.0.dispatch(&params, &[luma, halved], groups)
    }
}
