//! Interest points.

mod description;
mod detection;
mod integral;
mod tolerances;

pub use description::{DescriptorTrial, FeaturesTrial, OrientationTrial};
pub use detection::{HessianTrial, NonmaxTrial, WorkgroupsTrial};
pub use integral::{ColumnsTrial, RowsTrial};

use crate::verify::trial::Subject;

pub(super) const SUBJECTS: [&[Subject]; 3] = [integral::SUBJECTS, detection::SUBJECTS, description::SUBJECTS];
