//! The other view's disparities, claimed by the winners of one view. `shaders/dense/claim.wgsl`.

use super::{map_buffer::MapBuffer, volume_band::VolumeBand};
use crate::{
    dense::config::{SUM_INDEX_BITS, View},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: [u32; 2] = [64, 4];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        min_disparity: i32,
        direction: i32,
        key_offset: u32,
    }
}

/// The kernel in which each pixel claims its partner.
#[derive(Debug)]
pub struct Claim(Kernel);

impl Claim {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "claim",
            source: include_str!("../../../shaders/dense/claim.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("INDEX_BITS", SUM_INDEX_BITS.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Lets the pixels of `band` of `view`, whose keys follow `matches`, claim their partners in `claims`, which must
    /// be cleared to 0 before.
    pub fn prepare(&self, band: &VolumeBand, view: View, matches: MapBuffer<'_>, claims: &wgpu::Buffer) -> Dispatch {
        self.prepare_rows(band.rows, band.range.min, view, matches, claims)
    }

    /// The same for the first `rows` rows of `matches`, with the disparity `min_disparity` of index 0, in pixels.
    pub(in crate::dense) fn prepare_rows(
        &self,
        rows: u32,
        min_disparity: i32,
        view: View,
        matches: MapBuffer<'_>,
        claims: &wgpu::Buffer,
    ) -> Dispatch {
        let (width, key_offset) = (matches.layout.width, matches.layout.key_offset());
        let params = Params { width, rows, min_disparity, direction: view.direction(), key_offset };
        let groups = [width.div_ceil(WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[matches.buffer, claims], groups)
    }
}
