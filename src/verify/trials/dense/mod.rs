//! Dense matching.

mod blocks;
mod cells;
mod maps;
mod paths;

pub use blocks::{BlockMatchTrial, PadTrial};
pub use cells::{CellRangesTrial, HalveTrial};
pub use maps::{ConsistencyTrial, FillTrial, MapTextureTrial, MedianTrial, ResidualTrial, SupportTrial};
pub use paths::{BoxMeanTrial, CensusTrial, ClaimTrial, CostTrial, PathTrial, SelectTrial};

use crate::verify::trial::Subject;

pub(super) const SUBJECTS: [&[Subject]; 4] = [blocks::SUBJECTS, cells::SUBJECTS, paths::SUBJECTS, maps::SUBJECTS];
