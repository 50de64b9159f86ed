//! From messages to disparities. `shaders/kamencay/belief_select.wgsl`.

use bytemuck::{Pod, Zeroable};

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [8, 8];

/// The bits of a key that hold a disparity's index; the belief, at most 255 and four messages, is above.
pub(super) const INDEX_BITS: u32 = 16;

/// The disparity that a pixel and its neighbours believe in.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Winner {
    key: u32,
    rival: u32,
}

impl Winner {
    /// The disparity of this `index` in its range, its `belief`, and the least belief of those two or more
    /// disparities away, if there are any.
    pub fn new(index: u32, belief: u32, rival: Option<u32>) -> Self {
        Self { key: belief << INDEX_BITS | index, rival: rival.unwrap_or(u32::MAX) }
    }

    /// The disparity's index in its range.
    pub fn index(self) -> u32 {
        self.key & ((1 << INDEX_BITS) - 1)
    }

    /// Its belief, a cost: the lower, the better.
    pub fn belief(self) -> u32 {
        self.key >> INDEX_BITS
    }

    /// By how much the best rival's belief is worse; the largest number where there is no rival.
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

/// The kernel of the selection.
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

    /// Selects in a grid of `size`; a [`Winner`] a pixel.
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
