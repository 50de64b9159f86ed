//! Dense matching in one call.

use std::borrow::Cow;

use super::{
    aggregate::aggregate,
    bands::Task,
    block_match::{self, block_match, winners},
    cell_ranges, consistency,
    cut::{Cut, check},
    half_consistency, halve,
    pyramid::pyramid,
    refined::{self, checked_and_refined},
    soft_rank, unseen,
};
use crate::{
    dense::{
        After, Aggregation, Brightness, Compared, Dense, DenseConfig, Pyramid, Search, Seen,
        kernels::{Loss, halved_config},
    },
    error::{Error, Result},
    image::{Luma, Plane},
    memory::Left,
};

/// Bytes per pixel of a map.
const MAP: u64 = 5;
/// Bytes per pixel of block matching beside the map: what is compared of both views, the map of the other view, and the same of
/// a pair of half the size.
const BLOCKS: u64 = 10;
/// Bytes per pixel of the pairs of a pyramid.
const LEVELS: u64 = 1;

/// [`crate::dense::compute`] on the CPU.
///
/// # Errors
/// [`Error::SizesDiffer`], [`Error::Parameter`], [`Error::NotEnoughMemory`].
pub fn compute(left: &Luma, right: &Luma, config: &DenseConfig) -> Result<Dense> {
    compute_seen([left, right], None, None, config)
}

/// [`compute`], with holes filled by the colours of `picture`, the reference view.
///
/// # Errors
/// [`Error::SizesDiffer`], [`Error::Parameter`], [`Error::NotEnoughMemory`].
pub fn compute_in_colour(views: [&Luma; 2], picture: &Plane<[u8; 4]>, config: &DenseConfig) -> Result<Dense> {
    compute_seen(views, Some(picture), None, config)
}

/// [`compute`], with holes filled by the colours of `picture`, if there is one, of what is `seen` of the pair.
///
/// # Errors
/// [`Error::SizesDiffer`], [`Error::Parameter`], [`Error::NotEnoughMemory`].
pub fn compute_seen(
    views: [&Luma; 2],
    picture: Option<&Plane<[u8; 4]>>,
    seen: Option<Seen<'_>>,
    config: &DenseConfig,
) -> Result<Dense> {
    let [left, right] = views.map(Plane::size);
    if left != right {
        return Err(Error::SizesDiffer { left, right });
    }
    config.validate()?;
    computed(views, picture, seen, config, Pyramid::of(config, left).as_ref())
}

/// [`compute`] of what is `seen` of a pair, over the levels of a pyramid, if there is one.
///
/// # Errors
/// [`Error::Parameter`] if no pixel has a partner; [`Error::NotEnoughMemory`], before anything is computed, or before the level of
/// a pyramid, whose need the level above tells.
pub fn compute_over(
    views: [&Luma; 2],
    seen: Option<Seen<'_>>,
    config: &DenseConfig,
    levels: Option<&Pyramid>,
) -> Result<Dense> {
    computed(views, None, seen, config, levels)
}

/// The map of a pair, with holes filled by the colours of `picture`, or by luma without it.
fn computed(
    [left, right]: [&Luma; 2],
    picture: Option<&Plane<[u8; 4]>>,
    seen: Option<Seen<'_>>,
    config: &DenseConfig,
    levels: Option<&Pyramid>,
) -> Result<Dense> {
    let config = &DenseConfig { range: config.searched(left.width())?, ..config.clone() };
    let (views, size, after) = ([left, right], left.size(), After::of(&config.parameters));
    // The map is worked on when the memory of its matching is free.
    let needs = |matching: u64| {
        let needed = MAP * size.pixels() + matching.max(refined::bytes(size, &after));
        check(needed, Left::now(), size, config)
    };
    let dense = match (&config.parameters.aggregation, levels) {
        (Aggregation::Sad { search, compared, .. }, _) => {
            needs(BLOCKS * size.pixels() + block_match::bytes(config))?;
            by_blocks(views, *search, *compared, config)
        }
        (Aggregation::Costs(costs), Some(levels)) => {
            needs(LEVELS * size.pixels())?;
            pyramid(views, seen.map_or([None; 2], |seen| seen.masks), config, costs, levels)?
        }
        (Aggregation::Costs(costs), None) => {
            needs(0)?;
            let task = Task { left, right, config, costs, table: None };
            aggregate(task, Cut::fitting(task)?)
        }
    };
    let worked_on = |own, dense, after: &After| checked_and_refined(views, picture, own, dense, after, config);
    let Some(Seen { masks: [own, other], loss }) = seen else { return Ok(worked_on(None, dense, &after)) };
    // What is hidden takes no part in the filters.
    let mut dense = worked_on(None, dense, &After { filters: None, ..after.clone() });
    unseen(&mut dense, config.reference, own, other, loss);
    let mut dense = worked_on(own, dense, &After { agreement: None, ..after });
    unseen(&mut dense, config.reference, own, other, Loss::Confidence);
    Ok(dense)
}

/// Block matching of `views`, before the change of brightness, after its left-right consistency check.
fn by_blocks(views: [&Luma; 2], search: Search, compared: Compared, config: &DenseConfig) -> Dense {
    if search == Search::CoarseToFine {
        return coarse_to_fine(views, compared, config);
    }
    let ([left, right], view) = (bytes(views, compared, config), config.reference);
    let mut dense = block_match(&left, &right, view, config, None);
    if let Some(max_difference) = config.parameters.consistency {
        let other_disparities = winners(&left, &right, view.other(), config, None);
        consistency(&mut dense, view, &other_disparities, max_difference);
    }
    dense
}

/// The bytes of both views that block matching compares.
fn bytes<'v>([left, right]: [&'v Luma; 2], compared: Compared, config: &DenseConfig) -> [Cow<'v, Luma>; 2] {
    match compared {
        Compared::Luma if config.brightness == Brightness::SAME => [left, right].map(Cow::Borrowed),
        Compared::Luma => [Cow::Borrowed(left), Cow::Owned(right.map(|&luma| config.brightness.apply(luma)))],
        Compared::SoftRank => [left, right].map(|view| Cow::Owned(soft_rank(view))),
    }
}

/// Block matching of a pair within the ranges found at half size, confirmed by the other view at half size. The luma of the
/// half-size pictures is that of the pair, before the change of brightness.
fn coarse_to_fine(views: [&Luma; 2], compared: Compared, config: &DenseConfig) -> Dense {
    let [left, right] = bytes(views, compared, config);
    let halves = views.map(halve);
    let [left_half, right_half] = bytes(halves.each_ref(), compared, config);
    let (half, view) = (halved_config(config, config.range), config.reference);
    let ranges = {
        let map = block_match(&left_half, &right_half, view, &half, None).disparity;
        cell_ranges(&map, left.size(), config.range)
    };
    let mut dense = block_match(&left, &right, view, config, Some(&ranges));
    if let Some(max_difference) = config.parameters.consistency {
        let other_disparities = winners(&left_half, &right_half, view.other(), &half, None);
        half_consistency(&mut dense, view, &other_disparities, max_difference);
    }
    dense
}
