//! Block matching: SAD, winner-take-all, uniqueness and sub-pixel. `shaders/dense/block_match.wgsl`.

use super::{
    cells::{HALF_GRAIN, Ranges},
    map_buffer::MapBuffer,
    pad::PadParams,
    selection::{ResultKind, selection_constants},
};
use crate::{
    dense::config::{DenseConfig, DenseParameters, View},
    disparity::{DisparityRange, SCALE},
    error::Result,
    gpu::{Binding, Dispatch, Gpu, Kernel, ROW_BITS, ShaderType, Stage, WordTexture, shader_struct},
    image::Size,
};

/// The pixels that one thread matches, and the tiles that a workgroup does.
///
/// A larger tile shares more of its row sums and loads; a smaller one needs fewer registers and less
/// time to compile, and leaves more threads. The result is the same. Where each cell has a range of its own, a
/// tile must lie in one cell, and the threads that run in step should in few: all of them wait for the longest range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Columns, in fours.
    pub quads: u32,
    /// Rows.
    pub height: u32,
    /// Tiles of a workgroup in a row; its threads take them row by row.
    pub across: u32,
    /// Rows of tiles of a workgroup.
    pub down: u32,
}

impl Tile {
    /// For lavapipe, where loads are the bottleneck, registers spill into the first cache and eight threads run in
    /// step: in two cells. Other drivers that compute on the CPU take minutes to compile it: SwiftShader five for a
    /// window of 11.
    pub const SOFTWARE: Self = Self { quads: 2, height: 8, across: 2, down: 4 };

    /// For all others: GPUs would rather run many threads of few registers.
    pub const HARDWARE: Self = Self { quads: 1, height: 4, across: 8, down: 8 };

    /// The tile for `device`.
    pub fn of(gpu: &Gpu) -> Self {
        if gpu.is_lavapipe() { Self::SOFTWARE } else { Self::HARDWARE }
    }
}

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        stride: u32,
        reference_start: u32,
        searched_start: u32,
        min_disparity: i32,
        skipped: u32,
        cell_shift: u32,
        cell_columns: u32,
        uniqueness: u32,
        confidence_offset: u32,
        max_difference: u32,
        others_first_row: i32,
        others_width: u32,
    }
}

/// The block-matching kernel for one view, one window and one interpolation.
#[derive(Debug)]
pub struct BlockMatch {
    kernel: Kernel,
    view: View,
    uniqueness: u32,
    /// How coarse the other view's disparities are, in 1/256 px.
    grain: u32,
    tile: Tile,
}

/// How far a padded row goes beyond the picture: the radius in whole words.
fn margin(radius: u32) -> u32 {
    radius.next_multiple_of(4)
}

impl BlockMatch {
    /// What the kernel is made of.
    pub fn stage(parameters: &DenseParameters, view: View, wanted: ResultKind, tile: Tile) -> Stage {
        let radius = parameters.radius();
        let constant = |value: u32| i64::from(value);
        // To the left the words that a step brings come in front, to the right behind.
        let (direction, front) = match view {
            View::Left => (-1, 4),
            View::Right => (1, 0),
        };
        Stage {
            name: "block_match",
            source: include_str!("../../../shaders/dense/block_match.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Words, Binding::Read, Binding::Words, Binding::Write],
            constants: [
                ("TILES_ACROSS", constant(tile.across)),
                ("TILES_DOWN", constant(tile.down)),
                ("TILE_HEIGHT", constant(tile.height)),
                ("SIDE", constant(parameters.window())),
                ("ROWS", constant(tile.height + 2 * radius)),
                ("QUADS", constant(tile.quads)),
                ("SPAN", constant(4 * tile.quads + parameters.window() - 1)),
                ("WORDS", constant(2 * margin(radius) / 4 + tile.quads)),
                ("FIRST", constant(margin(radius) - radius)),
                ("SEARCHED_FIRST", constant(margin(radius) - radius + front)),
                ("DIRECTION", direction),
                ("START", i64::from(view == View::Right)),
                ("HALVED", parameters.is_coarse_to_fine().into()),
                ("ROW_BITS", ROW_BITS.into()),
                ("SCALE_BITS", SCALE.ilog2().into()),
            ]
            .into_iter()
            .chain(selection_constants(parameters.interpolation, wanted, parameters.index_bits()))
            .collect(),
        }
    }

    /// Compiles it for the window, the interpolation and the uniqueness of `parameters`, and `view` as the reference.
    pub fn new(gpu: &Gpu, parameters: &DenseParameters, view: View, wanted: ResultKind, tile: Tile) -> Self {
        let kernel = Kernel::new(gpu, &Self::stage(parameters, view, wanted, tile));
        let grain = if parameters.is_coarse_to_fine() { HALF_GRAIN } else { 0 };
        Self { kernel, view, uniqueness: parameters.uniqueness, grain, tile }
    }

    /// Matches the padded `planes` of `layout` at the disparities that `ranges` name. The map goes to the beginning of
    /// `matches`; of winners there are no confidences. Where there are `others`, a match that they contradict is none.
    pub fn prepare(
        &self,
        layout: &Layout,
        planes: &WordTexture,
        ranges: &Ranges,
        others: Option<ConfirmingMap<'_>>,
        matches: MapBuffer<'_>,
    ) -> Dispatch {
        let [reference_start, searched_start] = layout.starts(self.view);
        let params = Params {
            width: layout.width,
            rows: layout.rows,
            stride: layout.stride(),
            reference_start,
            searched_start,
            min_disparity: layout.range.min,
            skipped: (layout.range.min - 4 * layout.first_step()) as u32,
            cell_shift: ranges.shift,
            cell_columns: ranges.columns,
            uniqueness: self.uniqueness,
            confidence_offset: matches.layout.confidence_offset(),
            max_difference: others.map_or(u32::MAX, |others| others.max_difference + self.grain),
            others_first_row: others.map_or(0, |others| others.first_row),
            others_width: others.map_or(1, |others| others.width),
        };
        let Tile { quads, height, across, down } = self.tile;
        let groups = [layout.width.div_ceil(4 * quads * across), layout.rows.div_ceil(height * down), 1];
        // Where there are none, something has to be bound.
        let others = others.map_or(planes, |others| others.words);
        self.kernel.dispatch(&params, &[&planes.view, &ranges.buffer, &others.view, matches.buffer], groups)
    }
}

/// The other view's winners, which confirm matches: coarse to fine those of pictures of half the size.
#[derive(Clone, Copy, Debug)]
pub struct ConfirmingMap<'a> {
    /// A fixed-point disparity a pixel, row by row.
    pub words: &'a WordTexture,
    /// Pixels of a row.
    pub width: u32,
    /// The row in which the matched band begins.
    pub first_row: i32,
    /// The largest difference, in 1/256 px of the pictures that are matched, between a pixel's disparity and that of its
    /// partner; coarse to fine a pixel more, from twice the disparity of its partner there or of the pixel to the left or
    /// right.
    pub max_difference: u32,
}

