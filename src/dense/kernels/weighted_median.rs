//! The weighted median of a map. `shaders/dense/weighted_median.wgsl` and `tile_weighted_median.wgsl`.

use super::windows::Text;
use crate::{
    dense::config::Median,
    disparity::NONE,
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, Windows, shader_struct},
    image::Size,
};

/// A sentinel above any disparity.
const FARTHEST: i64 = 1 << 30;

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        luma_start: u32,
    }
}

/// Side of the window, in pixels.
fn side(median: Median) -> u32 {
    2 * median.radius + 1
}

/// The weighted-median kernel.
#[derive(Debug)]
pub struct WeightedMedian {
    kernel: Kernel,
    /// Pixels per workgroup along x and y.
    tile: [u32; 2],
}

impl WeightedMedian {
    /// Source, bindings and constants of the kernel.
    pub fn stage(median: Median, windows: Windows) -> Stage {
        Self::text(median, windows).stage(
            &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            vec![
                ("RADIUS", median.radius.into()),
                ("SIDE", side(median).into()),
                ("HALVING_BITS", median.halving_bits.into()),
                ("FARTHEST", FARTHEST),
                ("NONE", NONE.into()),
            ],
        )
    }

    fn text(median: Median, windows: Windows) -> Text {
        match windows {
            Windows::Rows => Text::rows(
                "weighted_median",
                include_str!("../../../shaders/dense/weighted_median.wgsl"),
                vec![("KEPT", (side(median) - 1).into()), ("SPAN", (side(median) + 3).into())],
            ),
            Windows::Tiles => Text {
                name: "tile_weighted_median",
                source: include_str!("../../../shaders/dense/tile_weighted_median.wgsl"),
                workgroup: [16, 8],
                pixels: [1, 1],
                constants: Vec::new(),
            },
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, median: Median, windows: Windows) -> Self {
        let kernel = Kernel::new(gpu, &Self::stage(median, windows));
        Self { kernel, tile: Self::text(median, windows).tile() }
    }

    /// Filters `disparities` into `filtered`, weighted by packed `luma` of their view; `first_row` is the row of the
    /// luma of their first row.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        (luma, first_row): (&wgpu::Buffer, u32),
        disparities: &wgpu::Buffer,
        filtered: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params { width, height, luma_start: first_row * width.div_ceil(4) };
        let groups = [width.div_ceil(self.tile[0]), height.div_ceil(self.tile[1]), 1];
        self.kernel.dispatch(&params, &[luma, disparities, filtered], groups)
    }
}
