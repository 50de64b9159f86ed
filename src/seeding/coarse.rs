//! A coarse map: the pair downscaled to about a hundred columns and matched over all disparities that could be.
//!
//! A surface without features (a wall out of focus, a plain backdrop) is seen by a dense map alone. The downscaled pair
//! takes a tenth of the time of the whole pair. The map is computed on the host, since a device would compile kernels for
//! the number of disparities of each width.

use crate::{
    cpu,
    dense::{
        Aggregation, Brightness, Cost, CostAggregation, CrossCheck, Dense, DenseConfig, DenseParameters, Interpolation,
        Refinement, Search, View,
    },
    disparity::{DisparityMap, DisparityRange, NONE, SCALE},
    error::Result,
    image::{Luma, Plane, Size, reduced},
    mask::{self, Mask},
};

/// Largest width of the downscaled pair, in pixels.
const WIDTH: u32 = 128;
/// Smallest confidence of a disparity that counts, 0 to 255.
const SURE: u8 = 40;
/// Smallest number of pixels of a surface that counts, in pixels of the downscaled pair: chance leaves smaller ones.
const SURFACE: usize = 10;
/// Share of the disparities that is cut off at either end. Of 18 pairs the range then loses at most 0.3 % of the truth.
const TAIL: f32 = 0.002;
/// Largest distance from an end of the span that counts as the end, in pixels of the downscaled pair.
const AT_END: f32 = 1.5;

/// Largest difference of a disparity from the surfaces around it that agrees with them, in 1/256 px of the downscaled pair.
const AGREEMENT: f32 = 1.25 * SCALE as f32;

/// Semi-global matching, with a second search for the left-right consistency check and without any filling.
const PARAMETERS: DenseParameters = DenseParameters {
    aggregation: Aggregation::Costs(CostAggregation {
        cost: Cost { weak_spread: None, ..CostAggregation::TUNED.cost },
        cross_check: CrossCheck::Searched,
        search: Search::Whole,
        ..CostAggregation::TUNED
    }),
    interpolation: Interpolation::Equiangular,
    uniqueness: 1,
    agreement: 0,
    consistency: Some(SCALE.cast_unsigned()),
    refinement: Some(Refinement { support: 10, majority: false, medians_before: 0, fill: false, medians_after: 0 }),
};

/// The disparities of the surfaces that a downscaled pair shows.
#[derive(Clone, Debug, PartialEq)]
pub struct CoarseMap {
    /// Factor by which the pair was downscaled.
    factor: u32,
    /// Disparities of the downscaled left view, in 1/256 px of it; [`NONE`] off the surfaces.
    map: DisparityMap,
    /// The disparities on surfaces, sorted, in pixels of the downscaled pair.
    disparities: Vec<f32>,
    /// Number of pixels of the downscaled view that show the scene.
    seen: usize,
    /// Searched disparities, in pixels of the downscaled pair.
    searched: DisparityRange,
}

impl CoarseMap {
    /// Matches a pair of one size, as far as the left view is `seen`, over the disparities `span`, in pixels of the pair,
    /// with a change of the right view's brightness.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if the span lies beyond the width of the pair.
    pub(crate) fn new(
        (left, right): (&Luma, &Luma),
        seen: Option<&Mask>,
        span: DisparityRange,
        brightness: Brightness,
    ) -> Result<Self> {
        let factor = left.width().div_ceil(WIDTH);
        let whole = factor as i32;
        let range = DisparityRange::inclusive(span.min.div_euclid(whole), (span.last() + whole - 1).div_euclid(whole))?;
        let (left, right) = (reduced(left, factor), reduced(right, factor));
        let config = DenseConfig { range, reference: View::Left, brightness, parameters: PARAMETERS };
        let searched = config.searched(left.width())?;
        let Dense { disparity, confidence } = cpu::dense::compute(&left, &right, &config)?;
        let seen = seen.map(|mask| mask::reduced(mask, factor));
        let sure = Plane::from_fn(disparity.size(), |x, y| {
            let counts = confidence.get(x, y) >= SURE && seen.as_ref().is_none_or(|mask| mask.get(x, y) != 0);
            if counts { disparity.get(x, y) } else { NONE }
        });
        let seen = seen.map_or(sure.data().len(), |mask| mask.data().iter().filter(|&&value| value != 0).count());
        Ok(Self { seen, ..Self::of_surfaces(&sure, factor, searched) })
    }

