//! Removal of what does not show the scene. `shaders/dense/unseen.wgsl`.

use super::map_buffer::MapBuffer;
use crate::{
    dense::config::View,
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: [u32; 2] = [32, 8];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_row: u32,
        direction: i32,
        loss: u32,
        confidence_offset: u32,
    }
}

/// What a pixel loses whose partner in the other view does not show the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// Nothing.
    Nothing,
    /// Its confidence, which becomes 0.
    Confidence,
    /// Its disparity and its confidence.
    Disparity,
}

impl Loss {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Nothing, Self::Confidence, Self::Disparity];
}

/// The kernel that removes what does not show the scene.
#[derive(Debug)]
pub struct Unseen(Kernel);

impl Unseen {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "unseen",
            source: include_str!("../../../shaders/dense/unseen.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
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

    /// Removes from `map`, which has the rows of `view` from row `first_row` on, what the masks hide: packed bytes of the view and
    /// of the other one.
    pub fn prepare(
        &self,
        map: MapBuffer<'_>,
        first_row: u32,
        view: View,
        [own, other]: [&wgpu::Buffer; 2],
        loss: Loss,
    ) -> Dispatch {
        let (width, rows) = (map.layout.width, map.layout.rows);
        let (direction, confidence_offset) = (view.direction(), map.layout.confidence_offset());
        let params = Params { width, rows, first_row, direction, loss: loss as u32, confidence_offset };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[own, other, map.buffer], groups)
    }
}
