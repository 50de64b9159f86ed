//! Matching by costs along paths.

use super::{
    CellVolume,
    bands::{Band, Bands, Task},
    cell_select, claim, consistency,
    cut::Cut,
    path_winners, select,
};
use crate::{
    dense::{CrossCheck, Dense},
    disparity::{DisparityMap, NONE, SCALE},
    image::{Plane, Size},
};

/// The map of a pair after its left-right consistency check, in the bands of `cut`.
pub(super) fn aggregate(task: Task<'_>, cut: Cut) -> Dense {
    let Task { left, config, costs, table, .. } = task;
    let view = config.reference;
    let mut searched = match costs.cross_check {
        CrossCheck::Searched if config.parameters.consistency.is_some() => Some(Bands::new(task, view.other(), cut)),
        _ => None,
    };
    let pixels = left.size().pixels() as usize;
    let (mut disparities, mut confidences) = (Vec::with_capacity(pixels), Vec::with_capacity(pixels));
    for Band { rows, paths } in Bands::new(task, view, cut) {
        let size = Size::new(left.width(), rows.end - rows.start);
        let dense = match table {
            Some(table) => {
                let volume = |values| CellVolume { table: table.cut(rows.clone()), values };
                let (dense, winners) = cell_select(&paths.into_iter().map(volume).collect::<Vec<_>>(), config);
                checked(task, dense, || claim(&winners, view))
            }
            None => checked(task, select(&paths, size, config), || match &mut searched {
                None => claim(&path_winners(&paths, size, config), view),
                Some(bands) => {
                    drop(paths);
                    let Band { paths, .. } = bands.next().expect("both views have the same bands");
                    path_winners(&paths, size, config)
                        .map(|winner| winner.map_or(NONE, |(_, disparity)| disparity * SCALE))
                }
            }),
        };
        disparities.extend_from_slice(dense.disparity.data());
        confidences.extend_from_slice(dense.confidence.data());
    }
    let plane = "bands cover the picture";
    Dense {
        disparity: Plane::new(left.size(), disparities).expect(plane),
        confidence: Plane::new(left.size(), confidences).expect(plane),
    }
}

/// A band without the disparities that those of the other view contradict, if that is checked.
fn checked(task: Task<'_>, mut dense: Dense, other_disparities: impl FnOnce() -> DisparityMap) -> Dense {
    if let Some(max_difference) = task.config.parameters.consistency {
        consistency(&mut dense, task.config.reference, &other_disparities(), max_difference);
    }
    dense
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        cpu::dense::{Transforms, box_mean, cell_cost, cell_path, cost, path, refined::tests::pair},
        dense::{
            Aggregation, Brightness, CostAggregation, DenseConfig, Paths, SemiGlobal, View,
            pyramid::{CellRange, CellTable},
        },
        disparity::DisparityRange,
        image::Luma,
    };

    /// The map of a task in one piece, from the definition.
    fn whole(task: Task<'_>) -> Dense {
        let Task { left, right, config, costs, table } = task;
        let (size, directions) = (left.size(), costs.directions());
        let right = right.map(|&luma| config.brightness.apply(luma));
        let views = [left, &right].map(|luma| Transforms::new(luma, &costs.cost));
        let views = |view: View| if view == View::Left { [&views[0], &views[1]] } else { [&views[1], &views[0]] };
        let paths = |view: View| -> Vec<Vec<u8>> {
            let costs_of_pixels = cost(views(view), view, &costs.cost, config.range);
            let averaged = box_mean(&costs_of_pixels, size, costs.window);
            let along = |&direction| path(&views(view)[0].census, &averaged, &costs.followed_with(), direction);
            if directions.is_empty() { vec![averaged] } else { directions.iter().map(along).collect() }
        };
        let view = config.reference;
        let (dense, other) = if let Some(table) = table {
            let volume = cell_cost(views(view), view, &costs.cost, table);
            let along = |&direction| cell_path(&views(view)[0].census, &volume, &costs.followed_with(), direction);
            let (dense, winners) = cell_select(&directions.iter().map(along).collect::<Vec<_>>(), config);
            (dense, claim(&winners, view))
        } else {
            let own = paths(view);
            let other = match costs.cross_check {
                CrossCheck::Claimed => claim(&path_winners(&own, size, config), view),
                CrossCheck::Searched => path_winners(&paths(view.other()), size, config)
                    .map(|winner| winner.map_or(NONE, |(_, disparity)| disparity * SCALE)),
            };
            (select(&own, size, config), other)
        };
        checked(task, dense, || other)
    }

    /// Numbers of a sequence that looks random, each from 1 to a largest one.
    fn draws() -> impl FnMut(u32) -> u32 {
        let mut state = 7_u32;
        move |most| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            1 + (state >> 16) % most
        }
    }

    fn config(aggregation: CostAggregation, reference: View, range: DisparityRange) -> DenseConfig {
        let brightness = Brightness { gain: 270, offset: -900 };
        DenseConfig { reference, brightness, ..DenseConfig::new(range) }.with(|parameters| {
            parameters.aggregation = Aggregation::Costs(aggregation);
            parameters.consistency = Some(256);
        })
    }

    fn along(paths: Paths) -> Option<SemiGlobal> {
        Some(SemiGlobal { paths, ..SemiGlobal::TUNED })
    }

    /// Costs by the usual census, or by the wide one everywhere.
    fn costs(is_weak: bool) -> CostAggregation {
        let mut costs = CostAggregation::TUNED;
        costs.cost.weak_spread = Some(if is_weak { 9 * 255 } else { 0 });
        costs
    }

    #[test]
    fn bands_do_not_change_the_result() {
        let [left, right] = pair(Size::new(41, 37));
        let ways = [along(Paths::Three), along(Paths::Four), along(Paths::Eight), None];
        let (mut draw, range) = (draws(), DisparityRange::new(-2, 19).unwrap());
        for round in 0..40 {
            let costs = CostAggregation {
                window: [1, 5][round % 2],
                semi_global: ways[round / 2 % 4],
                cross_check: [CrossCheck::Claimed, CrossCheck::Searched][round / 8 % 2],
                ..costs(round % 3 == 0)
            };
            let config = config(costs, View::ALL[round / 4 % 2], range);
            let cut = Cut { rows: draw(left.height()), parts: 1 + draw(4) };
            let task = Task { left: &left, right: &right, config: &config, costs: &costs, table: None };
            assert_eq!(aggregate(task, cut), whole(task), "{cut:?}, {config:?}");
        }
    }

    #[test]
    fn bands_do_not_change_the_result_of_cells() {
        let [left, right]: [Luma; 2] = pair(Size::new(41, 37));
        let (mut draw, range) = (draws(), DisparityRange::new(-2, 50).unwrap());
        for round in 0..24 {
            let costs = CostAggregation { semi_global: along(Paths::ALL[round % 3]), ..costs(round % 2 == 0) };
            let config = config(costs, View::ALL[round / 3 % 2], range);
            let whole_range = CellTable::whole(left.size(), range);
            let cells = whole_range.cells.map(|_| {
                let words = 4 * draw(4);
                CellRange { first: draw(17 - words) - 1, words }
            });
            let table = CellTable { cells, ..whole_range };
            let cut = Cut { rows: draw(left.height()), parts: 1 + draw(4) };
            let task = Task { left: &left, right: &right, config: &config, costs: &costs, table: Some(&table) };
            assert_eq!(aggregate(task, cut), whole(task), "{cut:?}, {config:?}");
        }
    }
}
