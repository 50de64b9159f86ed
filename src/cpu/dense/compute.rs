//! Dense matching in one call.

use rayon::prelude::*;

use super::{
    Surroundings, Transforms, agreement, block_match, box_mean, cell_ranges, claim, consistency, cost, fill,
    half_consistency, halve, path, path_winners, pyramid, residual, select, soft_rank, support, weighted_median,
    winners,
};
use crate::{
    cpu::luma::rgba,
    dense::{
        Aggregation, Compared, CostAggregation, CrossCheck, Dense, DenseConfig, Pyramid, Refinement, Search,
        SemiGlobal, View, kernels::halved_config,
    },
    disparity::{NONE, SCALE},
    error::{Error, Result},
    image::{Luma, Plane},
};

/// [`crate::dense::compute`] on the CPU.
///
/// # Errors
/// [`Error::SizesDiffer`], [`Error::Parameter`].
pub fn compute(left: &Luma, right: &Luma, config: &DenseConfig) -> Result<Dense> {
    compute_in_colour([left, right], &grey([left, right], config), config)
}

/// [`compute`], with holes filled by the colours of `picture`, the reference view.
///
/// # Errors
/// [`Error::SizesDiffer`], [`Error::Parameter`].
pub fn compute_in_colour(views: [&Luma; 2], picture: &Plane<[u8; 4]>, config: &DenseConfig) -> Result<Dense> {
    let [left, right] = views.map(Plane::size);
    if left != right {
        return Err(Error::SizesDiffer { left, right });
    }
    config.validate()?;
    computed(views, picture, config, Pyramid::of(config, left).as_ref())
}

/// [`compute`] over the levels of a pyramid, if there is one.
///
/// # Errors
/// [`Error::Parameter`] if no pixel has a partner.
pub fn compute_over(left: &Luma, right: &Luma, config: &DenseConfig, levels: Option<&Pyramid>) -> Result<Dense> {
    computed([left, right], &grey([left, right], config), config, levels)
}

/// The reference view as a picture without colours.
fn grey([left, right]: [&Luma; 2], config: &DenseConfig) -> Plane<[u8; 4]> {
    rgba(if config.reference == View::Left { left } else { right })
}

/// The map of a pair, with holes filled by the colours of `picture`.
fn computed(
    [left, right]: [&Luma; 2],
    picture: &Plane<[u8; 4]>,
    config: &DenseConfig,
    levels: Option<&Pyramid>,
) -> Result<Dense> {
    let config = DenseConfig { range: config.searched(left.width())?, ..config.clone() };
    let view = config.reference;
    let mut dense;
    let other_disparities;
    match (&config.parameters.aggregation, levels) {
        (Aggregation::Sad { search: Search::Whole, compared, .. }, _) => {
            let [left, right] = bytes([left, right], *compared, &config);
            dense = block_match(&left, &right, view, &config, None);
            other_disparities =
                config.parameters.consistency.map(|_| winners(&left, &right, view.other(), &config, None));
        }
        (Aggregation::Sad { search: Search::CoarseToFine, compared, .. }, _) => {
            dense = coarse_to_fine([left, right], *compared, &config);
            other_disparities = None;
        }
        (Aggregation::Costs(costs), Some(levels)) => {
            dense = pyramid([left, right], &config, costs, levels);
            other_disparities = None;
        }
        (Aggregation::Costs(costs), None) => {
            let right = &right.map(|&luma| config.brightness.apply(luma));
            let paths = all_paths(left, right, view, &config, costs);
            dense = select(&paths, left.size(), &config);
            other_disparities = config.parameters.consistency.map(|_| match costs.cross_check {
                CrossCheck::Claimed => claim(&path_winners(&paths, left.size(), &config), view),
                CrossCheck::Searched => {
                    let paths = all_paths(left, right, view.other(), &config, costs);
                    path_winners(&paths, left.size(), &config)
                        .map(|winner| winner.map_or(NONE, |(_, disparity)| disparity * SCALE))
                }
            });
        }
    }
    if let (Some(max_difference), Some(other_disparities)) = (config.parameters.consistency, other_disparities) {
        consistency(&mut dense, view, &other_disparities, max_difference);
    }
    if config.parameters.checks_agreement() {
        agreement(&mut dense, config.parameters.agreement);
    }
    match &config.parameters.refinement {
        Some(refinement) => Ok(refined([left, right], picture, &dense, refinement, &config)),
        None => Ok(dense),
    }
}

/// The bytes of both views that block matching compares.
fn bytes([left, right]: [&Luma; 2], compared: Compared, config: &DenseConfig) -> [Luma; 2] {
    match compared {
        Compared::Luma => [left.clone(), right.map(|&luma| config.brightness.apply(luma))],
        Compared::SoftRank => [left, right].map(soft_rank),
    }
}

/// Block matching of a pair within the ranges found at half size, confirmed by the other view at half size. The luma of the
/// half-size pictures is that of the pair, before the change of brightness.
fn coarse_to_fine(views: [&Luma; 2], compared: Compared, config: &DenseConfig) -> Dense {
    let [left, right] = bytes(views, compared, config);
    let halves = views.map(halve);
    let [left_half, right_half] = bytes(halves.each_ref(), compared, config);
    let (half, view) = (halved_config(config, config.range), config.reference);
    let map = block_match(&left_half, &right_half, view, &half, None).disparity;
    let ranges = cell_ranges(&map, left.size(), config.range);
    let mut dense = block_match(&left, &right, view, config, Some(&ranges));
    if let Some(max_difference) = config.parameters.consistency {
        let other_disparities = winners(&left_half, &right_half, view.other(), &half, None);
        half_consistency(&mut dense, view, &other_disparities, max_difference);
    }
    dense
}

/// The map of a pair, before the change of brightness, after all steps of `refinement`; `picture` has the colours of the
/// reference view.
pub fn refined(
    [left, right]: [&Luma; 2],
    picture: &Plane<[u8; 4]>,
    dense: &Dense,
    refinement: &Refinement,
    config: &DenseConfig,
) -> Dense {
    let equalised = right.map(|&luma| config.brightness.apply(luma));
    let residuals = residual([left, &equalised], config.reference, &dense.disparity);
    let luma = if config.reference == View::Left { left } else { right };
    let mut refined = support(dense, &residuals, refinement.support, refinement.majority);
    for median in refinement.before() {
        refined.disparity = weighted_median(luma, &refined.disparity, median);
    }
    if refinement.fill {
        let surroundings = Surroundings::new(&refined.disparity, config.reference, picture);
        refined = fill(&refined, &surroundings, config.reference, config.range);
    }
    for median in refinement.after() {
        refined.disparity = weighted_median(luma, &refined.disparity, median);
    }
    refined
}

/// The costs along all paths through one view; without paths, the matching costs themselves.
fn all_paths(
    left: &Luma,
    right: &Luma,
    view: View,
    config: &DenseConfig,
    aggregation: &CostAggregation,
) -> Vec<Vec<u8>> {
    let (reference, other) = if view == View::Left { (left, right) } else { (right, left) };
    let [reference, other] = [reference, other].map(|luma| Transforms::new(luma, &aggregation.cost));
    let costs = cost([&reference, &other], view, &aggregation.cost, config.range);
    let costs = box_mean(&costs, left.size(), aggregation.window);
    let Some(SemiGlobal { penalties, paths }) = &aggregation.semi_global else {
        return vec![costs];
    };
    paths.directions().par_iter().map(|&direction| path(&reference.census, &costs, penalties, direction)).collect()
}
