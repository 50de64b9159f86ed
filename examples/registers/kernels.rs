//! The kernels of the plan for GPUs.

use hsad::{
    config::Preset,
    dense::{Aggregation, DenseParameters, SemiGlobal, View},
    gpu::{Exchange, Windows},
    internals::{self, Stage, dense as kernels},
};

/// Every kernel that a preset with semi-global matching, block matching in each of `windows`, or the features use on a
/// GPU, with a name that tells variants apart. No kernel depends on the number of disparities.
pub fn kernels_of_gpus(windows: &[u32]) -> Vec<(String, Stage)> {
    let mut named = Vec::new();
    let mut add = |variant: &str, stage: Stage| {
        let name = if variant.is_empty() { stage.name.to_owned() } else { format!("{} {variant}", stage.name) };
        if named.iter().all(|(_, known)| *known != stage) {
            named.push((name, stage));
        }
    };
    for preset in [Preset::Balanced, Preset::Quality] {
        let variant = preset.name();
        let parameters = preset.dense_parameters();
        let Aggregation::Costs(costs) = &parameters.aggregation else { continue };
        let Some(SemiGlobal { penalties, paths }) = costs.semi_global else { continue };
        let selection = |stored| kernels::Selection {
            stored,
            interpolation: parameters.interpolation,
            kind: kernels::ResultKind::Matches,
            keys: true,
            uniqueness: parameters.uniqueness,
        };
        let paths = paths.directions().len() as u32;
        add(variant, kernels::Census::stage(costs.cost.weak_spread, Windows::Tiles));
        add(variant, kernels::LaneCost::stage(&costs.cost, View::Left));
        for exchange in Exchange::ALL {
            for words in [1, 2, 4] {
                let name = format!("{variant} {exchange} {}", 4 * words);
                add(&name, kernels::LanePath::stage(&penalties, words, 64, exchange));
            }
        }
        add(variant, kernels::LaneSelect::stage(selection(paths), 64));
        add(variant, kernels::CellCost::stage(&costs.cost, View::Left, kernels::PIXELS_HARDWARE));
        add(variant, kernels::CellPath::stage(&penalties));
        add(variant, kernels::CellSelect::stage(selection(paths)));
        add_refinement(&mut add, variant, &parameters);
    }
    let fast = Preset::Fast.dense_parameters();
    add_refinement(&mut add, "fast", &fast);
    let tile = kernels::Tile::HARDWARE;
    for view in View::ALL {
        for kind in [kernels::ResultKind::Matches, kernels::ResultKind::Winners] {
            add(&format!("fast {view} {kind:?}"), kernels::BlockMatch::stage(&fast, view, kind, tile));
        }
    }
    for &side in windows {
        let Aggregation::Sad { search, compared, .. } = fast.aggregation else { continue };
        let parameters = DenseParameters { aggregation: Aggregation::Sad { side, search, compared }, ..fast };
        let stage = kernels::BlockMatch::stage(&parameters, View::Left, kernels::ResultKind::Matches, tile);
        add(&format!("{side}x{side}"), stage);
    }
    add("", kernels::SoftRank::stage(kernels::ROWS_HARDWARE));
    add("", kernels::Agreement::stage(kernels::AgreementTile::HARDWARE));
    // All other stages have one shape. Those of these names are above in the shape of GPUs, or are for CPUs alone.
    let shaped = [
        "agreement",
        "block_match",
        "census",
        "cell_cost",
        "cell_path",
        "cell_select",
        "cost",
        "lane_cost",
        "lane_path",
        "lane_select",
        "path",
        "select",
        "soft_rank",
        "support",
        "tile_census",
        "tile_block_match",
        "tile_support",
        "tile_weighted_median",
        "weighted_median",
    ];
    for (number, stage) in internals::stages().into_iter().filter(|stage| !shaped.contains(&stage.name)).enumerate() {
        add(&format!("#{number}"), stage);
    }
    named
}

fn add_refinement(add: &mut impl FnMut(&str, Stage), variant: &str, parameters: &DenseParameters) {
    let Some(refinement) = &parameters.refinement else { return };
    let windows = Windows::Tiles;
    add(variant, kernels::Support::stage(refinement.support, refinement.majority, windows));
    for median in refinement.before().chain(refinement.after()) {
        add(&format!("{median:?}"), kernels::WeightedMedian::stage(median, windows));
    }
}
