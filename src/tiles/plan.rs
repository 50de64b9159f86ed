//! Which tiles a picture has, and what each is matched from.

use crate::{
    dense::{DenseConfig, Pyramid, View, pyramid::SIDE},
    error::{Result, check},
    image::{Plane, Size},
};

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Area {
    /// Column of the left-most pixels.
    pub x: u32,
    /// Row of the uppermost pixels.
    pub y: u32,
    /// Width and height, in pixels.
    pub size: Size,
}

impl Area {
    /// The pixels of `columns` and `rows`, from the first to before the second.
    fn between(columns: [u32; 2], rows: [u32; 2]) -> Self {
        Self { x: columns[0], y: rows[0], size: Size::new(columns[1] - columns[0], rows[1] - rows[0]) }
    }

    /// The part of a plane.
    ///
    /// # Panics
    /// If it reaches beyond the plane.
    pub fn cut<T: Clone>(&self, plane: &Plane<T>) -> Plane<T> {
        let columns = self.x as usize..(self.x + self.size.width) as usize;
        let rows = (self.y..self.y + self.size.height).flat_map(|y| plane.row(y)[columns.clone()].to_vec());
        Plane::new(self.size, rows.collect()).expect("a part of a plane")
    }
}

/// A tile of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// The pixels whose disparities the tile gives.
    pub core: Area,
    /// The pixels of both views that it is matched from.
    pub view: Area,
}

/// How a picture is cut into tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiling {
    /// Side of a core, in pixels, at least 256; those at the right and at the lower edge may be smaller.
    pub side: u32,
    /// Least margin of a view on each side of its core, in pixels, 0 to 65,536, besides the disparities: [`Self::MARGIN`] if nothing else
    /// is known.
    pub margin: u32,
}

impl Tiling {
    /// The usual margin: of two maps of 20 megapixels 0.1 to 0.4 % of the disparities in tiles differ from those of the whole picture by over
    /// half a pixel, nearly all of them filled or hardly measured, and up to 0.8 % beside seams; 768 px make it nothing.
    pub const MARGIN: u32 = 256;

    /// Cores of `side` px with the usual margin.
    pub const fn of(side: u32) -> Self {
        Self { side, margin: Self::MARGIN }
    }

    /// Checks that both values lie in their ranges.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        check(self.side >= 256, "tiles", self.side, "a tile is at least 256 px wide and high")?;
        check(self.margin <= 1 << 16, "the margin of tiles", self.margin, "it must be 0 to 65536 px")
    }

    /// The tiles of a picture of `size` that is matched by `config`, row by row.
    pub fn tiles(&self, size: Size, config: &DenseConfig) -> Vec<Tile> {
        // Pictures are halved, and their cells begin, at the same pixels as those of the whole picture.
        let unit = SIDE << (levels(config, size) - 1);
        let reach = Reach::of(config);
        let starts = |length: u32| (0..length).step_by(self.side as usize);
        let tile = |x: u32, y: u32| {
            let columns = [x, (x + self.side).min(size.width)];
            let rows = [y, (y + self.side).min(size.height)];
            let down = |at: u32, by: u32| at.saturating_sub(by) / unit * unit;
            let up = |at: u32, by: u32, most: u32| at.saturating_add(by).min(most);
            let left = down(columns[0], self.margin.saturating_add(reach.left));
            let right = up(columns[1], self.margin.saturating_add(reach.right), size.width);
            // A view that is narrower than the range would be searched in less of it.
            let right = right.max(up(left, reach.left.max(reach.right) + 1, size.width));
            let left = left.min(down(right, reach.left.max(reach.right) + 1));
            let view = [[left, right], [down(rows[0], self.margin), up(rows[1], self.margin, size.height)]];
            Tile { core: Area::between(columns, rows), view: Area::between(view[0], view[1]) }
        };
        starts(size.height).flat_map(|y| starts(size.width).map(move |x| (x, y))).map(|(x, y)| tile(x, y)).collect()
    }
}

/// The number of levels over which a picture is searched.
pub(super) fn levels(config: &DenseConfig, size: Size) -> u32 {
    Pyramid::of(config, size).map_or(1, |pyramid| pyramid.levels().len() as u32)
}

/// How far to the left and to the right of a pixel of either view its partner lies at most, in pixels.
struct Reach {
    left: u32,
    right: u32,
}

impl Reach {
    fn of(config: &DenseConfig) -> Self {
        let (least, most) = (config.range.min, config.range.last());
        let [near, far] = [most.max(0).unsigned_abs(), least.min(0).unsigned_abs()];
        match config.reference {
            View::Left => Self { left: near, right: far },
            View::Right => Self { left: far, right: near },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{config::Preset, disparity::DisparityRange};

    fn config(min: i32, last: i32) -> DenseConfig {
        Preset::Quality.dense_config(DisparityRange::inclusive(min, last).expect("a range"))
    }

    #[test]
    fn tiles_by_hand() {
        let tiling = Tiling { side: 300, margin: 40 };
        let tiles = tiling.tiles(Size::new(700, 310), &config(-3, 50));
        assert_eq!(tiles.len(), 6);
        let ends = |area: Area| [area.x, area.x + area.size.width, area.y, area.y + area.size.height];
        assert_eq!(ends(tiles[1].core), [300, 600, 0, 300]);
        // 300 - 40 - 50 is 210, and cells begin at 192; 600 + 40 + 3.
        assert_eq!(ends(tiles[1].view), [192, 643, 0, 310]);
        assert_eq!(ends(tiles[5].core), [600, 700, 300, 310]);
        assert_eq!(ends(tiles[5].view), [480, 700, 256, 310]);
        let from_right = DenseConfig { reference: View::Right, ..config(-3, 50) };
        assert_eq!(ends(tiling.tiles(Size::new(700, 310), &from_right)[1].view), [256, 690, 0, 310]);
    }

    #[test]
    fn cores_cover_the_picture_once_and_views_hold_their_cores_and_the_range() {
        for (size, side, range) in [
            ((1000, 600), 256, (0, 200)),
            ((257, 300), 256, (-250, 10)),
            ((90, 70), 256, (5, 80)),
            ((999, 1), 300, (700, 900)),
        ] {
            let (size, config) = (Size::from(size), config(range.0, range.1));
            let mut covered = Plane::filled(size, 0_u8);
            for Tile { core, view } in Tiling::of(side).tiles(size, &config) {
                for (x, y) in (0..core.size.height).flat_map(|y| (0..core.size.width).map(move |x| (x, y))) {
                    covered.set(core.x + x, core.y + y, covered.get(core.x + x, core.y + y) + 1);
                }
                assert!(view.x <= core.x && view.x + view.size.width >= core.x + core.size.width, "{view:?}");
                assert!(view.y <= core.y && view.y + view.size.height >= core.y + core.size.height, "{view:?}");
                let searched = config.searched(size.width).expect("a range");
                assert_eq!(config.searched(view.size.width).expect("a range"), searched, "{view:?}");
            }
            assert!(covered.data().iter().all(|&count| count == 1), "{size}");
        }
    }
}
