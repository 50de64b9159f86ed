//! What is to be searched in the other view, so that it can answer. `shaders/partner_ranges.wgsl`.

use super::{
    cells::{CELL, CellBand},
    config::View,
};
use crate::gpu::{Binding, Context, Dispatch, Kernel, ShaderType, Stage, shader_struct, uniform_buffer};

const WORKGROUP: u32 = 64;

shader_struct! {
    struct Params {
        columns: u32,
        rows: u32,
        min_disparity: i32,
        direction: i32,
    }
}

/// The kernel that finds the ranges of the other view's cells.
pub struct PartnerRanges(Kernel);

impl PartnerRanges {
    /// What the kernel is made of.
    pub fn stage() -> Stage {
        Stage {
            name: "partner_ranges",
            source: include_str!("../../shaders/partner_ranges.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![("WORKGROUP_WIDTH", WORKGROUP.into()), ("CELL", CELL.into())],
        }
    }

    /// Compiles it.
    pub fn new(device: &Context<'_>) -> Self {
        Self(Kernel::new(device, &Self::stage()))
    }

    /// Writes to `partners` what is to be searched in each cell of the other view, so that every disparity that
    /// `ranges` allow a pixel of `view` is searched from its partner as well.
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        band: &CellBand,
        view: View,
        ranges: &wgpu::Buffer,
        partners: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params {
            columns: band.columns,
            rows: band.rows,
            min_disparity: band.range.min,
            direction: view.direction(),
        };
        let groups = [band.columns.div_ceil(WORKGROUP), band.rows, 1];
        self.0.dispatch(device, &[&uniform_buffer(device, "partner_ranges", &params), ranges, partners], groups)
    }
}
