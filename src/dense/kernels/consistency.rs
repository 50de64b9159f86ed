//! Left-right consistency. `shaders/dense/consistency.wgsl`.

use super::map_buffer::MapBuffer;
use crate::{
    dense::config::{SUM_INDEX_BITS, View},
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: [u32; 2] = [32, 8];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        direction: i32,
        max_difference: u32,
        confidence_offset: u32,
        min_disparity: i32,
    }
}

/// The form of the other view's disparities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckedAgainst {
    /// One fixed-point disparity per pixel.
    Disparities,
    /// The claims of [`super::Claim`]; the field is the disparity of index 0, in pixels.
    Claims(i32),
}

/// The left-right consistency kernel.
#[derive(Debug)]
pub struct Consistency {
    kernel: Kernel,
    checked_against: CheckedAgainst,
}

impl Consistency {
    /// Source, bindings and constants of the kernel.
    pub fn stage(checked_against: CheckedAgainst) -> Stage {
        Stage {
            name: "consistency",
            source: include_str!("../../../shaders/dense/consistency.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("SCALE", SCALE.into()),
                ("SCALE_BITS", SCALE.ilog2().into()),
                ("NONE", NONE.into()),
                ("CLAIMS", (checked_against != CheckedAgainst::Disparities).into()),
                ("INDEX_BITS", SUM_INDEX_BITS.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, checked_against: CheckedAgainst) -> Self {
        Self { kernel: Kernel::new(gpu, &Self::stage(checked_against)), checked_against }
    }

    /// Drops from the first `rows` rows of `matches` of `view` the disparities that differ by more than
    /// `max_difference` / 256 px from those of the other view.
    pub fn prepare(
        &self,
        matches: MapBuffer<'_>,
        rows: u32,
        view: View,
        max_difference: u32,
        other_disparities: &wgpu::Buffer,
    ) -> Dispatch {
        let min_disparity = match self.checked_against {
            CheckedAgainst::Disparities => 0,
            CheckedAgainst::Claims(min_disparity) => min_disparity,
        };
        let (width, confidence_offset) = (matches.layout.width, matches.layout.confidence_offset());
        let direction = view.direction();
        let params = Params { width, rows, direction, max_difference, confidence_offset, min_disparity };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.kernel.dispatch(&params, &[other_disparities, matches.buffer], groups)
    }
}
