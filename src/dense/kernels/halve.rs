//! A picture of half the size. `shaders/dense/halve.wgsl`.

use crate::gpu::{Binding, Context, Dispatch, Kernel, ShaderType, Stage, shader_struct, uniform_buffer};

const WORKGROUP: [u32; 2] = [16, 8];

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
    }
}

/// The halving kernel.
pub struct Halve(Kernel);

impl Halve {
    /// What the kernel is made of.
    pub fn stage() -> Stage {
        Stage {
            name: "halve",
            source: include_str!("../../../shaders/dense/halve.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
        }
    }

    /// Compiles it.
    pub fn new(device: &Context<'_>) -> Self {
        Self(Kernel::new(device, &Self::stage()))
    }

    /// Writes packed `luma` of a picture of this size, at half the size, to `halved`.
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        (width, height): (u32, u32),
        luma: &wgpu::Buffer,
        halved: &wgpu::Buffer,
    ) -> Dispatch {
        let words = width.div_ceil(2).div_ceil(4);
        let groups = [words.div_ceil(WORKGROUP[0]), height.div_ceil(2).div_ceil(WORKGROUP[1]), 1];
        let params = uniform_buffer(device, "halve", &Params { width, height });
        self.0.dispatch(device, &[&params, luma, halved], groups)
    }
}
