//! Selection of disparities from messages. `shaders/kamencay/belief_select.wgsl`.

use bytemuck::{Pod, Zeroable};

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [8, 8];

/// Low bits of a key that hold a disparity's index; the belief, at most 255 plus four messages, is above them.
pub(super) const INDEX_BITS: u32 = 16;

/// The disparity of least belief of a pixel.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Winner {
    key: u32,
    rival: u32,
}

impl Winner {
    /// A winner: its `index` in the range, its `belief`, and the least belief of disparities two or more away, if there
    /// are any.
    pub fn new(index: u32, belief: u32, rival: Option<u32>) -> Self {
        Self { key: belief << INDEX_BITS | index, rival: rival.unwrap_or(u32::MAX) }
    }

    /// Index of the disparity in its range.
    pub fn index(self) -> u32 {
        self.key & ((1 << INDEX_BITS) - 1)
    }

    /// Belief of the disparity, a cost: lower is better.
    pub fn belief(self) -> u32 {
        self.key >> INDEX_BITS
    }

    /// The belief of the best rival minus that of the winner; `u32::MAX` without a rival.
    pub fn margin(self) -> u32 {
        if self.rival == u32::MAX { u32::MAX } else { self.rival - self.belief() }
    }
}

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        disparities: u32,
        fours: u32,
    }
}

/// The selection kernel.
#[derive(Debug)]
pub struct BeliefSelect(Kernel);

impl BeliefSelect {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "belief_select",
            source: include_str!("../../../shaders/kamencay/belief_select.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("INDEX_BITS", INDEX_BITS.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Selects the disparities of a grid of `size`: one [`Winner`] per pixel.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        disparities: u32,
        [costs, messages]: [&wgpu::Buffer; 2],
        winners: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params { width, height, disparities, fours: disparities.div_ceil(4) };
        let groups = [width.div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[costs, messages, winners], groups)
    }
}
