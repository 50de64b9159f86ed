//! Block matching with a tile per workgroup: the same as by [`block_match`](super::block_match()).

pub use super::block_match::block_match as tile_match;
