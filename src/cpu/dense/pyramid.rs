//! Semi-global matching over a pyramid.

use rayon::prelude::*;

use super::{Transforms, cell_cost, cell_path, cell_select, claim, consistency, halve, residual, support};
use crate::{
    dense::{
        CostAggregation, Dense, DenseConfig, SemiGlobal, View,
        config::Filters,
        pyramid::{CellTable, Pyramid, filters},
    },
    image::Luma,
};

/// The map of the pair `views`, before the change of brightness, without the refinement of `config`; with the costs and
/// paths of `costs`.
pub fn pyramid(views: [&Luma; 2], config: &DenseConfig, costs: &CostAggregation, pyramid: &Pyramid) -> Dense {
    let mut pictures = vec![views.map(Luma::clone)];
    for _ in &pyramid.levels()[1..] {
        let [left, right] = &pictures[pictures.len() - 1];
        pictures.push([halve(left), halve(right)]);
    }
    let levels = pyramid.levels();
    let mut table = CellTable::whole(levels[levels.len() - 1].size, levels[levels.len() - 1].range);
    for (number, pair) in pictures.iter().enumerate().skip(1).rev() {
        let dense = matched(pair, &levels[number].coarse(config), costs, &table);
        let [left, right] = pair;
        let equalised = right.map(|&luma| config.brightness.apply(luma));
        let residuals = residual([left, &equalised], config.reference, &dense.disparity);
        let Filters { support: least, majority, .. } = filters();
        let map = support(&dense, &residuals, least, majority).disparity;
        table = CellTable::below(&map, levels[number - 1].size, levels[number - 1].range);
    }
    matched(&pictures[0], &levels[0].finest(config), costs, &table)
}

/// The map of a level, of the pair before the change of brightness.
fn matched([left, right]: &[Luma; 2], config: &DenseConfig, costs: &CostAggregation, table: &CellTable) -> Dense {
    let view = config.reference;
    let right = right.map(|&luma| config.brightness.apply(luma));
    let transforms = [left, &right].map(|luma| Transforms::new(luma, &costs.cost));
    let [reference, other] = if view == View::Left { [0, 1] } else { [1, 0] }.map(|side| &transforms[side]);
    let volume = cell_cost([reference, other], view, &costs.cost, table);
    let Some(SemiGlobal { penalties, paths }) = &costs.semi_global else {
        unreachable!("a pyramid without paths");
    };
    let paths: Vec<_> = paths
        .directions()
        .par_iter()
        .map(|&direction| cell_path(&reference.census, &volume, penalties, direction))
        .collect();
    let (mut dense, winners) = cell_select(&paths, config);
    if let Some(max_difference) = config.parameters.consistency {
        consistency(&mut dense, view, &claim(&winners, view), max_difference);
    }
    dense
}
