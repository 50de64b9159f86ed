//! The kernels of dense matching, one per stage, and the layouts of their shared buffers.

mod agreement;
mod bitmap;
mod block_match;
mod box_mean;
mod cell_cost;
mod cell_layout;
mod cell_path;
mod cell_ranges;
mod cell_select;
mod cells;
mod census;
mod claim;
mod confidence_texture;
mod consistency;
mod cost;
mod depth_texture;
mod fill;
mod halve;
mod lane_cost;
mod lane_path;
mod lane_select;
mod lanes;
mod line_buffers;
mod map_back;
mod map_buffer;
mod map_texture;
mod pad;
mod path;
mod point_counts;
mod points;
mod project;
mod residual;
mod rows_per_thread;
mod select;
mod selection;
mod soft_rank;
mod support;
mod tangent;
mod tile_block_match;
mod unseen;
mod volume_band;
mod weighted_median;
mod windows;

pub use agreement::{AGREEMENT_REACH, AGREEMENT_TOLERANCE, Agreement, AgreementTile};
pub use bitmap::{Bitmaps, Shown};
pub use block_match::{BlockMatch, ConfirmingMap, Layout, Tile};
pub use box_mean::BoxMean;
pub use cell_cost::CellCost;
pub(in crate::dense) use cell_layout::row_words;
pub use cell_layout::{CellLayout, LevelBand};
pub use cell_path::CellPath;
pub use cell_ranges::{BLOCK, CellRanges, LEAST, MARGIN};
pub use cell_select::CellSelect;
pub use cells::{CELL, CellBand, Ranges};
pub(crate) use cells::{HALF_GRAIN, REACH, halved, halved_config};
pub use census::Census;
pub(crate) use census::HALO_ROWS;
pub use claim::Claim;
pub use confidence_texture::ConfidenceTexture;
pub use consistency::{CheckedAgainst, Consistency};
pub(in crate::dense) use cost::pixels_per_thread;
pub use cost::{CostVolume, PIXELS_HARDWARE, PIXELS_SOFTWARE};
pub use depth_texture::DepthTexture;
pub use fill::{Fill, Surroundings, rays};
pub use halve::Halve;
pub use lane_cost::LaneCost;
pub use lane_path::{FollowedPath, LanePath};
pub use lane_select::LaneSelect;
pub use lanes::Lanes;
pub use line_buffers::{LineBuffers, PathVolumes};
pub use map_back::{MapBack, SURFACE};
pub use map_buffer::{MapBuffer, MapLayout};
pub use map_texture::{MapRows, MapTexel, MapTexture};
pub use pad::{Pad, PadParams};
pub use path::Path;
pub use point_counts::{ARGUMENTS, PointCounts, PointRule};
pub use points::{PointLayout, PointSources, Points};
pub use project::Project;
pub use residual::{ComparedViews, MAX_RESIDUAL, Residual};
pub use rows_per_thread::{ROWS_HARDWARE, ROWS_SOFTWARE};
pub use select::{Select, Selection};
pub use selection::ResultKind;
pub use soft_rank::{SOFT_RANK_LIMIT, SOFT_RANK_MIDDLE, SoftRank};
pub use support::{SUPPORT_RADIUS, SUPPORT_TOLERANCE, Support};
pub use tangent::{Tangents, fit};
pub use unseen::{Loss, Unseen};
pub use volume_band::VolumeBand;
pub use weighted_median::WeightedMedian;

use super::config::{
    Aggregation, Compared, Cost, DenseParameters, Difference, Interpolation, Penalties, Refinement, Search, View,
};
use crate::gpu::{Exchange, Stage, Windows};

