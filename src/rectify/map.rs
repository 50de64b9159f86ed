//! Where each pixel of a warped picture lies in its source, in integers.

use std::ops::Range;

use glam::{DVec2, IVec2};

use super::catmull_rom::{SUBPIXEL_BITS, weights};
use crate::{
    error::{Result, check},
    filter::in_parallel,
    image::{Plane, Size},
    luma::{MAX_SIDE, check_size},
};

/// log2 of the largest and of the smallest distance of the map's nodes, in pixels.
const SPACING_BITS: u32 = 4;
const LEAST_SPACING_BITS: u32 = 1;

/// Largest number of nodes, 64 MiB, for which a smaller distance is chosen: half of what every device binds.
const MAX_NODES: u64 = 1 << 23;

/// Largest deviation of a rectifying map from the rectification, in pixels.
pub(super) const TOLERANCE: f64 = 1.0 / 32.0;

/// Coordinates of a node without a position.
pub(crate) const NONE: i32 = i32::MIN;

/// Accepted coordinates of nodes, in pixels: half a side beyond either edge of the largest source. Differences of
/// coordinates in 1/2048 px fit in 32 bits.
const ACCEPTED: Range<f64> = -0.5 * MAX_SIDE as f64..1.5 * MAX_SIDE as f64 - 1.0;

const ONE: i32 = 1 << SUBPIXEL_BITS;

/// For each pixel of a picture the position in a source that the pixel shows.
///
/// Positions are stored at nodes, one per 16 pixels along x and y, rounded to 1/2048 px, and interpolated bilinearly
/// between nodes in integers. An affine map is held to within 1.5/2048 px. A map whose second derivatives are at most `f`,
/// in 1/px, deviates by another `64 f` px at most; [`Self::within`] puts nodes closer where that is too much.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WarpMap {
    size: Size,
    source_size: Size,
    /// log2 of the distance of nodes, in pixels.
    spacing_bits: u32,
    /// Positions at pixels `2^spacing_bits (i, j)`, in 1/2048 px; the last column and the last row lie beyond the edge.
    nodes: Plane<IVec2>,
}

impl WarpMap {
    /// The map from a picture of `size` to a source of `source_size`, both in pixels: pixel `p` shows `source_of(p)`, the
    /// centre of a pixel being a whole number.
    ///
    /// `source_of` is called for the nodes alone, some of them up to 16 px beyond the right and the lower edge. A node has
    /// no position if a coordinate is not finite or outside -2^18 <= p < 3 * 2^18 - 1 px, which is far outside any source.
    /// Pixels between such a node and its neighbours have no position either, and are 0 in the warped picture.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] unless all sides are 1 to [`crate::luma::MAX_SIDE`].
    pub fn new(
        size: impl Into<Size>,
        source_size: impl Into<Size>,
        source_of: impl Fn(DVec2) -> DVec2,
    ) -> Result<Self> {
        Self::with_spacing(SPACING_BITS, size, source_size, &source_of)
    }

