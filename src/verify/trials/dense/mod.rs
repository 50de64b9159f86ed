//! Dense matching.

mod blocks;
mod cells;
mod maps;
mod paths;

pub use blocks::*;
pub use cells::*;
pub use maps::*;
pub use paths::*;

use crate::verify::trial::Subject;

pub(super) const DENSE_SUBJECTS: [&[Subject]; 4] = [blocks::SUBJECTS, cells::SUBJECTS, paths::SUBJECTS, maps::SUBJECTS];
