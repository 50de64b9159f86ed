//! The map of a picture, put together from its tiles.

use super::plan::Tile;
use crate::{
    dense::Dense,
    disparity::NONE,
    error::{Result, check},
    image::{Plane, Size},
};

/// A map in which tiles are put.
#[derive(Clone, Debug)]
pub struct Merged {
    dense: Dense,
}

impl Merged {
    /// A map of `size` without disparities.
    ///
    /// # Panics
    /// If a side is 0.
    pub fn new(size: Size) -> Self {
        Self { dense: Dense { disparity: Plane::filled(size, NONE), confidence: Plane::filled(size, 0) } }
    }

    /// Puts the map of a tile's core in its place.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for a map of another size, and for a tile of another picture.
    pub fn put(&mut self, tile: &Tile, found: &Dense) -> Result<()> {
        let (core, size) = (tile.core, self.dense.disparity.size());
        let end = |first: u32, length: u32| u64::from(first) + u64::from(length);
        let (right, below) = (end(core.x, core.size.width), end(core.y, core.size.height));
        let expected = format!("the tile is {}", core.size);
        check(found.disparity.size() == core.size, "the map of a tile", found.disparity.size(), expected)?;
        let expected = format!("the picture is {size}");
        let is_inside = right <= size.width.into() && below <= size.height.into();
        check(is_inside, "a tile's end", format!("({right}, {below})"), expected)?;
        copy(&found.disparity, tile, &mut self.dense.disparity);
        copy(&found.confidence, tile, &mut self.dense.confidence);
        Ok(())
    }

    /// The map; pixels of tiles that were not put have no disparity.
    pub fn into_dense(self) -> Dense {
        self.dense
    }
}

fn copy<T: Copy>(from: &Plane<T>, Tile { core, .. }: &Tile, to: &mut Plane<T>) {
    let width = to.width() as usize;
    for y in 0..core.size.height {
        let start = (core.y + y) as usize * width + core.x as usize;
        to.data_mut()[start..start + core.size.width as usize].copy_from_slice(from.row(y));
    }
}
