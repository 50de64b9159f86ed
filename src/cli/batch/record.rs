//! What became of a pair.

use std::{fmt, time::Duration};

use hsad::{pipeline::Step, report::number};
use serde_json::{Value, json};

use super::{super::job::CompletedJob, inputs::Recorded, pair::Pair};

/// What became of a pair, as JSON: its `name` and `status`, and what the status asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct Record(Value);

/// Status of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// All files are there.
    Done,
    /// All files are there, and the map is not to be trusted, or the depth that was asked for is missing.
    Doubtful,
    /// No file is there: the pair could not be read, rectified, matched or written.
    Failed,
}

impl Status {
    pub const ALL: [Self; 3] = [Self::Done, Self::Doubtful, Self::Failed];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Doubtful => "doubtful",
            Self::Failed => "failed",
        }
    }
}

/// What is kept of the record of a pair that is done.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    pub status: Status,
    /// Whether the pair was matched by the precedent of an earlier frame.
    pub follows: bool,
    /// Why the pair is doubtful.
    pub reason: Option<Box<str>>,
    /// What the pair was made of.
    pub inputs: Recorded,
    /// Whether a later try has failed, which leaves the results as they are.
    pub has_failed_since: bool,
}

/// Times of the parts of the work on a pair.
#[derive(Clone, Copy, Debug, Default)]
pub struct Times {
    /// Reading and decoding.
    pub read: Duration,
    /// Matching.
    pub matched: Duration,
    /// Encoding and writing.
    pub written: Duration,
}

/// Seconds of the parts of the work on pairs, in order. The steps of the pipeline are parts of the matching.
#[derive(Clone, Debug, Default)]
pub struct Stages {
    seconds: [f64; Self::NAMES.len()],
    pairs: u32,
}

impl Stages {
    const NAMES: [&str; 7] = [
        "reading",
        "matching",
        Step::Luma.name(),
        Step::Features.name(),
        Step::Seeding.name(),
        Step::Dense.name(),
        "writing",
    ];

    /// Those of a pair.
    fn of(times: Times, steps: &[(Step, Duration)]) -> Self {
        let step = |wanted| steps.iter().filter(|(step, _)| *step == wanted).map(|(_, time)| *time).sum();
        let [luma, features, seeding, dense] = Step::ALL.map(step);
        let all: [Duration; 7] = [times.read, times.matched, luma, features, seeding, dense, times.written];
        Self { seconds: all.map(|time| time.as_secs_f64()), pairs: 1 }
    }

    fn to_json(&self) -> Value {
        Self::NAMES.iter().zip(self.seconds).map(|(name, seconds)| ((*name).to_owned(), json!(seconds))).collect()
    }

    /// Adds those of a pair, if it has any.
    pub fn add(&mut self, record: &Record) {
        let Some(seconds) = record.0["seconds"].as_object() else { return };
        for (sum, name) in self.seconds.iter_mut().zip(Self::NAMES) {
            *sum += seconds[name].as_f64().unwrap_or_default();
        }
        self.pairs += 1;
    }

    /// The means, if there is any pair.
    pub fn mean(&self) -> Option<impl fmt::Display> {
        let mean = |(name, seconds): (&&str, f64)| format!("{name} {:.3}", seconds / f64::from(self.pairs));
        (self.pairs > 0).then(|| Self::NAMES.iter().zip(self.seconds).map(mean).collect::<Vec<_>>().join(", "))
    }
}

impl Record {
    fn new(pair: &Pair, status: Status, exit_code: i32, reason: Option<&str>) -> Self {
        let [left, right] = pair.files().map(|path| path.display().to_string());
        Self(json!({
            "name": pair.name,
            "status": status.name(),
            "exit_code": exit_code,
            "reason": reason,
            "left": left,
            "right": right,
        }))
    }

    /// The record of a pair whose files are written. `exit_code` and `reason` are those of `hsad match`.
    pub fn written(
        pair: &Pair,
        inputs: Value,
        completed: &CompletedJob,
        (exit_code, reason): (i32, Option<&str>),
        times: Times,
    ) -> Self {
        let status = if exit_code == 0 { Status::Done } else { Status::Doubtful };
        let Self(mut value) = Self::new(pair, status, exit_code, reason);
        let outcome = &completed.outcome;
        value["inputs"] = inputs;
        value["width"] = completed.job.left.width().into();
        value["height"] = completed.job.left.height().into();
        value["trust"] = number(outcome.trust);
        value["min_disparity"] = outcome.range.min.into();
        value["disparities"] = outcome.range.count.into();
        value["warnings"] = json!(completed.warnings);
        value["follows"] = completed.follows.into();
        value["seconds"] = Stages::of(times, &outcome.times).to_json();
        Self(value)
    }

    /// The record of a pair that came to nothing.
    pub fn failed(pair: &Pair, exit_code: i32, reason: &str) -> Self {
        Self::new(pair, Status::Failed, exit_code, Some(reason))
    }

    /// The record of a pair whose files an earlier run has written, before it could record that.
    pub fn found(pair: &Pair, report: &Value) -> Self {
        let reason = ["not_trusted", "no_depth"].into_iter().find_map(|doubt| report[doubt].as_str());
        let code = match (report["not_trusted"].is_null(), reason) {
            (_, None) => 0,
            (false, _) => super::super::doubts::NotTrusted::EXIT_CODE,
            _ => super::super::doubts::NoDepth::EXIT_CODE,
        };
        let status = if code == 0 { Status::Done } else { Status::Doubtful };
        let Self(mut value) = Self::new(pair, status, code, reason);
        for field in ["inputs", "width", "height", "trust", "warnings"] {
            value[field] = report[field].clone();
        }
        value["follows"] = (report["follows"] == true).into();
        Self(value)
    }

    /// A record of an earlier run; `None` if the value is none.
    pub fn from_json(value: Value) -> Option<Self> {
        let record = Self(value);
        let is_known =
            record.0["name"].is_string() && Status::ALL.iter().any(|status| record.0["status"] == status.name());
        is_known.then_some(record)
    }

    pub fn to_json(&self) -> &Value {
        &self.0
    }

    pub fn name(&self) -> &str {
        self.0["name"].as_str().unwrap_or_default()
    }

    /// What later runs need of the record; `None` of a pair that has failed and is tried again.
    ///
    /// # Errors
    /// Of a pair that is done and has no inputs, its name.
    pub fn finished(&self) -> Result<Option<Finished>, &str> {
        let status = self.status();
        if status == Status::Failed {
            return Ok(None);
        }
        let inputs = Recorded::of(&self.0).ok_or(self.name())?;
        Ok(Some(Finished {
            status,
            follows: self.follows(),
            reason: self.reason().map(Box::from),
            inputs,
            has_failed_since: false,
        }))
    }

    pub fn status(&self) -> Status {
        Status::ALL.into_iter().find(|status| self.0["status"] == status.name()).unwrap_or(Status::Failed)
    }

    /// Whether the pair was matched by the precedent of an earlier frame.
    pub fn follows(&self) -> bool {
        self.0["follows"] == true
    }

    /// Why the pair is not simply done.
    pub fn reason(&self) -> Option<&str> {
        self.0["reason"].as_str()
    }
}
