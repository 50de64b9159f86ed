//! Semi-global matching over a pyramid.

use super::{aggregate::aggregate, bands::Task, cut::Cut, halve, refined::checked_and_refined};
use crate::{
    dense::{
        After, CostAggregation, Dense, DenseConfig,
        pyramid::{CellTable, Pyramid, filters},
    },
    error::Result,
    image::Luma,
};

/// The map of the pair `views`, before the change of brightness, without what follows on its left-right consistency check; with
/// the costs and paths of `costs`.
///
/// # Errors
/// [`crate::Error::NotEnoughMemory`], before a level that memory does not hold is matched.
pub(super) fn pyramid(
    views: [&Luma; 2],
    config: &DenseConfig,
    costs: &CostAggregation,
    pyramid: &Pyramid,
) -> Result<Dense> {
    let levels = pyramid.levels();
    // The pair of each level but the finest.
    let mut halves: Vec<[Luma; 2]> = Vec::new();
    for _ in &levels[1..] {
        let above = halves.last().map_or(views, |pair| pair.each_ref());
        halves.push(above.map(halve));
    }
    let filters = After { agreement: None, filters: Some(filters()) };
    let mut table = CellTable::whole(levels[levels.len() - 1].size, levels[levels.len() - 1].range);
    while let Some(pair) = halves.pop() {
        let (level, finer) = (&levels[halves.len() + 1], &levels[halves.len()]);
        let config = level.coarse(config);
        let dense = matched(pair.each_ref(), &config, costs, &table)?;
        let Dense { disparity, .. } = checked_and_refined(pair.each_ref(), None, dense, &filters, &config);
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
