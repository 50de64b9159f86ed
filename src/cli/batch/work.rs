//! The work on a pair: as `hsad match` does it, on a device that is open.

use std::{
    fs,
    ops::ControlFlow,
    time::{Duration, Instant},
};

use anyhow::Result;
use hsad::{
    Backend, Error,
    io::{load::Halves, recording::RecordedCalibration},
    pipeline::Precedent,
};
use serde_json::Value;

use super::{
    super::{
        exit_code,
        job::CompletedJob,
        output::Output,
        recipe::{Known, Prepared, Recipe},
        terminal::{Progress, described},
        view_files::Views,
    },
    feed::Member,
    frame::Frame,
    inputs::Contents,
    journal::Earlier,
    pair::Pair,
    record::{Record, Times},
    results::Results,
    storage,
};

/// What all pairs share.
pub struct Work<'a> {
    pub backend: &'a Backend,
    pub recipe: &'a Recipe,
    pub halves: Option<Halves>,
    /// The calibration that a recording has.
    pub recorded: Option<&'a RecordedCalibration>,
    pub results: &'a Results<'a>,
    pub earlier: &'a Earlier,
}

/// What comes of a pair.
struct Done {
    record: Record,
    /// What frames after it know, unless they know what the pair knew.
    told: Option<Before>,
}

/// What a frame knows of those before it.
enum Before {
    Nothing,
    Known(Box<Precedent>),
    /// An earlier run has matched this pair by itself.
    Finished(Pair, Option<Frame>),
    /// Such a pair cannot be matched again, for this reason.
    Lost(String),
}

impl Work<'_> {
    /// Works on the pairs of a group, one after the other, and calls `then` with the record of each until it breaks.
    ///
    /// An error that `then` gets is one after which no pair can be matched or written; whatever else is wrong with a pair is in its record.
    pub fn on_group(
        &self,
        members: impl Iterator<Item = Member>,
        then: impl Fn(hsad::Result<Record>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut before = Before::Nothing;
        for Member { pair, frame, finished } in members {
            let told = match finished {
                Some(finished) => (!finished.follows).then_some(Before::Finished(pair, frame)),
                None => match self.on(pair, frame, &mut before) {
                    Ok(Done { record, told }) => {
                        then(Ok(record))?;
                        told
                    }
                    Err(error) => return then(Err(error)),
                },
            };
            before = told.unwrap_or(before);
        }
        ControlFlow::Continue(())
    }

    /// The precedent that is known before a frame, or why it is not. One of an earlier run is matched again, and its files stay as they are.
    fn known<'b>(&self, before: &'b mut Before) -> hsad::Result<Result<Option<&'b Precedent>, &'b str>> {
        if let Before::Finished(pair, frame) = before {
            *before = match self.matched(pair, frame.as_ref(), None) {
                Ok(matched) => Before::of(matched.completed.precedent),
                Err(error) => {
                    let reason = format!(
                        "the frame '{}', which this one follows, cannot be matched again: {}",
                        pair.name,
                        described(&error)
                    );
                    fatal::<()>(error)?;
                    Before::Lost(reason)
                }
            };
        }
        Ok(match before {
            Before::Known(precedent) => Ok(Some(precedent)),
            Before::Lost(reason) => Err(reason),
            _ => Ok(None),
        })
    }

    /// Matches a pair and writes its files, unless they are there.
    fn on(&self, pair: Pair, frame: Option<Frame>, before: &mut Before) -> hsad::Result<Done> {
        if let Some(report) = self.results.report_of(&pair, frame.as_ref()) {
            let record = Record::found(&pair, &report);
            let told = (!record.follows()).then_some(Before::Finished(pair, frame));
            return Ok(Done { record, told });
        }
        let precedent = match self.known(before)? {
            Ok(precedent) => precedent,
            Err(reason) => return Ok(Done { record: Record::failed(&pair, 1, reason), told: None }),
        };
        let matched = self.matched(&pair, frame.as_ref(), precedent);
        matched.and_then(|matched| self.written(&pair, frame.as_ref(), matched)).or_else(|error| {
            let record = Record::failed(&pair, exit_code(&error), &described(&error));
            fatal(error).map(|told| Done { record, told })
        })
    }

    fn matched(&self, pair: &Pair, frame: Option<&Frame>, precedent: Option<&Precedent>) -> Result<Matched> {
        let start = Instant::now();
        let folder = self.results.folder.join(&pair.name);
        // Pairs that are worked on beside this one may have the folder above, too: none of them may remove it as its own.
        if let Some(above) = folder.parent() {
            fs::create_dir_all(above).map_err(|source| Error::Io { path: above.into(), source })?;
        }
        let mut output = Output::open_set(&folder)?;
        if self.earlier.has_written(pair, frame) {
            output.take_over();
        }
        let Contents { pictures, calibration, inputs } = Contents::read(pair, frame)?;
        let in_memory = Some(pictures.in_memory());
        let views = Views { left: &pair.left, right: pair.right.as_deref(), halves: self.halves, in_memory };
        let known = match (pair.calibration.as_ref().zip(calibration.as_ref()), self.recorded) {
            (Some((file, text)), _) => Known::File(file, text),
            (None, Some(recorded)) => Known::Recorded(recorded),
            (None, None) => Known::Nothing,
        };
        let Prepared { job, warnings } = self.recipe.prepare(&views, known, &mut output)?;
        let read = start.elapsed();
        let mut completed = job.run_on(self.backend, precedent, &Progress::new(true), Instant::now())?;
        completed.warnings.splice(0..0, warnings);
        Ok(Matched { output, inputs, completed, read, matched: start.elapsed() - read })
    }

    fn written(&self, pair: &Pair, frame: Option<&Frame>, matched: Matched) -> Result<Done> {
        let Matched { mut output, inputs, mut completed, read, matched } = matched;
        let start = Instant::now();
        self.recipe.add_files(&mut completed, Some(&inputs), &mut output)?;
        // Runs with other journals may have written results of this name in the meantime.
        self.results.of(pair, frame)?;
        output.finish()?;
        let times = Times { read, matched, written: start.elapsed() };
        let shortfall = completed.shortfall().map(|error| (exit_code(&error), described(&error)));
        let (code, reason) = shortfall.as_ref().map_or((0, None), |(code, reason)| (*code, Some(reason.as_str())));
        let record = Record::written(pair, inputs, &completed, (code, reason), times);
        let told = (!completed.follows).then(|| Before::of(completed.precedent));
        Ok(Done { record, told })
    }
}

