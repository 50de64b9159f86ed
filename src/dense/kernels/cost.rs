//! The matching cost of each pixel and disparity. `shaders/dense/cost.wgsl`.

use super::volume_band::VolumeBand;
use crate::{
    dense::config::{Cost, MAX_COST, View, WEIGHT_BITS},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: [u32; 2] = [8, 8];
/// Operations per disparity: differing bits of two census transforms (2 each), differences of luma and gradient with their limits and
/// weights (4 each), their sum and its limit (4).
pub(super) const COST_OPERATIONS: u64 = 16;

/// Pixels of a row per thread on lavapipe, and on other devices: GPUs prefer many threads with few registers.
pub const PIXELS_SOFTWARE: u32 = 16;
/// See [`PIXELS_SOFTWARE`].
pub const PIXELS_HARDWARE: u32 = 4;

/// Pixels of a row per thread on the device of `gpu`.
pub(in crate::dense) fn pixels_per_thread(gpu: &Gpu) -> u32 {
    if gpu.is_lavapipe() { PIXELS_SOFTWARE } else { PIXELS_HARDWARE }
}

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

/// Constants of `shaders/shared/pixel_cost.wgsl`.
pub(super) fn pixel_constants(cost: &Cost) -> [(&'static str, i64); 8] {
    [
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

/// Constants of both kernels of this text, with so many pixels per thread, a multiple of four.
pub(super) fn cost_constants(cost: &Cost, view: View, pixels: u32) -> Vec<(&'static str, i64)> {
    // Each step appends pixels: in front when searching to the left, behind when searching to the right.
    let (direction, front, kept, new) = match view {
        View::Left => (-1, 4, 0, 0),
        View::Right => (1, 1, 4, i64::from(pixels) + 1),
    };
    let mut constants = vec![
        ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
        ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
        ("PIXELS", pixels.into()),
        ("QUADS", (pixels / 4).into()),
        ("DIRECTION", direction),
        ("FRONT", front),
        ("KEPT", kept),
        ("NEW", new),
    ];
    constants.extend(pixel_constants(cost));
    constants
}

/// Workgroups of both kernels of this text.
pub(super) fn groups(width: u32, rows: u32, pixels: u32) -> [u32; 3] {
    [width.div_ceil(pixels * WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1]
}

/// The matching-cost kernel, for one view as the reference.
#[derive(Debug)]
pub struct CostVolume {
    kernel: Kernel,
    pixels: u32,
}

impl CostVolume {
    /// Source, bindings and constants of the kernel, with so many pixels per thread, a multiple of four.
    pub fn stage(cost: &Cost, view: View, pixels: u32) -> Stage {
        Stage {
            name: "cost",
            source: concat!("#import whole_layout\n", include_str!("../../../shaders/dense/cost.wgsl")),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: cost_constants(cost, view, pixels),
        }
    }

    /// Compiles the kernel, with so many pixels per thread, a multiple of four.
    pub fn new(gpu: &Gpu, cost: &Cost, view: View, pixels: u32) -> Self {
        Self { kernel: Kernel::new(gpu, &Self::stage(cost, view, pixels)), pixels }
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
        let groups = groups(band.width, band.rows, self.pixels);
        self.kernel.dispatch(&params, &[reference, other, volume], groups).counting(COST_OPERATIONS * band.values())
    }
}
