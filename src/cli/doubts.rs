//! Doubts about a map, in the words of the program.

use hsad::{
    config::Config,
    io::Picture,
    pipeline::{Outcome, RectifiedPair, doubts},
};

use super::wording::in_words_of_options;

pub use hsad::pipeline::doubts::{mirrored, of_rectified, span};

/// A map that is likely to be wrong in large parts, or that shows no depth. The files are written all the same.
#[derive(Debug, thiserror::Error)]
#[error("{reason}; the files were written, and --force accepts the result")]
pub struct NotTrusted {
    /// What is doubtful, in words.
    pub reason: String,
}

impl NotTrusted {
    /// The exit code of a run that wrote such a map.
    pub const EXIT_CODE: i32 = 4;
}

/// A depth that was asked for and does not follow from the map. The files of the map were written all the same.
#[derive(Debug, thiserror::Error)]
#[error("{reason}; the files were written, and --force accepts the result without depth")]
pub struct NoDepth {
    /// Why there is none, in words.
    pub reason: String,
}

impl NoDepth {
    /// The exit code of a run that wrote no depth though a calibration asked for it.
    pub const EXIT_CODE: i32 = 5;
}

/// The warnings about a result: see [`doubts::warnings`].
pub fn warnings(
    views: (&Picture, &Picture),
    config: &Config,
    outcome: &Outcome,
    rectified: Option<&RectifiedPair>,
) -> Vec<String> {
    doubts::warnings(views, config, outcome, rectified).iter().map(|warning| in_words_of_options(warning)).collect()
}