    fn of_surfaces(sure: &DisparityMap, factor: u32, searched: DisparityRange) -> Self {
        let mut map = sure.map(|_| NONE);
        for (x, y) in surfaces(sure).into_iter().filter(|surface| surface.len() >= SURFACE).flatten() {
            map.set(x, y, sure.get(x, y));
        }
        let on_surfaces = map.data().iter().filter(|&&disparity| disparity != NONE);
        let mut disparities: Vec<f32> = on_surfaces.map(|&disparity| disparity as f32 / SCALE as f32).collect();
        disparities.sort_by(f32::total_cmp);
        let seen = map.data().len();
        Self { factor, map, disparities, seen, searched }
    }

    /// The map of views enlarged by `factor`.
    pub(super) fn enlarged(self, factor: u32) -> Self {
        Self { factor: factor * self.factor, ..self }
    }

    /// Share of what the downscaled left view shows that lies on a surface, 0 to 1.
    pub fn coverage(&self) -> f32 {
        self.disparities.len() as f32 / self.seen.max(1) as f32
    }

    /// Smallest and largest disparity of the surfaces, without the tails, in pixels of the pair; `None` without surfaces.
    pub fn extent(&self) -> Option<[f32; 2]> {
        let last = self.disparities.len().checked_sub(1)?;
        let tail = (TAIL * last as f32) as usize;
        Some([tail, last - tail].map(|place| self.factor as f32 * self.disparities[place]))
    }

    /// Error of a disparity of the map, in pixels of the pair.
    pub fn error(&self) -> f32 {
        1.5 * self.factor as f32
    }

    /// Share of the surfaces with a disparity below 0, 0 to 1.
    pub fn negative(&self) -> f32 {
        self.share(|disparity| disparity < 0.0)
    }

    /// Share of the surfaces with a disparity of at least `least` px of the pair, 0 to 1.
    pub fn not_below(&self, least: f32) -> f32 {
        self.share(|disparity| self.factor as f32 * disparity >= least)
    }

    /// Share of the surfaces at an end of the searched disparities, 0 to 1: surfaces may go on beyond that end.
    pub fn at_ends(&self) -> f32 {
        let (min, last) = (self.searched.min as f32, self.searched.last() as f32);
        self.share(|disparity| disparity <= min + AT_END || disparity >= last - AT_END)
    }

    /// Smallest and largest disparity around each pixel of the downscaled view.
    pub(crate) fn around(&self) -> Around {
        let bounds = Plane::from_fn(self.map.size(), |x, y| {
            let columns = (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i64::from(x) + i, i64::from(y) + j)));
            let near = columns.map(|(x, y)| self.map.get_clamped(x, y)).filter(|&disparity| disparity != NONE);
            near.fold(None, |bounds, disparity| {
                let [low, high] = bounds.unwrap_or([disparity; 2]);
                Some([low.min(disparity), high.max(disparity)])
            })
        });
        Around { factor: self.factor as f32, bounds }
    }

    fn share(&self, wanted: impl Fn(f32) -> bool) -> f32 {
        let count = self.disparities.iter().filter(|&&disparity| wanted(disparity)).count();
        count as f32 / self.disparities.len().max(1) as f32
    }
}

/// The bounds of a coarse map around each of its pixels.
pub(crate) struct Around {
    factor: f32,
    /// Smallest and largest disparity of 3x3 pixels, in 1/256 px of the downscaled view; `None` off the surfaces.
    bounds: Plane<Option<[i32; 2]>>,
}

impl Around {
    /// Whether the surfaces around column `x` and row `y` of the left view contradict a disparity there, all in pixels of the
    /// view: none is as near as [`AGREEMENT`]. Views without surfaces contradict nothing.
    pub fn contradicts(&self, x: f32, y: u32, disparity: f32) -> bool {
        let place = (x / self.factor) as i64;
        let Some([low, high]) = self.bounds.get_clamped(place, (y as f32 / self.factor) as i64) else { return false };
        let coarse = disparity * SCALE as f32 / self.factor;
        coarse < low as f32 - AGREEMENT || coarse > high as f32 + AGREEMENT
    }
}

