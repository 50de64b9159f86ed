//! The work on a pair: as `hsad match` does it, on a device that is open.

use std::{path::Path, time::Instant};

use anyhow::Result;
use hsad::{Backend, Error, io::load::Halves};

use super::{
    super::{
        exit_code,
        output::Output,
        recipe::{Prepared, Recipe},
        terminal::{Progress, described},
        view_files::Views,
    },
    pair::Pair,
    record::{Record, Times},
    results::Results,
};

/// What all pairs share.
pub struct Work<'a> {
    pub backend: &'a Backend,
    pub recipe: &'a Recipe,
    pub halves: Option<Halves>,
    pub results: &'a Results<'a>,
}

impl Work<'_> {
    /// Matches a pair and writes its files, unless they are there.
    ///
    /// # Errors
    /// [`hsad::Error::DeviceLost`], after which no pair can be matched; whatever else is wrong with a pair is in its record.
    pub fn on(&self, pair: &Pair) -> hsad::Result<Record> {
        let folder = self.results.folder.join(&pair.name);
        if let Some(report) = self.results.report_of(pair) {
            return Ok(Record::found(pair, &report));
        }
        self.matched(pair, &folder).or_else(|error| match error.downcast::<Error>() {
            Ok(lost @ Error::DeviceLost(_)) => Err(lost),
            Ok(error) => Ok(failed(pair, &error.into())),
            Err(error) => Ok(failed(pair, &error)),
        })
    }

    fn matched(&self, pair: &Pair, folder: &Path) -> Result<Record> {
        let start = Instant::now();
        let mut output = Output::open_set(folder)?;
        let views = Views { left: &pair.left, right: pair.right.as_deref(), halves: self.halves };
        let Prepared { job, warnings } = self.recipe.prepare(&views, pair.calibration.as_deref(), &mut output)?;
        let read = start.elapsed();
        let mut completed = job.run_on(self.backend, &Progress::new(true), Instant::now())?;
        completed.warnings.splice(0..0, warnings);
        let matched = start.elapsed() - read;
        self.recipe.add_files(&mut completed, &mut output)?;
        output.finish()?;
        let times = Times { read, matched, written: start.elapsed() - read - matched };
        let shortfall = completed.shortfall().map(|error| (exit_code(&error), described(&error)));
        let (code, reason) = shortfall.as_ref().map_or((0, None), |(code, reason)| (*code, Some(reason.as_str())));
        Ok(Record::written(pair, &completed, (code, reason), times))
    }
}

fn failed(pair: &Pair, error: &anyhow::Error) -> Record {
    Record::failed(pair, exit_code(error), &described(error))
}
