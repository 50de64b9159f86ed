//! The matching cost of each pixel at the disparities of its cell. `shaders/dense/cell_cost.wgsl`, `shaders/dense/cost.wgsl`.

use super::{
    cell_layout::{LevelBand, layout_constants},
    cost::{Params, cost_constants, groups},
};
use crate::{
    dense::config::{Cost, View},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage},
};

/// The kernel of matching costs within cells, for one view as the reference.
#[derive(Debug)]
pub struct CellCost {
    kernel: Kernel,
    pixels: u32,
}

impl CellCost {
    /// Source, bindings and constants of the kernel, with so many pixels per thread, a multiple of four.
    pub fn stage(cost: &Cost, view: View, pixels: u32) -> Stage {
        let mut constants = cost_constants(cost, view, pixels);
        constants.extend(layout_constants());
        Stage {
            name: "cell_cost",
            source: concat!(
                include_str!("../../../shaders/dense/cell_cost.wgsl"),
                include_str!("../../../shaders/dense/cost.wgsl")
            ),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write, Binding::Words],
            constants,
        }
    }

    /// Compiles the kernel, with so many pixels per thread, a multiple of four.
    pub fn new(gpu: &Gpu, cost: &Cost, view: View, pixels: u32) -> Self {
        Self { kernel: Kernel::new(gpu, &Self::stage(cost, view, pixels)), pixels }
    }

    /// Writes the costs of `band`, as [`super::CostVolume::prepare`] does; `min_disparity` is that of the whole range.
    pub fn prepare(
        &self,
        band: &LevelBand<'_>,
        min_disparity: i32,
        [reference, other]: [&wgpu::Buffer; 2],
        volume: &wgpu::Buffer,
    ) -> Dispatch {
        let &LevelBand { layout, width, top, first_row, rows } = band;
        let (columns, cells) = (layout.columns, layout.cells);
        let params = Params { width, rows, first_row, min_disparity, pixel_words: 0, top, columns, cells };
        let groups = groups(width, rows, self.pixels);
        self.kernel.dispatch(&params, &[reference, other, volume, &layout.words.view], groups)
    }
}
