//! The data costs of a coarser grid. `shaders/kamencay/belief_reduce.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
    kamencay::grid::FAR,
};

const WORKGROUP: [u32; 2] = [8, 8];

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        words: u32,
    }
}

/// The kernel that sums data costs for the grid of half the size.
#[derive(Debug)]
pub struct BeliefReduce(Kernel);

impl BeliefReduce {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "belief_reduce",
            source: include_str!("../../../shaders/kamencay/belief_reduce.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("FAR", FAR.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Sums the costs of a `fine` grid of `size`, with `fours` groups of four disparities per node, into the `coarse`
    /// grid.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        fours: u32,
        fine: &wgpu::Buffer,
        coarse: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params { width, height, words: 2 * fours };
        let groups = [width.div_ceil(2).div_ceil(WORKGROUP[0]), height.div_ceil(2).div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[fine, coarse], groups)
    }
}
