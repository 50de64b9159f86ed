//! Interest points.

mod description;
mod detection;
mod integral;
mod tolerances;

pub use description::*;
pub use detection::*;
pub use integral::*;

use crate::verify::trial::Subject;

pub(super) const FEATURE_SUBJECTS: [&[Subject]; 3] = [integral::SUBJECTS, detection::SUBJECTS, description::SUBJECTS];
