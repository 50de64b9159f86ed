//! Filling of holes along rays, from the definition.

use rayon::prelude::*;

use super::{
    project::{partner, project},
    tangent::{Tangent, rgb, tangents},
    weighted_median::{halving_weight, least_with_half},
};
use crate::{
    dense::{
        Dense, FILLED, View,
        kernels::{
            fit::SLOPE_UNITS,
            rays::{
                COLOUR, COLOUR_LIMIT, FARTHEST, HALVING_BITS, HIDING, LONGEST, OF_DOUBTFUL, OF_SMALL, PASSED,
                PRICE_BITS, UNCLAIMED,
            },
        },
    },
    disparity::{DisparityMap, DisparityRange, NONE, SCALE},
    image::{Luma, Plane, Size},
};

/// Column and row steps of the rays.
const DIRECTIONS: [[i64; 2]; 8] = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, 1], [1, -1], [-1, -1]];

/// What the disparities of a map tell about its holes.
#[derive(Clone, Debug)]
pub struct Surroundings<'p> {
    /// The colours of its view.
    pub picture: &'p Plane<[u8; 4]>,
    /// The tangent planes beside holes.
    pub tangents: Plane<Option<Tangent>>,
    /// The map in the other view.
    pub projected: DisparityMap,
}

impl<'p> Surroundings<'p> {
    /// The surroundings of the holes of a map of `view`, for which `range` was searched; `picture` shows the colours of that
    /// view.
    pub fn new(disparities: &DisparityMap, view: View, range: DisparityRange, picture: &'p Plane<[u8; 4]>) -> Self {
        Self { picture, tangents: tangents(disparities, picture, range), projected: project(disparities, view) }
    }
}

/// Fills the holes of a map of `view` with disparities within `range`: the weighted median of the planes that a ray in
/// each of eight directions reaches first, past up to [`PASSED`] doubtful pixels if another one follows behind a hole. The weight of a plane halves with every 2^[`HALVING_BITS`] that its price
/// exceeds the least. Filled pixels get a confidence of 1 to [`FILLED`], less for a larger least price. Pixels that `own`, the mask of the
/// view, hides stay holes: they are 0 there.
pub fn fill(
    dense: &Dense,
    surroundings: &Surroundings<'_>,
    own: Option<&Luma>,
    view: View,
    range: DisparityRange,
) -> Dense {
    let Size { width, height } = dense.disparity.size();
    let filled = |x: u32, y: u32| {
        let disparity = dense.disparity.get(x, y);
        if disparity != NONE || own.is_some_and(|mask| mask.get(x, y) == 0) {
            return (disparity, dense.confidence.get(x, y));
        }
        let candidates: Vec<(i32, u32)> = DIRECTIONS
            .iter()
            .filter_map(|&direction| reached(&dense.disparity, &surroundings.tangents, [x, y], direction))
            .map(|source| candidate(surroundings, [x, y], source, view, range))
            .collect();
        let Some(least) = candidates.iter().map(|&(_, price)| price).min() else { return (NONE, 0) };
        let weighted = candidates.iter().map(|&(d, price)| (d, halving_weight(price - least, HALVING_BITS)));
        let median = least_with_half(weighted.collect()).expect("the least price has a weight");
        (median, FILLED - (least >> PRICE_BITS).min(u32::from(FILLED) - 1) as u8)
    };
    let rows: Vec<Vec<(i32, u8)>> =
        (0..height).into_par_iter().map(|y| (0..width).map(|x| filled(x, y)).collect()).collect();
    let both = Plane::from_fn((width, height), |x, y| rows[y as usize][x as usize]);
    Dense { disparity: both.map(|&(disparity, _)| disparity), confidence: both.map(|&(_, confidence)| confidence) }
}

/// The source of the ray from a hole: the first pixel with a disparity that is not doubtful. Rays along the row have no limit.
fn reached(
    disparities: &DisparityMap,
    tangents: &Plane<Option<Tangent>>,
    [x, y]: [u32; 2],
    [i, j]: [i64; 2],
) -> Option<[u32; 2]> {
    let Size { width, height } = disparities.size();
    let longest = if j == 0 { width } else { LONGEST };
    let ray = (1..=i64::from(longest)).map(|steps| [i64::from(x) + steps * i, i64::from(y) + steps * j]);
    let inside = |&[x, y]: &[i64; 2]| (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
    let mut ray = ray.take_while(inside).map(|[x, y]| [x as u32, y as u32]);
    let mut next = |is_hole: bool| ray.find(|&[x, y]| (disparities.get(x, y) == NONE) == is_hole);
    let mut source = next(false)?;
    for _ in 0..PASSED {
        if !tangents.get(source[0], source[1]).is_some_and(|tangent| tangent.is_doubtful) {
            break;
        }
        match next(true).and_then(|_| next(false)) {
            Some(other) => source = other,
            None => break,
        }
    }
    Some(source)
}

/// Disparity and price of the plane of the pixel `source` at the pixel `hole`.
fn candidate(
    Surroundings { picture, tangents, projected }: &Surroundings<'_>,
    hole: [u32; 2],
    source: [u32; 2],
    view: View,
    range: DisparityRange,
) -> (i32, u32) {
    let way = [0, 1].map(|axis| hole[axis].wrapping_sub(source[axis]).cast_signed());
    let tangent = tangents.get(source[0], source[1]);
    let Tangent { height, slopes, colour, is_small, is_doubtful } = tangent.expect("a ray ends beside a hole");
    let change = (slopes[0] * way[0] + slopes[1] * way[1] + SLOPE_UNITS / 2).div_euclid(SLOPE_UNITS);
    let continued = height + change.clamp(-FARTHEST, FARTHEST);
    let disparity = continued.clamp(range.min * SCALE, range.last() * SCALE);

    let own = rgb(picture, hole[0], hole[1]);
    let contrast = (0..3).map(|channel| own[channel].abs_diff(colour[channel])).max().unwrap_or(0);
    let price = way[0].abs() + way[1].abs() + COLOUR * i32::from(contrast).min(COLOUR_LIMIT);
    let partner = partner(hole[0], disparity, view);
    let penalty = if !(0..i64::from(projected.width())).contains(&partner) {
        0
    } else {
        match projected.get(partner as u32, hole[1]) {
            NONE => UNCLAIMED,
            claimed if claimed < disparity - SCALE => HIDING,
            _ => 0,
        }
    };
    let of_small = if is_small { OF_SMALL } else { 0 };
    let of_doubtful = if is_doubtful { OF_DOUBTFUL } else { 0 };
    (disparity, (price + penalty + of_small + of_doubtful).cast_unsigned())
}
