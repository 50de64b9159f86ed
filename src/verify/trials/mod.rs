//! The trials of all kernels and pipelines, in folders like the stages.

mod dense;
mod features;
mod kamencay;
mod luma;
mod pipelines;
mod rectify;

pub use dense::{
    AgreementTrial, BitmapTrial, BlockMatchTrial, BoxMeanTrial, CellCostTrial, CellPathTrial, CellRangesTrial,
    CellSelectTrial, CensusTrial, ClaimTrial, ConfidenceTextureTrial, ConsistencyTrial, CostKernel, CostTrial,
    DepthTextureTrial, FillTrial, HalveTrial, LanePathTrial, LaneSelectTrial, MapBackTrial, MapTextureTrial,
    MedianTrial, PadTrial, PathTrial, PointCountsTrial, PointsTrial, ProjectTrial, ResidualTrial, SelectTrial,
    SoftRankTrial, SupportTrial, TangentTrial, UnseenTrial,
};
pub use features::{
    ColumnsTrial, DescriptorTrial, FeaturesTrial, HessianTrial, NonmaxTrial, OrientationTrial, RowsTrial,
    WorkgroupsTrial,
};
pub use kamencay::{BeliefCostTrial, BeliefReduceTrial, BeliefSelectTrial, BeliefTrial, KamencayTrial, MeanShiftTrial};
pub use luma::{LumaTextureTrial, LumaTrial, RgbaTextureTrial, RgbaTrial};
pub use pipelines::{DenseTrial, PyramidTrial};
pub use rectify::{WarpColoursTrial, WarpTrial};

use super::trial::Subject;

/// All subjects, kernels first.
pub fn subjects() -> impl Iterator<Item = &'static Subject> {
    let rooms: [&[&[Subject]]; 4] = [
        &[luma::SUBJECTS, rectify::SUBJECTS],
        &features::SUBJECTS,
        &dense::SUBJECTS,
        &[kamencay::SUBJECTS, pipelines::SUBJECTS],
    ];
    rooms.into_iter().flatten().copied().flatten()
}
