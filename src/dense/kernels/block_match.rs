//! Block matching: SAD, winner-take-all, uniqueness and sub-pixel. `shaders/dense/block_match.wgsl`.

use super::{
    cells::{HALF_GRAIN, Ranges},
    map_buffer::MapBuffer,
    pad::PadParams,
    selection::{ResultKind, SELECTION_OPERATIONS, selection_constants},
    tile_block_match,
};
use crate::{
    dense::config::{DenseConfig, DenseParameters, View},
    disparity::{DisparityRange, SCALE},
    error::Result,
    gpu::{Bindable, Binding, Dispatch, Gpu, Kernel, ROW_BITS, ShaderType, Stage, Windows, WordTexture, shader_struct},
    image::Size,
};

/// The pixels that one thread matches, and the tiles of a workgroup; see also [`Tile::HARDWARE`].
///
/// A larger tile shares more row sums and loads; a smaller one needs fewer registers, compiles faster and leaves more
/// threads. The result is the same. Where each cell has its own range, a tile must lie in one cell, and the lanes that
/// run in lockstep in few cells: all of them wait for the longest range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Columns of a tile, in groups of four.
    pub quads: u32,
    /// Rows of a tile.
    pub height: u32,
    /// Tiles per row of a workgroup; its threads take them row by row.
    pub across: u32,
    /// Rows of tiles per workgroup.
    pub down: u32,
}

/// Side of the largest window whose rows all stay in registers.
const LARGEST_HELD: u32 = 9;

impl Tile {
    /// For lavapipe: eight lanes run in lockstep, over one cell. The state of a thread fits in the L1 cache, where
    /// lavapipe's registers are.
    pub const SMALL: Self = Self { quads: 1, height: 4, across: 4, down: 2 };

    /// For lavapipe and windows whose halo is larger than a small tile: eight lanes run in lockstep, over two cells. Other
    /// CPU drivers compile this tile in minutes.
    pub const LARGE: Self = Self { quads: 2, height: 8, across: 2, down: 4 };

    /// For all other devices, which prefer many threads with few registers: the tile of a whole workgroup, in which a
    /// thread has a column of pixels. See `shaders/dense/tile_block_match.wgsl`.
    pub const HARDWARE: Self = Self { quads: 16, height: 4, across: 1, down: 1 };

    /// The tile of the shape chosen for `gpu`, for windows of `side` pixels.
    pub fn of(gpu: &Gpu, side: u32) -> Self {
        match gpu.shapes().block_match {
            Windows::Rows if side <= LARGEST_HELD => Self::SMALL,
            Windows::Rows => Self::LARGE,
            Windows::Tiles => Self::HARDWARE,
        }
    }

    /// Rows in the middle of the tile and its halo, for windows of `side` pixels, that each step loads again. Small windows
    /// have none: registers are faster. Of large windows all rows that the tile's windows share are loaded again, since
    /// what is held is unrolled.
    fn core(self, side: u32) -> u32 {
        if side > LARGEST_HELD && self.height > 1 { (side + 1).saturating_sub(self.height) } else { 0 }
    }
}

/// Operations per pixel and disparity: an absolute difference (2), running sums of columns and rows (4), and the selection.
const MATCH_OPERATIONS: u64 = 6 + SELECTION_OPERATIONS;

