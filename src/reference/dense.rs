//! The dense half in one call.

use super::{
    block_match, brightened, census, check_consistency, cost_volume, filled, path, select, supported, weighted_median,
};
use crate::{
    dense::{Aggregation, Dense, DenseConfig, Interpolation, Refinement, SemiGlobal, View},
    disparity::DisparityRange,
    error::{Error, Result},
    image::Luma,
};

/// What [`crate::dense::compute`] computes, on the CPU.
///
/// # Errors
/// [`Error::SizesDiffer`], [`Error::Parameter`].
pub fn compute_dense(left: &Luma, right: &Luma, config: &DenseConfig) -> Result<Dense> {
    if left.size() != right.size() {
        return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
    }
    config.validate()?;
    let config = DenseConfig { range: config.searched(left.width())?, ..config.clone() };
    let unchanged = [left, right];
    let right = &right.map(|&luma| brightened(luma, config.brightness));
    let seen_from = |view: View, config: &DenseConfig| match &config.aggregation {
        Aggregation::Window(_) => block_match(left, right, view, config),
        Aggregation::Paths(semi_global) => match_semi_globally(left, right, view, config, semi_global),
    };
    let mut dense = seen_from(config.reference, &config);
    if let Some(max_difference) = config.consistency {
        let whole = DenseConfig { interpolation: Interpolation::None, uniqueness: 0, ..config.clone() };
        let others = seen_from(config.reference.other(), &whole).disparity;
        check_consistency(&mut dense, config.reference, &others, max_difference);
    }
    match &config.refinement {
        Some(refinement) => {
            let luma = unchanged[usize::from(config.reference == View::Right)];
            Ok(refined(&dense, luma, refinement, config.range))
        }
        None => Ok(dense),
    }
}

/// A map after all that `refinement` asks for.
fn refined(dense: &Dense, luma: &Luma, refinement: &Refinement, range: DisparityRange) -> Dense {
    let Dense { disparity: mut map, confidence } = supported(dense, refinement.support);
    for median in refinement.before() {
        map = weighted_median(luma, &map, &map, median);
    }
    let before = map.clone();
    if refinement.fill {
        map = filled(&map, range);
    }
    for median in refinement.after() {
        map = weighted_median(luma, &map, &before, median);
    }
    Dense { disparity: map, confidence }
}

/// Semi-global matching of one view, without any check from the other.
fn match_semi_globally(
    left: &Luma,
    right: &Luma,
    view: View,
    config: &DenseConfig,
    SemiGlobal { cost, penalties, paths }: &SemiGlobal,
) -> Dense {
    let (left, right) = (census(left), census(right));
    let (reference, other) = if view == View::Left { (&left, &right) } else { (&right, &left) };
    let costs = cost_volume([reference, other], view, cost, config.range);
    let paths: Vec<_> =
        paths.directions().iter().map(|&direction| path(reference, &costs, penalties, direction)).collect();
    select(&paths, reference.size(), config)
}
