//! What each kernel and pipeline is tried on, in the rooms of the stages.

mod dense;
mod features;
mod kamencay;
mod luma;
mod pipelines;

pub use dense::*;
pub use features::*;
pub use kamencay::*;
pub use luma::*;
pub use pipelines::*;

use super::trial::Subject;

/// Everything that is tried, kernels first.
pub fn subjects() -> impl Iterator<Item = &'static Subject> {
    let rooms: [&[&[Subject]]; 4] =
        [&[luma::SUBJECTS], &FEATURE_SUBJECTS, &DENSE_SUBJECTS, &[kamencay::SUBJECTS, pipelines::SUBJECTS]];
    rooms.into_iter().flatten().copied().flatten()
}