/// Every stage of dense matching with each set of constants that changes its code, for checks that need no GPU: block
/// matching for every window, both views and both results, and stages with tiles, rows per thread or windows of their own both
/// for lavapipe and for all other devices.
pub fn stages() -> Vec<Stage> {
    let mut stages = vec![Pad::stage(), Halve::stage(), CellRanges::stage()];
    stages.push(Claim::stage());
    stages.extend([CheckedAgainst::Disparities, CheckedAgainst::Claims(0)].map(Consistency::stage));
    let sad = |side, search| DenseParameters {
        aggregation: Aggregation::Sad { side, search, compared: Compared::Luma },
        ..DenseParameters::default()
    };
    let blocks = |side| sad(side, Search::Whole);
    for window in (3..=31).step_by(2) {
        for tile in [Tile::SMALL, Tile::LARGE, Tile::HARDWARE] {
            for view in [View::Left, View::Right] {
                stages.push(BlockMatch::stage(&blocks(window), view, ResultKind::Matches, tile));
                stages.push(BlockMatch::stage(&blocks(window), view, ResultKind::Winners, tile));
            }
        }
    }
    let coarse_to_fine = sad(7, Search::CoarseToFine);
    stages.extend(View::ALL.map(|view| BlockMatch::stage(&coarse_to_fine, view, ResultKind::Matches, Tile::HARDWARE)));
    stages.extend(Interpolation::ALL.map(|interpolation| {
        let parameters = DenseParameters { interpolation, ..blocks(3) };
        BlockMatch::stage(&parameters, View::Left, ResultKind::Matches, Tile::HARDWARE)
    }));
    let part = Difference { weight: 1, limit: 1 };
    let cost = Cost { census: 1, difference: part, gradient: part, weak_spread: None };
    for cost in [cost, Cost { weak_spread: Some(1), ..cost }] {
        for pixels in [PIXELS_SOFTWARE, PIXELS_HARDWARE] {
            stages.extend(View::ALL.map(|view| CostVolume::stage(&cost, view, pixels)));
            stages.extend(View::ALL.map(|view| CellCost::stage(&cost, view, pixels)));
        }
        stages.extend(View::ALL.map(|view| LaneCost::stage(&cost, view)));
    }
    stages.extend([3, 31].map(BoxMean::stage));
    let penalties = Penalties { p1: 1, p2: 2, least_p2: 1, p2_scale: 1 };
    stages.extend([Path::stage(&penalties, 4), CellPath::stage(&penalties)]);
    for (words, threads) in [(1, 64), (2, 64), (4, 256)] {
        stages.extend(Exchange::ALL.map(|exchange| LanePath::stage(&penalties, words, threads, exchange)));
    }
    for interpolation in Interpolation::ALL {
        stages.extend([(ResultKind::Matches, true), (ResultKind::Winners, false)].map(|(kind, keys)| {
            LaneSelect::stage(Selection { stored: 4, interpolation, kind, keys, uniqueness: 0 }, 64)
        }));
    }
    stages.extend([true, false].map(|keys| {
        let interpolation = Interpolation::Equiangular;
        CellSelect::stage(Selection { stored: 4, interpolation, kind: ResultKind::Matches, keys, uniqueness: 0 })
    }));
    // Without stored paths and penalties the text contains neither.
    for (penalties, stored) in [(penalties, 3), (Penalties::NONE, 0)] {
        for interpolation in Interpolation::ALL {
            stages.extend(
                [(ResultKind::Matches, true), (ResultKind::Matches, false), (ResultKind::Winners, false)].map(
                    |(kind, keys)| {
                        let selection = Selection { stored, interpolation, kind, keys, uniqueness: 0 };
                        Select::stage(&penalties, 4, selection)
                    },
                ),
            );
        }
    }
    stages.extend([
        Residual::stage(),
        Project::stage(),
        Bitmaps::stage(),
        Tangents::stage(),
        Fill::stage(),
        Unseen::stage(),
        MapBack::stage(),
        DepthTexture::stage(),
        ConfidenceTexture::stage(),
        PointCounts::stage(),
        Points::stage(),
    ]);
    let refinement = Refinement { support: 5, majority: true, medians_before: 1, fill: true, medians_after: 1 };
    stages.extend(MapTexel::ALL.map(MapTexture::stage));
    stages.extend([AgreementTile::SOFTWARE, AgreementTile::HARDWARE].map(Agreement::stage));
    stages.extend([ROWS_SOFTWARE, ROWS_HARDWARE].map(SoftRank::stage));
    for windows in Windows::ALL {
        stages.extend([None, Some(1)].map(|weak_spread| Census::stage(weak_spread, windows)));
        stages.extend([false, true].map(|majority| Support::stage(5, majority, windows)));
        let medians = refinement.before().chain(refinement.after());
        stages.extend(medians.map(|median| WeightedMedian::stage(median, windows)));
    }
    stages
}
