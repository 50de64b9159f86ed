//! Dense matching.

mod blocks;
mod cells;
mod checks;
mod costs;
mod depths;
mod filling;
mod lanes;
mod levels;
mod maps;
mod paths;
mod planes;
mod words;

pub use blocks::BlockMatchTrial;
pub use cells::{CellRangesTrial, HalveTrial};
pub use checks::{AgreementTrial, ConsistencyTrial, UnseenTrial};
pub use costs::{BoxMeanTrial, CensusTrial, CostKernel, CostTrial};
pub use depths::{ConfidenceTextureTrial, DepthTextureTrial, PointCountsTrial, PointsTrial};
pub use filling::{BitmapTrial, FillTrial, ProjectTrial, TangentTrial};
pub use lanes::{LanePathTrial, LaneSelectTrial};
pub use levels::{CellCostTrial, CellPathTrial, CellSelectTrial};
pub use maps::{MapBackTrial, MapTextureTrial, MedianTrial, ResidualTrial, SupportTrial};
pub use paths::{ClaimTrial, PathTrial, SelectTrial};
pub use planes::{PadTrial, SoftRankTrial};

use crate::verify::trial::Subject;

pub(super) const SUBJECTS: [&[Subject]; 11] = [
    planes::SUBJECTS,
    blocks::SUBJECTS,
    cells::SUBJECTS,
    costs::SUBJECTS,
    paths::SUBJECTS,
    lanes::SUBJECTS,
    levels::SUBJECTS,
    checks::SUBJECTS,
    maps::SUBJECTS,
    depths::SUBJECTS,
    filling::SUBJECTS,
];
