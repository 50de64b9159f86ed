//! A pair of a batch.

use std::path::{Path, PathBuf};

/// A pair of a batch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pair {
    /// Folder of the results, in the output folder.
    pub name: String,
    /// Left view, or the file with both.
    pub left: PathBuf,
    pub right: Option<PathBuf>,
    /// Calibration of this pair; else that of the batch.
    pub calibration: Option<PathBuf>,
}

impl Pair {
    /// The files of both views, which may be one.
    pub fn files(&self) -> [&Path; 2] {
        [&self.left, self.right.as_ref().unwrap_or(&self.left)]
    }
}
