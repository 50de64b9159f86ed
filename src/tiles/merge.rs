//! The map of a picture, put together from its tiles.

use super::{cut::of_tiles, plan::Tile};
use crate::{
    dense::{Dense, DenseConfig},
    disparity::NONE,
    error::{Error, Result, check},
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

/// The map of a tile, and what it was matched with.
#[derive(Clone, Debug, PartialEq)]
pub struct TileMap {
    /// The place of the tile.
    pub tile: Tile,
    /// The parameters of its [`super::TilePair`].
    pub config: DenseConfig,
    /// Disparities and confidences of its core.
    pub dense: Dense,
}

/// The map of a picture of `size` that is matched by `config` in `tiles`.
///
/// # Errors
/// [`Error::Parameter`] for maps that are not those of these tiles, each once, all matched over the range and with the parameters of `config`,
/// and with one brightness.
pub(crate) fn merged(size: Size, tiles: &[Tile], config: &DenseConfig, maps: &[TileMap]) -> Result<Dense> {
    let refused = |value: String| {
        Error::Parameter {
        name: "the list of tiles",
        value,
        expected: "all tiles of the pair are needed, cut by one call; on a cluster they are grouped by a name that each pair has alone".into(),
    }
    };
    let expected = of_tiles(config, size);
    for TileMap { config, .. } in maps {
        if config.range != expected.range {
            let [found, pair] =
                [config.range, expected.range].map(|range| format!("{} to {}", range.min, range.last()));
            return Err(refused(format!("of different ranges ({found} and {pair})")));
        }
        if config.brightness != maps[0].config.brightness {
            return Err(refused("of different changes of brightness".into()));
        }
        if (config.reference, config.parameters) != (expected.reference, expected.parameters) {
            return Err(refused("of different options".into()));
        }
    }
    let mut merged = Merged::new(size);
    for tile in tiles {
        let mut of_tile = maps.iter().filter(|map| map.tile == *tile);
        let at = |what| refused(format!("{what} one at ({}, {})", tile.core.x, tile.core.y));
        let map = of_tile.next().ok_or_else(|| at("without"))?;
        if of_tile.next().is_some() {
            return Err(at("with more than"));
        }
        merged.put(tile, &map.dense)?;
    }
    if let Some(TileMap { tile, .. }) = maps.iter().find(|map| !tiles.contains(&map.tile)) {
        return Err(refused(format!("with one that the pair has not ({tile:?})")));
    }
    Ok(merged.into_dense())
}

fn copy<T: Copy>(from: &Plane<T>, Tile { core, .. }: &Tile, to: &mut Plane<T>) {
    let width = to.width() as usize;
    for y in 0..core.size.height {
        let start = (core.y + y) as usize * width + core.x as usize;
        to.data_mut()[start..start + core.size.width as usize].copy_from_slice(from.row(y));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{config::Preset, dense::View, disparity::DisparityRange, tiles::Tiling};

    type Change<'a> = &'a dyn Fn(&mut Vec<TileMap>);

    #[test]
    fn maps_are_those_of_all_tiles_of_one_pair() {
        let size = Size::new(600, 300);
        let config = Preset::Quality.dense_config(DisparityRange::inclusive(2, 40).unwrap());
        let tiles = Tiling::of(256).tiles(size, &config);
        let maps: Vec<TileMap> = (0..)
            .zip(&tiles)
            .map(|(number, &tile)| {
                let size = tile.core.size;
                let dense = Dense { disparity: Plane::filled(size, number), confidence: Plane::filled(size, 9) };
                TileMap { tile, config: of_tiles(&config, Size::new(600, 300)), dense }
            })
            .collect();
        let whole = merged(size, &tiles, &config, &maps).unwrap();
        assert_eq!([(0, 0), (256, 0), (599, 255), (0, 256)].map(|(x, y)| whole.disparity.get(x, y)), [0, 1, 2, 3]);
        let refused = |change: Change<'_>| {
            let mut maps = maps.clone();
            change(&mut maps);
            merged(size, &tiles, &config, &maps).err().map_or_else(String::new, |error| error.to_string())
        };
        let changes: [(&str, Change<'_>); 8] = [
            ("of different ranges (2 to 41 and 2 to 40)", &|maps| maps[1].config.range.count += 1),
            ("of different changes of brightness", &|maps| maps[1].config.brightness.gain += 1),
            ("of different options", &|maps| maps[2].config.reference = View::Right),
            ("of different options", &|maps| maps[2].config.parameters.refinement = None),
            ("without one at (0, 0)", &|maps| _ = maps.remove(0)),
            ("without one at (256, 0)", &|maps| maps[1].tile.view.size.width -= 1),
            ("with more than one at (256, 0)", &|maps| maps.push(maps[1].clone())),
            ("with one that the pair has not", &|maps| {
                let mut other = maps[1].clone();
                other.tile.core.x += 1;
                maps.push(other);
            }),
        ];
        for (told, change) in changes {
            let error = refused(change);
            assert!(
                error.starts_with(&format!("the list of tiles is {told}")) && error.contains("cut by one call"),
                "{error}"
            );
        }
    }
}
