//! Pairs that were found in folders, and the views that are in none.

use std::{ffi::OsStr, path::PathBuf};

use super::pair::Pair;

/// Views without a partner that the summary names at most.
const NAMED: usize = 3;

/// What was found in folders.
#[derive(Debug, Default)]
pub struct Listing {
    pub pairs: Vec<Pair>,
    /// Left and right views without a partner.
    pub alone: [Vec<PathBuf>; 2],
}

impl Listing {
    /// Pairs alone.
    pub fn of(pairs: Vec<Pair>) -> Self {
        Self { pairs, alone: Default::default() }
    }

    /// What the summary says of views without a partner; `None` if there are none.
    pub fn left_out(&self) -> Option<String> {
        let [left, right] = self.alone.each_ref().map(Vec::len);
        let named: Vec<String> = self.alone.iter().flatten().take(NAMED).map(|path| hsad::shown(path)).collect();
        let more = if left + right > NAMED { ", ..." } else { "" };
        (left + right > 0)
            .then(|| format!("views without a partner: {left} left, {right} right ({}{more})", named.join(", ")))
    }
}

/// Whether a file or folder is hidden, by its name: systems keep files of their own so beside pictures (`._a.png`).
pub fn is_hidden(name: &OsStr) -> bool {
    name.as_encoded_bytes().starts_with(b".")
}
