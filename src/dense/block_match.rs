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

/// The pixels that one thread matches.
///
/// A larger tile shares more of its row sums and loads; a smaller one needs fewer registers and less
/// time to compile, and leaves more threads. The result is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Columns, in fours.
    pub quads: u32,
    /// Rows.
    pub height: u32,
}

impl Tile {
    /// For drivers that compute on the CPU: measured on lavapipe, where loads are the bottleneck and
    /// registers spill into the first cache.
    pub const SOFTWARE: Self = Self { quads: 2, height: 8 };

    /// For GPUs, which would rather run many threads of few registers.
    pub const HARDWARE: Self = Self { quads: 1, height: 4 };

    /// The same where only winners are wanted, of which there is less to remember.
    pub const SOFTWARE_WINNERS: Self = Self { quads: 2, height: 16 };

    /// The tile for `device`.
    pub fn of(device: &wgpu::Device, wanted: Wanted) -> Self {
        match (device.adapter_info().device_type, wanted) {
            (wgpu::DeviceType::Cpu, Wanted::Matches) => Self::SOFTWARE,
            (wgpu::DeviceType::Cpu, Wanted::Winners) => Self::SOFTWARE_WINNERS,
            _ => Self::HARDWARE,
        }
    }
}

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
    confidence_offset: u32,
}

/// What is wanted of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Sub-pixel disparities that pass the uniqueness check, and confidences.
    Matches,
    /// Whole disparities of all winners: enough for the other view's consistency check.
    Winners,
}

/// The block-matching kernel for one window and one interpolation.
pub struct BlockMatch {
    kernel: Kernel,
    uniqueness: u32,
    tile: Tile,
}

/// How far a padded row goes beyond the picture: the radius in whole words.
fn margin(radius: u32) -> u32 {
    radius.next_multiple_of(4)
}

impl BlockMatch {
    /// What the kernel is made of.
    pub fn stage(config: &DenseConfig, wanted: Wanted, tile: Tile) -> Stage {
        let radius = config.radius();
        let constant = |value: u32| i64::from(value);
        Stage {
            name: "block_match",
            source: include_str!("../../shaders/block_match.wgsl"),
            bindings: &[Binding::Uniform(size_of::<Params>() as u64), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", constant(WORKGROUP[0])),
                ("WORKGROUP_HEIGHT", constant(WORKGROUP[1])),
                ("TILE_HEIGHT", constant(tile.height)),
                ("SIDE", constant(config.window)),
                ("ROWS", constant(tile.height + 2 * radius)),
                ("QUADS", constant(tile.quads)),
                ("SPAN", constant(4 * tile.quads + config.window - 1)),
                ("WORDS", constant(2 * margin(radius) / 4 + tile.quads)),
                ("FIRST", constant(margin(radius) - radius)),
                ("SHIFT", constant(config.index_bits())),
                ("SCALE", SCALE.into()),
                ("NONE", NONE.into()),
                ("FULL", (wanted == Wanted::Matches).into()),
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

    /// Compiles it for `config`'s window, interpolation and uniqueness.
    pub fn new(device: &wgpu::Device, config: &DenseConfig, wanted: Wanted, tile: Tile) -> Self {
        let kernel = Kernel::new(device, &Self::stage(config, wanted, tile));
        Self { kernel, uniqueness: config.uniqueness, tile }
    }

    /// Matches the padded `planes` of `layout`, writing a fixed-point disparity for each pixel of
    /// the band to `matches` and, if wanted, a confidence (0 to 255) for each from word
    /// `confidence_offset` on.
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        layout: &Layout,
        view: View,
        planes: &wgpu::Buffer,
        matches: &wgpu::Buffer,
        confidence_offset: u32,
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
            uniqueness: self.uniqueness,
            mirrored: (view == View::Right).into(),
            confidence_offset,
        };
        let Tile { quads, height } = self.tile;
        debug_assert_eq!(self.tile, layout.tile);
        let groups = [layout.width.div_ceil(4 * quads * WORKGROUP[0]), layout.rows.div_ceil(height * WORKGROUP[1]), 1];
        let params = uniform_buffer(device, "block_match", &params);
        self.kernel.dispatch(device, &[&params, planes, matches], groups)
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
    tile: Tile,
}

impl Layout {
    /// The layout for rows `first_row` to `first_row + rows` of a picture of `size`.
    ///
    /// # Errors
    /// As [`DenseConfig::searched`].
    pub fn new(
        (width, height): (u32, u32),
        first_row: u32,
        rows: u32,
        config: &DenseConfig,
        tile: Tile,
    ) -> Result<Self> {
        let range = config.searched(width)?;
        Ok(Self { width, height, first_row, rows, radius: config.radius(), range, tile })
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
        self.rows.next_multiple_of(self.tile.height) + 2 * self.radius
    }

    fn steps(&self) -> u32 {
        self.range.count.div_ceil(4)
    }

    fn reference_stride(&self) -> u32 {
        self.width.div_ceil(4).next_multiple_of(self.tile.quads) + 2 * margin(self.radius) / 4
    }

    fn searched_stride(&self) -> u32 {
        self.reference_stride() + self.steps()
    }

    fn searched_offset(&self) -> u32 {
        self.padded_rows() * self.reference_stride()
    }
}
