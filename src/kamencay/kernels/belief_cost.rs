//! The data cost of belief propagation. `shaders/kamencay/belief_cost.wgsl`.

use crate::{
    dense::config::Difference,
    disparity::DisparityRange,
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
    kamencay::grid::{FAR, Strip},
};

const WORKGROUP: [u32; 2] = [8, 8];

/// The largest data cost of a pixel.
pub const MAX_DATA_COST: u32 = 255;

/// The data cost: the mean of truncated absolute differences over a window, rounded down and at most 255.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowCost {
    /// Radius of the window, (side - 1) / 2, 0 to 7 pixels; 1 by default.
    pub radius: u32,
    /// Difference of colours, the mean of the three channels; its weight is in 1/16.
    pub color: Difference,
    /// Difference of the horizontal gradients of luma; a gradient is the difference of the two neighbours in the row,
    /// at most 127.
    pub gradient: Difference,
}

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        first_row: u32,
        rows: u32,
        min_disparity: i32,
        disparities: u32,
        fours: u32,
    }
}

/// The data-cost kernel.
#[derive(Debug)]
pub struct BeliefCost(Kernel);

impl BeliefCost {
    /// Source, bindings and constants of the kernel.
    pub fn stage(cost: &WindowCost) -> Stage {
        let side = 2 * cost.radius + 1;
        Stage {
            name: "belief_cost",
            source: include_str!("../../../shaders/kamencay/belief_cost.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("RADIUS", cost.radius.into()),
                ("SIDE", side.into()),
                ("SPAN", (side + 3).into()),
                ("COLOUR_WEIGHT", cost.color.weight.into()),
                ("COLOUR_LIMIT", cost.color.limit.into()),
                ("GRADIENT_WEIGHT", cost.gradient.weight.into()),
                ("GRADIENT_LIMIT", cost.gradient.limit.into()),
                ("MAX_COST", MAX_DATA_COST.into()),
                ("FAR", FAR.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, cost: &WindowCost) -> Self {
        Self(Kernel::new(gpu, &Self::stage(cost)))
    }

    /// Writes the data costs of `strip`: the pixels of `left` against those of `right`, views of `size` from
    /// [`crate::kamencay::described`].
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        strip: Strip,
        range: DisparityRange,
        [left, right]: [&wgpu::Buffer; 2],
        costs: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params {
            width,
            height,
            first_row: strip.first_row,
            rows: strip.rows,
            min_disparity: range.min,
            disparities: range.count,
            fours: range.count.div_ceil(4),
        };
        let groups = [width.div_ceil(WORKGROUP[0]), strip.rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[left, right, costs], groups)
    }
}