/// The pixels of each surface, a connected part of the map whose neighbouring disparities differ by at most a pixel.
fn surfaces(map: &DisparityMap) -> Vec<Vec<(u32, u32)>> {
    let Size { width, height } = map.size();
    let mut free = map.map(|&disparity| disparity != NONE);
    let mut found = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        if !free.get(x, y) {
            continue;
        }
        free.set(x, y, false);
        let (mut surface, mut open) = (Vec::new(), vec![(x, y)]);
        while let Some((x, y)) = open.pop() {
            let here = map.get(x, y);
            surface.push((x, y));
            for (x, y) in [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)] {
                if x < width && y < height && free.get(x, y) && (map.get(x, y) - here).abs() <= SCALE {
                    free.set(x, y, false);
                    open.push((x, y));
                }
            }
        }
        found.push(surface);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_end_at_steps_and_holes() {
        let map = DisparityMap::new((4, 2), vec![0, 256, 513, 512, NONE, 0, NONE, 600]).unwrap();
        let mut found = surfaces(&map);
        found.iter_mut().for_each(|surface| surface.sort_unstable());
        // 256 and 513 differ by more than a pixel, 256 and 0 below it by a pixel.
        assert_eq!(found, [vec![(0, 0), (1, 0), (1, 1)], vec![(2, 0), (3, 0), (3, 1)]]);
    }

    #[test]
    fn small_surfaces_do_not_count() {
        // A wall at 3 px and nine pixels at 9 px.
        let map = Plane::from_fn((20, 20), |x, y| if x < 3 && y < 3 { 9 * SCALE } else { 3 * SCALE });
        let searched = DisparityRange::inclusive(-2, 12).unwrap();
        let found = CoarseMap::of_surfaces(&map, 4, searched);
        assert_eq!(found.extent(), Some([12.0, 12.0]));
        assert_eq!(found.coverage(), 391.0 / 400.0);
        assert_eq!((found.negative(), found.at_ends()), (0.0, 0.0));
        assert_eq!((found.not_below(12.0), found.not_below(12.1)), (1.0, 0.0));
        let at_end = CoarseMap::of_surfaces(&map, 4, DisparityRange::inclusive(2, 12).unwrap());
        assert_eq!(at_end.at_ends(), 1.0);
        let nothing = CoarseMap::of_surfaces(&Plane::filled((5, 5), NONE), 4, searched);
        assert_eq!((nothing.extent(), nothing.coverage(), nothing.at_ends()), (None, 0.0, 0.0));
    }

    #[test]
    fn what_surfaces_around_contradict() {
        // Surfaces at 3 px and, right of column 10, at 9 px; the pair is four times as large.
        let map = Plane::from_fn((20, 20), |x, _| if x < 10 { 3 * SCALE } else { 9 * SCALE });
        let around = CoarseMap::of_surfaces(&map, 4, DisparityRange::inclusive(0, 12).unwrap()).around();
        let contradicts = |x: f32, disparity: f32| around.contradicts(x, 40, disparity);
        assert!(!contradicts(4.0, 12.0) && !contradicts(4.0, 17.0) && contradicts(4.0, 17.1) && contradicts(4.0, 36.0));
        // Beside the edge both surfaces are near.
        assert!(!contradicts(39.0, 12.0) && !contradicts(39.0, 36.0) && contradicts(48.0, 12.0));
        let enlarged = CoarseMap::of_surfaces(&map, 2, DisparityRange::inclusive(0, 12).unwrap()).enlarged(2).around();
        assert!(!enlarged.contradicts(4.0, 40, 17.0) && enlarged.contradicts(4.0, 40, 17.1));
        let nothing = CoarseMap::of_surfaces(&map.map(|_| NONE), 4, DisparityRange::new(0, 1).unwrap()).around();
        assert!(!nothing.contradicts(4.0, 0, 100.0));
    }

    #[test]
    fn a_plane_is_found_at_its_disparity() {
        let texture = |x: u32, y: u32| (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).rotate_left(9) >> 24;
        let left = Luma::from_fn((400, 120), |x, y| texture(x / 6, y / 6) as u8);
        let right = Luma::from_fn((400, 120), |x, y| texture((x + 24) / 6, y / 6) as u8);
        let span = DisparityRange::inclusive(-20, 160).unwrap();
        let found = CoarseMap::new((&left, &right), None, span, Brightness::SAME).unwrap();
        let [low, high] = found.extent().unwrap();
        assert!((low - 24.0).abs() < 4.0 && (high - 24.0).abs() < 4.0 && found.coverage() > 0.6, "{found:?}");
    }
}
