//! Semi-global matching over a pyramid.

use super::{aggregate::aggregate, bands::Task, cut::Cut, halve, refined::checked_and_refined, unseen};
use crate::{
    dense::{
        After, CostAggregation, Dense, DenseConfig,
        kernels::Loss,
        pyramid::{CellTable, Pyramid, filters},
    },
    error::Result,
    image::Luma,
};

/// The map of the pair `views`, before the change of brightness, without what follows on its left-right consistency check; with
/// the costs and paths of `costs`. On all levels but the finest a pixel has no disparity that the `masks` of the reference view and of
/// the other one hide, or whose partner they hide.
///
/// # Errors
/// [`crate::Error::NotEnoughMemory`], before a level that memory does not hold is matched.
pub(super) fn pyramid(
    views: [&Luma; 2],
    masks: [Option<&Luma>; 2],
    config: &DenseConfig,
    costs: &CostAggregation,
    pyramid: &Pyramid,
) -> Result<Dense> {
    let levels = pyramid.levels();
    // The pair and its masks of each level but the finest.
    let mut halves: Vec<([Luma; 2], [Option<Luma>; 2])> = Vec::new();
    for _ in &levels[1..] {
        let (pair, masks) = halves
            .last()
            .map_or((views, masks), |(pair, masks)| (pair.each_ref(), masks.each_ref().map(Option::as_ref)));
        halves.push((pair.map(halve), masks.map(|mask| mask.map(halve))));
    }
    let filters = After { agreement: None, filters: Some(filters()) };
    let mut table = CellTable::whole(levels[levels.len() - 1].size, levels[levels.len() - 1].range);
    while let Some((pair, [own, other])) = halves.pop() {
        let (level, finer) = (&levels[halves.len() + 1], &levels[halves.len()]);
        let config = level.coarse(config);
        let mut dense = matched(pair.each_ref(), &config, costs, &table)?;
        unseen(&mut dense, config.reference, own.as_ref(), other.as_ref(), Loss::Disparity);
        let Dense { disparity, .. } = checked_and_refined(pair.each_ref(), None, None, dense, &filters, &config);
        table = CellTable::below(&disparity, finer.size, finer.range);
    }
    matched(views, &levels[0].finest(config), costs, &table)
}

/// The map of a level.
fn matched(
    [left, right]: [&Luma; 2],
    config: &DenseConfig,
    costs: &CostAggregation,
    table: &CellTable,
) -> Result<Dense> {
    let task = Task { left, right, config, costs, table: Some(table) };
    Ok(aggregate(task, Cut::fitting(task)?))
}
