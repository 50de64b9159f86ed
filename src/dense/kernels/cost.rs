//! The matching cost of each pixel and disparity. `shaders/dense/cost.wgsl`.

use super::volume_band::VolumeBand;
use crate::{
    dense::config::{Cost, MAX_COST, View, WEIGHT_BITS},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: [u32; 2] = [8, 8];
/// Pixels of a row per thread.
const PIXELS: u32 = 16;

shader_struct! {
    /// Uniforms of both cost kernels.
    pub(super) struct Params {
        pub(super) width: u32,
        pub(super) rows: u32,
        pub(super) first_row: u32,
        pub(super) min_disparity: i32,
        pub(super) pixel_words: u32,
        pub(super) top: u32,
        pub(super) columns: u32,
        pub(super) cells: u32,
    }
}

/// Constants of both cost kernels.
pub(super) fn cost_constants(cost: &Cost, view: View) -> Vec<(&'static str, i64)> {
    // Each step appends pixels: in front when searching to the left, behind when searching to the right.
    let (direction, front, kept, new) = match view {
        View::Left => (-1, 4, 0, 0),
        View::Right => (1, 1, 4, i64::from(PIXELS) + 1),
    };
    vec![
        ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
        ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
        ("PIXELS", PIXELS.into()),
        ("QUADS", (PIXELS / 4).into()),
        ("DIRECTION", direction),
        ("FRONT", front),
        ("KEPT", kept),
        ("NEW", new),
        ("CENSUS_WEIGHT", cost.census.into()),
        ("DIFFERENCE_WEIGHT", cost.difference.weight.into()),
        ("DIFFERENCE_LIMIT", cost.difference.limit.into()),
        ("GRADIENT_WEIGHT", cost.gradient.weight.into()),
        ("GRADIENT_LIMIT", cost.gradient.limit.into()),
        ("WEAK_TEXTURE", cost.weak_spread.is_some().into()),
        ("WEIGHT_BITS", WEIGHT_BITS.into()),
        ("MAX_COST", MAX_COST.into()),
    ]
}

/// Workgroups of both cost kernels.
pub(super) fn groups(width: u32, rows: u32) -> [u32; 3] {
    [width.div_ceil(PIXELS * WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1]
}

/// The matching-cost kernel, for one view as the reference.
#[derive(Debug)]
pub struct CostVolume(Kernel);

impl CostVolume {
    /// Source, bindings and constants of the kernel.
    pub fn stage(cost: &Cost, view: View) -> Stage {
        Stage {
            name: "cost",
            source: concat!("#import whole_layout\n", include_str!("../../../shaders/dense/cost.wgsl")),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: cost_constants(cost, view),
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, cost: &Cost, view: View) -> Self {
        Self(Kernel::new(gpu, &Self::stage(cost, view)))
    }

    /// Writes the cost volume of `band`: the pixels of `reference` against those of `other`, both from
    /// [`super::Census`].
    pub fn prepare(
        &self,
        band: &VolumeBand,
        [reference, other]: [&wgpu::Buffer; 2],
        volume: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params {
            width: band.width,
            rows: band.rows,
            first_row: band.first_row,
            min_disparity: band.range.min,
            pixel_words: band.words(),
            ..bytemuck::Zeroable::zeroed()
        };
        self.0.dispatch(&params, &[reference, other, volume], groups(band.width, band.rows))
    }
}
