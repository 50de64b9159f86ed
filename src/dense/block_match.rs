//! Block matching: SAD, winner-take-all, uniqueness and sub-pixel. `shaders/block_match.wgsl`.

use bytemuck::{Pod, Zeroable};

use super::{
    config::{DenseConfig, Interpolation, View},
    pad::PadParams,
};
use crate::{
    disparity::{DisparityRange, NONE, SCALE},
    error::Result,
    gpu::{Binding, Dispatch, Kernel, Stage, uniform_buffer},
};

const WORKGROUP: [u32; 2] = [8, 8];

/// Rows of a thread's tile. More of them share more of the row sums; fewer need fewer registers.
const TILE_HEIGHT: u32 = 8;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Params {
    width: u32,
    rows: u32,
    reference_stride: u32,
    searched_stride: u32,
    searched_offset: u32,
    min_disparity: i32,
    disparities: u32,
    steps: u32,
    uniqueness: u32,
    mirrored: u32,
}

/// The block-matching kernel for one window and one interpolation.
pub struct BlockMatch {
    kernel: Kernel,
    radius: u32,
}

/// How far a padded row goes beyond the picture: the radius in whole words.
fn margin(radius: u32) -> u32 {
    radius.next_multiple_of(4)
}

impl BlockMatch {
    /// What the kernel is made of.
    pub fn stage(config: &DenseConfig) -> Stage {
        let radius = config.radius();
        let constant = |value: u32| i64::from(value);
        Stage {
            name: "block_match",
            source: include_str!("../../shaders/block_match.wgsl"),
            bindings: &[Binding::Uniform(size_of::<Params>() as u64), Binding::Read, Binding::Write, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", constant(WORKGROUP[0])),
                ("WORKGROUP_HEIGHT", constant(WORKGROUP[1])),
                ("TILE_HEIGHT", constant(TILE_HEIGHT)),
                ("SIDE", constant(config.window)),
                ("ROWS", constant(TILE_HEIGHT + 2 * radius)),
                ("WORDS", constant(2 * margin(radius) / 4 + 1)),
                ("FIRST", constant(margin(radius) - radius)),
                ("SHIFT", constant(config.index_bits())),
                ("SCALE", SCALE.into()),
                ("NONE", NONE.into()),
                ("PARABOLA", 1),
                ("EQUIANGULAR", 2),
                (
                    "INTERPOLATION",
                    match config.interpolation {
                        Interpolation::None => 0,
                        Interpolation::Parabola => 1,
                        Interpolation::Equiangular => 2,
                    },
                ),
            ],
        }
    }

    /// Compiles it for `config`'s window and interpolation.
    pub fn new(device: &wgpu::Device, config: &DenseConfig) -> Self {
        Self { kernel: Kernel::new(device, &Self::stage(config)), radius: config.radius() }
    }

    /// Matches the padded `planes` of `layout`, writing a fixed-point disparity and a confidence
    /// (0 to 255) for each pixel of the band.
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        layout: &Layout,
        uniqueness: u32,
        view: View,
        planes: &wgpu::Buffer,
        [disparities, confidences]: [&wgpu::Buffer; 2],
    ) -> Dispatch {
        let params = Params {
            width: layout.width,
            rows: layout.rows,
            reference_stride: layout.reference_stride(),
            searched_stride: layout.searched_stride(),
            searched_offset: layout.searched_offset(),
            min_disparity: layout.range.min,
            disparities: layout.range.count,
            steps: layout.steps(),
            uniqueness,
            mirrored: (view == View::Right).into(),
        };
        debug_assert_eq!(self.radius, layout.radius);
        let groups = [layout.width.div_ceil(4 * WORKGROUP[0]), layout.rows.div_ceil(TILE_HEIGHT * WORKGROUP[1]), 1];
        let params = uniform_buffer(device, "block_match", &params);
        self.kernel.dispatch(device, &[&params, planes, disparities, confidences], groups)
    }
}

/// How the padded planes of a band lie in their buffer: the reference plane, then the searched one,
/// which reaches further left by the whole range, so that no step of the search leaves it.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    width: u32,
    height: u32,
    first_row: u32,
    rows: u32,
    radius: u32,
    range: DisparityRange,
}

impl Layout {
    /// The layout for rows `first_row` to `first_row + rows` of a picture of `size`.
    ///
    /// # Errors
    /// As [`DenseConfig::searched`].
    pub fn new((width, height): (u32, u32), first_row: u32, rows: u32, config: &DenseConfig) -> Result<Self> {
        let range = config.searched(width)?;
        Ok(Self { width, height, first_row, rows, radius: config.radius(), range })
    }

    /// Words of the buffer that holds both planes.
    pub fn words(&self) -> u64 {
        u64::from(self.padded_rows()) * u64::from(self.reference_stride() + self.searched_stride())
    }

    /// How the two pictures are padded for `view`: the reference, then the searched one.
    pub fn padding(&self, view: View) -> [PadParams; 2] {
        let margin = margin(self.radius) as i32;
        let plane = |first_column, stride, offset| PadParams {
            width: self.width,
            height: self.height,
            first_column,
            first_row: self.first_row as i32 - self.radius as i32,
            rows: self.padded_rows(),
            stride,
            offset,
            mirrored: (view == View::Right).into(),
        };
        let reach = self.range.min + 4 * self.steps() as i32;
        [
            plane(-margin, self.reference_stride(), 0),
            plane(-margin - reach, self.searched_stride(), self.searched_offset()),
        ]
    }

    fn padded_rows(&self) -> u32 {
        self.rows.next_multiple_of(TILE_HEIGHT) + 2 * self.radius
    }

    fn steps(&self) -> u32 {
        self.range.count.div_ceil(4)
    }

    fn reference_stride(&self) -> u32 {
        self.width.div_ceil(4) + 2 * margin(self.radius) / 4
    }

    fn searched_stride(&self) -> u32 {
        self.reference_stride() + self.steps()
    }

    fn searched_offset(&self) -> u32 {
        self.padded_rows() * self.reference_stride()
    }
}