    /// As [`Self::new`], with nodes as close as needed for positions to within `tolerance`, in pixels: one per 16, 8, 4 or 2
    /// pixels along x and y.
    ///
    /// Deviations are measured halfway between nodes, where those of bilinear interpolation are largest. Two pixels, and 2^23
    /// nodes, are the end: [`Self::deviation`] tells what is left.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn within(
        tolerance: f64,
        size: impl Into<Size>,
        source_size: impl Into<Size>,
        source_of: impl Fn(DVec2) -> DVec2,
    ) -> Result<Self> {
        let (size, source_size) = (size.into(), source_size.into());
        let mut map = Self::with_spacing(SPACING_BITS, size, source_size, &source_of)?;
        for bits in (LEAST_SPACING_BITS..SPACING_BITS).rev() {
            if node_grid(size, bits).pixels() > MAX_NODES || map.deviation(&source_of) <= tolerance {
                break;
            }
            map = Self::with_spacing(bits, size, source_size, &source_of)?;
        }
        Ok(map)
    }

    /// A map with one node per `2^spacing_bits` pixels along x and y.
    pub(crate) fn with_spacing(
        spacing_bits: u32,
        size: impl Into<Size>,
        source_size: impl Into<Size>,
        source_of: &impl Fn(DVec2) -> DVec2,
    ) -> Result<Self> {
        let (size, source_size) = (size.into(), source_size.into());
        check_size(size)?;
        check_size(source_size)?;
        let nodes = Plane::from_fn(node_grid(size, spacing_bits), |i, j| {
            quantised(source_of((DVec2::new(i.into(), j.into())) * f64::from(1 << spacing_bits)))
        });
        Ok(Self { size, source_size, spacing_bits, nodes })
    }

    /// The largest deviation from `source_of`, in pixels, halfway between nodes, of positions inside the source.
    pub fn deviation(&self, source_of: impl Fn(DVec2) -> DVec2) -> f64 {
        let half = 1 << (self.spacing_bits - 1);
        let Size { width, height } = self.size;
        let places = (0..height).step_by(half).flat_map(|y| (0..width).step_by(half).map(move |x| (x, y)));
        let off = |(x, y): (u32, u32)| {
            let position = self.inside_at(x, y)?.as_dvec2() / f64::from(ONE);
            let off = position - source_of(DVec2::new(x.into(), y.into()));
            // Where `source_of` has no position, its neighbours have: the end of a lens.
            off.is_finite().then(|| off.length())
        };
        places.filter_map(off).fold(0.0, f64::max)
    }

    /// Width and height of the warped picture, in pixels.
    pub fn size(&self) -> Size {
        self.size
    }

    /// Width and height of the source, in pixels.
    pub fn source_size(&self) -> Size {
        self.source_size
    }

    /// log2 of the distance of nodes, in pixels.
    pub(crate) fn spacing_bits(&self) -> u32 {
        self.spacing_bits
    }

    /// Nodes per row.
    pub(crate) fn columns(&self) -> u32 {
        self.nodes.width()
    }

    /// The nodes as the kernel reads them: x and y, row by row.
    pub(crate) fn node_coordinates(&self) -> Vec<[i32; 2]> {
        self.nodes.data().iter().map(IVec2::to_array).collect()
    }

    /// The position in the source that pixel `(x, y)` shows, in 1/2048 px; it can lie outside the source. `None` if a node
    /// around the pixel has no position.
    ///
    /// # Panics
    /// If the pixel lies outside the warped picture.
    pub fn source_at(&self, x: u32, y: u32) -> Option<IVec2> {
        let Size { width, height } = self.size;
        assert!(x < width && y < height, "pixel ({x}, {y}) of {}", self.size);
        let bits = self.spacing_bits;
        let (i, j) = (x >> bits, y >> bits);
        let [across, down] = [x, y].map(|coordinate| coordinate & ((1 << bits) - 1));
        let corners @ [a, b, c, d] =
            [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| self.nodes.get(i, j));
        if corners.iter().any(|node| node.x == NONE) {
            return None;
        }
        Some(between(between(a, c, down, bits), between(b, d, down, bits), across, bits))
    }

    /// Which pixels show the source: 255 where the position lies inside, -0.5 <= p < side - 0.5 along x and y; otherwise 0.
    pub fn visible(&self) -> Plane<u8> {
        in_parallel(self.size, |x, y| mask(self.inside_at(x, y).is_some()))
    }

    /// [`Self::visible`], and 0 also where a pixel that takes part in the interpolation, with any weight but 0, is 0 in
    /// `source_mask`.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] unless `source_mask` has the size of the source.
    pub fn visible_through(&self, source_mask: &Plane<u8>) -> Result<Plane<u8>> {
        self.check_mask(source_mask)?;
        let is_valid =
            |position: IVec2| taps(position.x).all(|x| taps(position.y).all(|y| source_mask.get_clamped(x, y) != 0));
        Ok(in_parallel(self.size, |x, y| mask(self.inside_at(x, y).is_some_and(is_valid))))
    }

    /// [`Self::visible`], and 0 also where the nearest pixel of the source is 0 in `source_mask`: for a source that is continued
    /// beyond the mask.
    ///
    /// # Errors
    /// As [`Self::visible_through`].
    pub fn visible_nearest(&self, source_mask: &Plane<u8>) -> Result<Plane<u8>> {
        self.check_mask(source_mask)?;
        let is_valid = |position: IVec2| {
            let [x, y] = position.to_array().map(|coordinate| i64::from((coordinate + ONE / 2) >> SUBPIXEL_BITS));
            source_mask.get_clamped(x, y) != 0
        };
        Ok(in_parallel(self.size, |x, y| mask(self.inside_at(x, y).is_some_and(is_valid))))
    }

    fn check_mask(&self, source_mask: &Plane<u8>) -> Result<()> {
        let (mask_size, size) = (source_mask.size(), self.source_size);
        check(
            mask_size == size,
            "the mask",
            format_args!("{mask_size} pixels"),
            format!("it must have the source's {size}"),
        )
    }

    /// The position that a pixel shows, if that lies inside the source.
    fn inside_at(&self, x: u32, y: u32) -> Option<IVec2> {
        let is_inside = |p: i32, side: u32| p >= -ONE / 2 && p < side as i32 * ONE - ONE / 2;
        let Size { width, height } = self.source_size;
        self.source_at(x, y).filter(|position| is_inside(position.x, width) && is_inside(position.y, height))
    }
}

