//! Interest points.

mod description;
mod detection;
mod integral;
mod tolerances;

pub use description::{DescriptorTrial, FeaturesTrial, OrientationTrial};
pub use detection::{HessianTrial, NonmaxTrial, WorkgroupsTrial};
pub use integral::{ColumnsTrial, RowsTrial};

#[cfg(test)]
use crate::verify::array::{Array, Comparison};
use crate::verify::trial::Subject;

pub(super) const SUBJECTS: [&[Subject]; 3] = [integral::SUBJECTS, detection::SUBJECTS, description::SUBJECTS];

/// Whether a comparison of device and twin finds a fault.
#[cfg(test)]
fn differ(actual: &[Array], expected: &[Array]) -> bool {
    let differs = |(actual, expected)| Comparison::new(actual, expected).fault.is_some();
    actual.iter().zip(expected).any(differs)
}
