//! Projection of a map to the other view. `shaders/dense/project.wgsl`.

use crate::{
    dense::config::View,
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [64, 4];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        direction: i32,
    }
}

/// The kernel in which each disparity points at its partner.
#[derive(Debug)]
pub struct Project(Kernel);

impl Project {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "project",
            source: include_str!("../../../shaders/dense/project.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("SCALE", SCALE.into()),
                ("SCALE_BITS", SCALE.ilog2().into()),
                ("NONE", NONE.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Projects the `disparities` of `view` to the other view: to `projected`, which must be cleared to 0 before.
    pub fn prepare(
        &self,
        Size { width, height: rows }: Size,
        view: View,
        disparities: &wgpu::Buffer,
        projected: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params { width, rows, direction: view.direction() };
        let groups = [width.div_ceil(WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[disparities, projected], groups)
    }
}