shader_struct! {
    /// Uniforms of both kernels of block matching.
    pub(super) struct Params {
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
    /// Resolution of the other view's disparities, in 1/256 px.
    grain: u32,
    tile: Tile,
}

/// Margin of a padded row on either side of the picture, in pixels: the radius, rounded up to whole words.
pub(super) fn margin(radius: u32) -> u32 {
    radius.next_multiple_of(4)
}

/// Constants of `shaders/shared/block_search.wgsl` and of what it imports.
pub(super) fn search_constants(parameters: &DenseParameters, view: View, kind: ResultKind) -> Vec<(&'static str, i64)> {
    let mut constants = vec![
        ("DIRECTION", view.direction().into()),
        ("HALVED", parameters.is_coarse_to_fine().into()),
        ("ROW_BITS", ROW_BITS.into()),
        ("SCALE_BITS", SCALE.ilog2().into()),
    ];
    constants.extend(selection_constants(parameters.interpolation, kind, parameters.index_bits()));
    constants
}

impl BlockMatch {
    /// Source, bindings and constants of the kernel.
    pub fn stage(parameters: &DenseParameters, view: View, kind: ResultKind, tile: Tile) -> Stage {
        if tile == Tile::HARDWARE {
            return tile_block_match::stage(parameters, view, kind);
        }
        let (radius, side) = (parameters.radius(), parameters.window());
        let core = tile.core(side);
        let constant = |value: u32| i64::from(value);
        // Each step appends words: in front when searching to the left, behind when searching to the right.
        let front = if view == View::Left { 4 } else { 0 };
        Stage {
            name: "block_match",
            source: include_str!("../../../shaders/dense/block_match.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Words, Binding::Read, Binding::Words, Binding::Write],
            constants: [
                ("TILES_ACROSS", constant(tile.across)),
                ("TILES_DOWN", constant(tile.down)),
                ("TILE_HEIGHT", constant(tile.height)),
                ("SIDE", constant(side)),
                ("CORE", constant(core)),
                ("HELD", constant(tile.height + side - 1 - core)),
                ("HELD_SIDE", constant(side - core)),
                ("QUADS", constant(tile.quads)),
                ("SPAN", constant(4 * tile.quads + side - 1)),
                ("WORDS", constant(2 * margin(radius) / 4 + tile.quads)),
                ("FIRST", constant(margin(radius) - radius)),
                ("SEARCHED_FIRST", constant(margin(radius) - radius + front)),
                ("START", i64::from(view == View::Right)),
            ]
            .into_iter()
            .chain(search_constants(parameters, view, kind))
            .collect(),
        }
    }

    /// Compiles the kernel for the window, interpolation and uniqueness of `parameters`, with `view` as the reference.
    pub fn new(gpu: &Gpu, parameters: &DenseParameters, view: View, kind: ResultKind, tile: Tile) -> Self {
        let kernel = Kernel::new(gpu, &Self::stage(parameters, view, kind, tile));
        let grain = if parameters.is_coarse_to_fine() { HALF_GRAIN } else { 0 };
        Self { kernel, view, uniqueness: parameters.uniqueness, grain, tile }
    }

    /// Matches the padded `planes` of `layout` at the disparities of `ranges`. The map goes to the beginning of
    /// `matches`; winners have no confidences. With a `confirming` map, a match that the other view's winners contradict is
    /// dropped.
    pub fn prepare(
        &self,
        layout: &Layout,
        planes: &WordTexture,
        ranges: &Ranges,
        confirming: Option<ConfirmingMap<'_>>,
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
            max_difference: confirming.map_or(u32::MAX, |confirming| confirming.max_difference + self.grain),
            others_first_row: confirming.map_or(0, |confirming| confirming.first_row),
            others_width: confirming.map_or(1, |confirming| confirming.width),
        };
        let Tile { quads, height, across, down } = self.tile;
        let groups = [layout.width.div_ceil(4 * quads * across), layout.rows.div_ceil(height * down), 1];
        // The binding needs a texture even without winners of the other view.
        let confirming_words = confirming.map_or(planes, |confirming| confirming.words);
        let bound: [&dyn Bindable; 4] = [&planes.view, &ranges.buffer, &confirming_words.view, matches.buffer];
        let dispatch = self.kernel.dispatch(&params, &bound, groups);
        // The device alone knows the ranges of cells.
        if ranges.columns > 1 { dispatch } else { dispatch.counting(MATCH_OPERATIONS * layout.pixel_disparities()) }
    }
}

/// The winners of the other view, which confirm matches; coarse to fine, the winners at half size.
#[derive(Clone, Copy, Debug)]
pub struct ConfirmingMap<'a> {
    /// One fixed-point disparity per pixel, row by row.
    pub words: &'a WordTexture,
    /// Pixels per row.
    pub width: u32,
    /// Row of the map in which the matched band begins.
    pub first_row: i32,
    /// Largest accepted difference between a pixel's disparity and its partner's, in 1/256 px of the matched pictures;
    /// coarse to fine, 1 px more is accepted from twice the disparity of the half-size partner or the pixel to its left
    /// or right.
    pub max_difference: u32,
}

/// Layout of a band's padded planes in their buffer: the left plane, then the right one. Their margins are so wide that
/// no window and no search step leaves them.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    width: u32,
    height: u32,
    first_row: u32,
    rows: u32,
    radius: u32,
    range: DisparityRange,
    /// Rows, and words per row, of whole tiles that cover the band.
    tiled_rows: u32,
    tiled_words: u32,
}

impl Layout {
    /// The layout of rows `first_row` to `first_row + rows` of a picture of `size`, for a kernel of `tile`.
    ///
    /// # Errors
    /// See [`DenseConfig::searched`].
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

    /// Pixels of the band times disparities.
    fn pixel_disparities(&self) -> u64 {
        u64::from(self.width) * u64::from(self.rows) * u64::from(self.range.count)
    }

    /// Width of the picture, in pixels.
    pub(in crate::dense) fn width(&self) -> u32 {
        self.width
    }

    /// Words of both planes.
    pub fn words(&self) -> u64 {
        2 * u64::from(self.padded_rows()) * u64::from(self.stride())
    }

    /// The padding of the left and of the right picture.
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

    /// First words of the first windows: in `view`, and in the other view at the first disparity of the first step.
    fn starts(&self, view: View) -> [u32; 2] {
        let start = |view| self.offset(view) + self.reach(view);
        let first = match view {
            View::Left => -self.first_step(),
            View::Right => self.first_step(),
        };
        [start(view), start(view.other()).wrapping_add_signed(first)]
    }

    /// Words in front of a plane's margin that searches can reach: in the left plane for negative disparities, in the
    /// right one for positive ones.
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

    /// The first step of the range; a step has four disparities.
    fn first_step(&self) -> i32 {
        self.range.min.div_euclid(4)
    }

    fn steps(&self) -> u32 {
        (self.range.last().div_euclid(4) - self.first_step() + 1) as u32
    }

    /// Words per padded row.
    fn stride(&self) -> u32 {
        self.tiled_words + 2 * margin(self.radius) / 4 + self.reach(View::Left) + self.reach(View::Right)
    }
}
