//! Belief propagation: half of the nodes send. `shaders/kamencay/belief.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [8, 8];

/// What it costs that neighbours differ: `min(slope |difference|, limit)`, weighted by their link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Smoothness {
    /// For a disparity of difference.
    pub slope: u32,
    /// At most, 1 to 255: a message has eight bits. With a slope as large this is the Potts model.
    pub limit: u32,
}

/// Who sends in a turn, and what has been sent before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Nodes whose column and row add up to this parity, 0 or 1, send.
    pub parity: u32,
    /// The neighbours' messages are those that their parents sent, in the grid of half the size.
    pub from_parents: bool,
}

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        parity: u32,
        from_parents: u32,
    }
}

/// The kernel of a turn, for one number of disparities.
#[derive(Debug)]
pub struct Belief(Kernel);

/// The buffers of a grid.
#[derive(Clone, Copy)]
pub struct GridBuffers<'b> {
    /// The data costs.
    pub costs: &'b wgpu::Buffer,
    /// The weights of the links: see [`super::Links`].
    pub links: &'b wgpu::Buffer,
    /// The messages in the grid of half the size, where a turn asks for them; else any other buffer.
    pub parents: &'b wgpu::Buffer,
    /// The messages.
    pub messages: &'b wgpu::Buffer,
}

impl Belief {
    /// What the kernel is made of, for so many `fours` of disparities a node.
    pub fn stage(smoothness: &Smoothness, fours: u32) -> Stage {
        Stage {
            name: "belief",
            source: include_str!("../../../shaders/kamencay/belief.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("FOURS", fours.into()),
                ("SLOPE", smoothness.slope.into()),
                ("LIMIT", smoothness.limit.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, smoothness: &Smoothness, fours: u32) -> Self {
        Self(Kernel::new(gpu, &Self::stage(smoothness, fours)))
    }

    /// A turn in a grid of `size`.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        Turn { parity, from_parents }: Turn,
        GridBuffers { costs, links, parents, messages }: GridBuffers<'_>,
    ) -> Dispatch {
        let params = Params { width, height, parity, from_parents: from_parents.into() };
        let groups = [width.div_ceil(2).div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[costs, links, parents, messages], groups)
    }
}
