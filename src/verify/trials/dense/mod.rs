//! Dense matching.

mod blocks;
mod cells;
mod costs;
mod levels;
mod maps;
mod paths;
mod words;

pub use blocks::{BlockMatchTrial, PadTrial};
pub use cells::{CellRangesTrial, HalveTrial};
pub use costs::{BoxMeanTrial, CensusTrial, CostTrial, WideCensusTrial};
pub use levels::{CellCostTrial, CellPathTrial, CellSelectTrial};
pub use maps::{ConsistencyTrial, FillTrial, MapTextureTrial, MedianTrial, ResidualTrial, SupportTrial};
pub use paths::{ClaimTrial, PathTrial, SelectTrial};

use crate::verify::trial::Subject;

pub(super) const SUBJECTS: [&[Subject]; 6] =
    [blocks::SUBJECTS, cells::SUBJECTS, costs::SUBJECTS, paths::SUBJECTS, levels::SUBJECTS, maps::SUBJECTS];