/// Rounds a position in pixels to 1/2048 px.
fn quantised(position: DVec2) -> IVec2 {
    if !(ACCEPTED.contains(&position.x) && ACCEPTED.contains(&position.y)) {
        return IVec2::splat(NONE);
    }
    (position * f64::from(ONE) + 0.5).floor().as_ivec2()
}

/// Columns and rows of nodes: the last of each lies beyond the edge of the picture.
fn node_grid(size: Size, spacing_bits: u32) -> Size {
    let count = |side: u32| ((side - 1) >> spacing_bits) + 2;
    Size::new(count(size.width), count(size.height))
}

/// Interpolates linearly, `t` of `2^bits` parts from `a` to `b`, rounded to the nearest, halves up.
fn between(a: IVec2, b: IVec2, t: u32, bits: u32) -> IVec2 {
    let (parts, t) = (1_i64 << bits, i64::from(t));
    ((a.as_i64vec2() * (parts - t) + b.as_i64vec2() * t + parts / 2) >> bits).as_ivec2()
}

/// Columns or rows of the pixels that take part in the interpolation at a coordinate.
fn taps(coordinate: i32) -> impl Iterator<Item = i64> + Clone {
    let first = i64::from(coordinate >> SUBPIXEL_BITS) - 1;
    (first..).zip(weights(coordinate & (ONE - 1))).filter(|&(_, weight)| weight != 0).map(|(pixel, _)| pixel)
}

