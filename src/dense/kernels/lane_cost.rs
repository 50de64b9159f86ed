//! The matching cost of each pixel and disparity, with threads across disparities. `shaders/dense/lane_cost.wgsl`.

use super::{
    cost::{COST_OPERATIONS, pixel_constants},
    volume_band::VolumeBand,
};
use crate::{
    dense::config::{Cost, View},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: u32 = 64;

shader_struct! {
    struct Params {
        width: u32,
        first_row: u32,
        min_disparity: i32,
        quads: u32,
    }
}

/// The matching-cost kernel, for one view as the reference and any number of disparities.
#[derive(Debug)]
pub struct LaneCost(Kernel);

impl LaneCost {
    /// Source, bindings and constants of the kernel.
    pub fn stage(cost: &Cost, view: View) -> Stage {
        let mut constants = vec![("WORKGROUP", WORKGROUP.into()), ("DIRECTION", view.direction().into())];
        constants.extend(pixel_constants(cost));
        Stage {
            name: "lane_cost",
            source: include_str!("../../../shaders/dense/lane_cost.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants,
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, cost: &Cost, view: View) -> Self {
        Self(Kernel::new(gpu, &Self::stage(cost, view)))
    }

    /// Writes the cost volume of `band`, as [`super::CostVolume::prepare`] does.
    pub fn prepare(
        &self,
        band: &VolumeBand,
        [reference, other]: [&wgpu::Buffer; 2],
        volume: &wgpu::Buffer,
    ) -> Dispatch {
        let quads = band.words() / 4;
        let params = Params { width: band.width, first_row: band.first_row, min_disparity: band.range.min, quads };
        let groups = [(band.width * quads).div_ceil(WORKGROUP), band.rows, 1];
        self.0.dispatch(&params, &[reference, other, volume], groups).counting(COST_OPERATIONS * band.values())
    }
}