/// A matched pair, whose files are not written.
struct Matched {
    output: Output,
    /// What the pair was made of.
    inputs: Value,
    completed: CompletedJob,
    read: Duration,
    matched: Duration,
}

impl Before {
    fn of(precedent: Option<Precedent>) -> Self {
        precedent.map_or(Self::Nothing, |precedent| Self::Known(Box::new(precedent)))
    }
}

/// The error of a device that is lost, or of storage that takes no more files; nothing for any other one, which is that of a pair.
fn fatal<T>(error: anyhow::Error) -> hsad::Result<Option<T>> {
    let is_full = storage::way_out(&error).is_some();
    match error.downcast::<Error>() {
        Ok(lost @ Error::DeviceLost(_)) => Err(lost),
        Ok(full) if is_full => Err(full),
        _ => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use hsad::{image::Plane, io::png};
    use serde_json::json;

    use super::*;

    #[derive(Parser)]
    struct Options {
        #[command(flatten)]
        recipe: Recipe,
    }

    #[test]
    fn results_of_other_inputs_that_came_in_the_meantime_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let picture = folder.path().join("picture.png");
        let mut bytes = Vec::new();
        png::write_grey8(&mut bytes, &Plane::from_fn((40, 30), |x, y| (x * x * 7 + y * y * 3 + x * y) as u8)).unwrap();
        fs::write(&picture, bytes).unwrap();
        let pair = Pair { name: "a".into(), left: picture.clone(), right: Some(picture.clone()), calibration: None };
        let options = ["hsad", "--preset", "fast", "--disparities", "8", "--rectify", "never", "--force"];
        let Options { recipe } = Options::parse_from(options);
        let results = Results { folder: &folder.path().join("out"), resumes: false, parameters: Value::Null };
        let work = Work {
            backend: &Backend::Cpu,
            recipe: &recipe,
            halves: None,
            recorded: None,
            results: &results,
            earlier: &Earlier::default(),
        };
        let write = || work.written(&pair, None, work.matched(&pair, None, None).unwrap());
        write().unwrap();
        let report = folder.path().join("out/a/report.json");
        let mut other: Value = serde_json::from_slice(&fs::read(&report).unwrap()).unwrap();
        write().unwrap();
        let matched = work.matched(&pair, None, None).unwrap();
        other["inputs"]["left"]["hash"] = json!("0");
        other["inputs"]["left"]["path"] = json!("/other.png");
        fs::write(&report, other.to_string()).unwrap();
        let error = work.written(&pair, None, matched).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("picture.png has changed or is another one"), "{error}");
        assert_eq!(fs::read_to_string(&report).unwrap(), other.to_string());
    }
}
