//! Belief propagation: one turn, in which half of the nodes send. `shaders/kamencay/belief.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [8, 8];

/// The smoothness cost of neighbours: `min(slope |difference|, limit)`, a truncated linear model weighted by their
/// link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Smoothness {
    /// Cost per pixel of difference, 1 to `limit`; 14 by default.
    pub slope: u32,
    /// Largest cost, 1 to 255, since a message has 8 bits; 100 by default. With a slope equal to the limit this is the
    /// Potts model.
    pub limit: u32,
}

/// The senders of a turn, and the source of their neighbours' messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Parity, 0 or 1, of column plus row of the sending nodes.
    pub parity: u32,
    /// Whether neighbours' messages are those of their parents, in the grid of half the size.
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

/// The belief propagation kernel, for one number of disparities.
#[derive(Debug)]
pub struct Belief(Kernel);

/// The buffers of a grid.
#[derive(Clone, Copy)]
pub struct GridBuffers<'b> {
    /// Data costs, from [`super::BeliefCost`] or [`super::BeliefReduce`].
    pub costs: &'b wgpu::Buffer,
    /// The weights of the links: see [`crate::kamencay::LinkWeights`].
    pub links: &'b wgpu::Buffer,
    /// Messages of the grid of half the size, if the turn reads them; otherwise any other buffer.
    pub parents: &'b wgpu::Buffer,
    /// Messages of this grid.
    pub messages: &'b wgpu::Buffer,
}

impl Belief {
    /// Source, bindings and constants of the kernel, for `fours` groups of four disparities per node.
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

    /// One turn in a grid of `size`.
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
