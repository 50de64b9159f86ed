//! Large pictures in tiles: each tile is matched by itself, wherever, and the map is put together.
//!
//! A [`Tile`] has a `core`, the pixels whose disparities it gives, and a `view`, the pixels of both views that it is matched from: the core
//! with a margin on all sides, and further in columns, as far as partners lie. Cores cover the picture without overlap. A [`TilePair`] is
//! what is cut from a prepared pair, and matches itself: integers decide, so that the same tile gives the same bytes on every device and
//! on none.
//!
//! Paths of semi-global matching have no end, so that tiles with any margin differ from the map of the whole picture somewhere. Three
//! things keep them alike: rows, brightness and the bounds of the range are found once, from the whole pair; a tile is searched over a
//! pyramid of as many levels as the picture, each cell of 32x32 pixels in its own range ([`crate::dense::Pyramid`]), and the cells of all
//! levels are those of the picture; and the margin is longer than most paths remember. docs/scale.md has what differs by margin.

mod cut;
mod merge;
mod plan;

pub use cut::TilePair;
pub(crate) use cut::Whole;
pub(crate) use merge::merged;
pub use merge::{Merged, TileMap};
pub use plan::{Area, Tile, Tiling};