fn mask(is_set: bool) -> u8 {
    if is_set { 255 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shift(size: (u32, u32), by: DVec2) -> WarpMap {
        WarpMap::new(size, size, |p| p + by).unwrap()
    }

    #[test]
    fn positions_by_hand() {
        // Nodes at x = 0, 16, 32 show 0, 16 and 16 + 1/2 px: halfway between the last two is 16.25 px.
        let map = WarpMap::new((20, 1), (20, 1), |p| DVec2::new(p.x.min(15.5 + p.x / 32.0), -3.0)).unwrap();
        assert_eq!(map.source_at(5, 0), Some(IVec2::new(5 * 2048, -3 * 2048)));
        // 16 * 2048 + 4 * 1024 / 16
        assert_eq!(map.source_at(20 - 1, 0), Some(IVec2::new(16 * 2048 + 192, -3 * 2048)));
        // 1/2048 px over 16 px: rounded, halves up.
        let slow = WarpMap::new((17, 1), (1, 1), |p| p / 16.0 / 2048.0).unwrap();
        assert_eq!([7, 8, 15, 16].map(|x| slow.source_at(x, 0).unwrap().x), [0, 1, 1, 1]);
    }

    #[test]
    fn an_affine_map_is_held_to_within_three_halves_of_a_unit() {
        let of = |p: DVec2| DVec2::new(0.913 * p.x - 0.237 * p.y + 41.3, 0.219 * p.x + 1.071 * p.y - 90.7);
        let map = WarpMap::new((203, 117), (300, 200), of).unwrap();
        for (x, y) in (0..117).flat_map(|y| (0..203).map(move |x| (x, y))) {
            let off = map.source_at(x, y).unwrap().as_dvec2() - 2048.0 * of(DVec2::new(x.into(), y.into()));
            assert!(off.abs().max_element() <= 1.5, "({x}, {y}): {off}");
        }
    }

    #[test]
    fn nodes_come_closer_until_the_map_is_within_a_tolerance() {
        // Second derivatives of 1/100 px: bilinear interpolation over 16 px deviates by 16^2 / 8 / 100 = 0.32 px.
        let of = |p: DVec2| DVec2::new(p.x + p.x * p.x / 200.0, p.y);
        let map = |tolerance: f64| WarpMap::within(tolerance, (70, 40), (200, 40), of).unwrap();
        // Each half of the distance is a quarter of the deviation, and roundings are to 1/2048 px.
        for (tolerance, bits, deviation) in
            [(0.33, 4, 0.32), (0.31, 3, 0.08), (0.03, 2, 0.02), (0.015, 1, 0.005), (1e-9, 1, 0.005)]
        {
            let map = map(tolerance);
            assert_eq!(map.spacing_bits(), bits, "{tolerance}");
            assert!((map.deviation(of) - deviation).abs() <= 1.5 / 2048.0, "{tolerance}: {}", map.deviation(of));
            for (x, y) in (0..40).flat_map(|y| (0..70).map(move |x| (x, y))) {
                let position = map.source_at(x, y).unwrap().as_dvec2() / 2048.0;
                let off = (position - of(DVec2::new(x.into(), y.into()))).length();
                assert!(off <= deviation + 1.5 / 2048.0, "({x}, {y}): {off}");
            }
        }
        assert_eq!(map(1.0), WarpMap::new((70, 40), (200, 40), of).unwrap());
    }

    #[test]
    fn a_node_far_outside_or_not_finite_leaves_its_cells_without_positions() {
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -300_000.0, 786_431.5] {
            for at in [DVec2::new(bad, 0.0), DVec2::new(0.0, bad)] {
                let map = WarpMap::new((60, 20), (60, 20), |p| if p == DVec2::new(32.0, 0.0) { at } else { p });
                let map = map.unwrap();
                assert_eq!([15, 16, 47, 48].map(|x| map.source_at(x, 3).is_some()), [true, false, false, true]);
                assert!(map.source_at(32, 16).is_some(), "the row of cells below");
                assert_eq!([15, 16, 47, 48].map(|x| map.visible().get(x, 3)), [255, 0, 0, 255]);
            }
        }
        // The extremes of a cell.
        let jump = |p: DVec2| DVec2::splat(if p.x > 0.0 { -262_144.0 } else { 786_430.0 });
        let map = WarpMap::new((16, 1), (1, 1), jump).unwrap();
        assert_eq!(map.source_at(0, 0), Some(IVec2::splat(786_430 * 2048)));
        // 786430 - (786430 + 262144) * 15/16 = -196608.125 px
        assert_eq!(map.source_at(15, 0), Some(IVec2::splat(-402_653_440)));
    }

    #[test]
    fn the_source_ends_half_a_pixel_beyond_its_outermost_pixels() {
        let columns = |by: f64| shift((3, 1), DVec2::new(by, 0.0)).visible().into_data();
        assert_eq!(columns(0.0), [255; 3]);
        assert_eq!(columns(-0.5), [255; 3]);
        assert_eq!(columns(-0.5 - 1.0 / 2048.0), [0, 255, 255]);
        assert_eq!(columns(0.5 - 1.0 / 2048.0), [255; 3]);
        assert_eq!(columns(0.5), [255, 255, 0]);
        assert_eq!(shift((1, 3), DVec2::new(0.0, 2.0)).visible().into_data(), [255, 0, 0]);
    }

    #[test]
    fn a_masked_pixel_hides_what_it_takes_part_in() {
        let mut mask = Plane::filled((9, 1), 255);
        mask.set(4, 0, 0);
        let through = |by: f64| shift((9, 1), DVec2::new(by, 0.0)).visible_through(&mask).unwrap().into_data();
        let except =
            |hidden: &[usize]| -> Vec<u8> { (0..9).map(|x| if hidden.contains(&x) { 0 } else { 255 }).collect() };
        assert_eq!(through(0.0), except(&[4]));
        assert_eq!(through(2.0), except(&[2, 7, 8]));
        // At x + 1/4: the pixels from x - 1 to x + 2.
        assert_eq!(through(0.25), except(&[2, 3, 4, 5]));
        // At x + 1/2048: the outer weights round to 0.
        assert_eq!(through(1.0 / 2048.0), except(&[3, 4]));
        let nearest = |by: f64| shift((9, 1), DVec2::new(by, 0.0)).visible_nearest(&mask).unwrap().into_data();
        assert_eq!((nearest(0.25), nearest(-0.5), nearest(0.5)), (except(&[4]), except(&[4]), except(&[3, 8])));
        let error = shift((9, 1), DVec2::ZERO).visible_through(&Plane::filled((8, 1), 255)).unwrap_err();
        assert_eq!(error.to_string(), "the mask is 8x1 pixels, but it must have the source's 9x1");
    }

    #[test]
    fn sides_beyond_the_limits_are_refused() {
        for (size, source) in [((0, 1), (1, 1)), ((1, 1), (1, 0)), ((1, 1), (524_289, 1))] {
            let error = WarpMap::new(size, source, |p| p).unwrap_err().to_string();
            assert!(error.contains("its sides must be 1 to 524288"), "{error}");
        }
    }
}
