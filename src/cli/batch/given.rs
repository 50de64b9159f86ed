//! The pairs of a batch that are known before any is matched.

use std::path::Path;

use anyhow::{Context, Result};

use super::{list::List, listing::Listing, names::Names, pair::Pair};

/// Pairs of folders, or those of a list.
pub enum Given {
    Found(Listing),
    Listed(List),
}

/// What all pairs together are.
#[derive(Clone, Copy, Debug, Default)]
pub struct Summary {
    pub count: usize,
    /// Whether any pair has a calibration of its own.
    pub has_calibrations: bool,
    /// Whether any pair has both views in one file.
    pub has_both_in_one: bool,
}

impl Given {
    /// What the run's summary says of views without a partner; `None` if there are none.
    pub fn left_out(&self) -> Option<String> {
        match self {
            Self::Found(listing) => listing.left_out(),
            Self::Listed(_) => None,
        }
    }

    fn pairs(&self) -> Box<dyn Iterator<Item = Result<Pair>> + '_> {
        match self {
            Self::Found(listing) => Box::new(listing.pairs.iter().cloned().map(Ok)),
            Self::Listed(list) => Box::new(list.pairs()),
        }
    }

    /// The pairs, one by one.
    pub fn into_pairs(self) -> Box<dyn Iterator<Item = Result<Pair>> + Send> {
        match self {
            Self::Found(listing) => Box::new(listing.pairs.into_iter().map(Ok)),
            Self::Listed(list) => Box::new(list.into_pairs()),
        }
    }

    /// Checks all pairs, and that each has a folder of its own in the `output` folder.
    ///
    /// # Errors
    /// What is wrong with a row of a list, and those of [`Names`].
    pub fn check(&self, output: &Path) -> Result<Summary> {
        let (mut names, mut summary) = (Names::new(output), Summary::default());
        for pair in self.pairs() {
            let pair = pair?;
            names.add(&pair)?;
            summary.count += 1;
            summary.has_calibrations |= pair.calibration.is_some();
            summary.has_both_in_one |= pair.right.is_none();
        }
        names.check(|place| self.pairs().nth(place).context("the list has changed")?)?;
        Ok(summary)
    }
}