/// How the padded planes of a band lie in their buffer: the left one, then the right one. Each
/// reaches so far beyond the picture that no window and no step of a search leaves it.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    width: u32,
    height: u32,
    first_row: u32,
    rows: u32,
    radius: u32,
    range: DisparityRange,
    /// Rows and words a row that are covered by whole tiles.
    tiled_rows: u32,
    tiled_words: u32,
}

impl Layout {
    /// The layout for rows `first_row` to `first_row + rows` of a picture of `size`, for kernels of
    /// this `tile`.
    ///
    /// # Errors
    /// As [`DenseConfig::searched`].
    pub fn new(
        Size { width, height }: Size,
        first_row: u32,
        rows: u32,
        config: &DenseConfig,
        tile: Tile,
    ) -> Result<Self> {
        let range = config.searched(width)?;
        Ok(Self {
            width,
            height,
            first_row,
            rows,
            radius: config.parameters.radius(),
            range,
            tiled_rows: rows.next_multiple_of(tile.height),
            tiled_words: width.div_ceil(4).next_multiple_of(tile.quads),
        })
    }

    /// Width of the picture.
    pub(in crate::dense) fn width(&self) -> u32 {
        self.width
    }

    /// Words of both planes.
    pub fn words(&self) -> u64 {
        2 * u64::from(self.padded_rows()) * u64::from(self.stride())
    }

    /// How the left and the right picture are padded.
    pub fn padding(&self) -> [PadParams; 2] {
        View::ALL.map(|view| PadParams {
            width: self.width,
            height: self.height,
            first_word: -((margin(self.radius) / 4 + self.reach(view)) as i32),
            first_row: self.first_row as i32 - self.radius as i32,
            rows: self.padded_rows(),
            stride: self.stride(),
            offset: self.offset(view),
        })
    }

    /// The words where the first window of `view` begins, and where the other view's does at the first
    /// disparity of the first step.
    fn starts(&self, view: View) -> [u32; 2] {
        let start = |view| self.offset(view) + self.reach(view);
        let first = match view {
            View::Left => -self.first_step(),
            View::Right => self.first_step(),
        };
        [start(view), start(view.other()).wrapping_add_signed(first)]
    }

    /// Words in front of the margin of a plane that searches may reach: in the left picture those
    /// for negative disparities, in the right one those for positive.
    fn reach(&self, view: View) -> u32 {
        let words = match view {
            View::Left => -self.first_step(),
            View::Right => self.first_step() + self.steps() as i32,
        };
        words.max(0) as u32
    }

    fn offset(&self, view: View) -> u32 {
        match view {
            View::Left => 0,
            View::Right => self.padded_rows() * self.stride(),
        }
    }

    fn padded_rows(&self) -> u32 {
        self.tiled_rows + 2 * self.radius
    }

    /// The step of four disparities in which the range begins.
    fn first_step(&self) -> i32 {
        self.range.min.div_euclid(4)
    }

    fn steps(&self) -> u32 {
        (self.range.last().div_euclid(4) - self.first_step() + 1) as u32
    }

    /// Words of a padded row.
    fn stride(&self) -> u32 {
        self.tiled_words + 2 * margin(self.radius) / 4 + self.reach(View::Left) + self.reach(View::Right)
    }
}
