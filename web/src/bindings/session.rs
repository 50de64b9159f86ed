//! Matching on the browser's GPU.

use std::rc::Rc;

use hsad::{
    Backend, Error,
    gpu::DeviceChoice,
    io::Picture,
    pipeline::{self, Mirrored, Outcome, RectifiedPair, Step, TRUSTED, doubts},
    seeding::Rectification,
};
use wasm_bindgen::prelude::*;
use web_time::Instant;

use super::{
    cancel::Cancel,
    errors::{named, thrown},
    matched::Matched,
    task::{Cameras, Task},
    views::View,
};

/// The browser's GPU, opened.
#[wasm_bindgen]
pub struct Session {
    backend: Rc<Backend>,
    cancel: Cancel,
}

#[wasm_bindgen]
impl Session {
    /// Opens the GPU that the browser offers.
    pub async fn open() -> Result<Self, JsValue> {
        let backend = Backend::open_async(&DeviceChoice::Best).await.map_err(thrown)?;
        Ok(Self { backend: backend.into(), cancel: Cancel::default() })
    }

    /// Matches a pair as `task` says, see [`Task::read`]. `begin` is called with the name of each step, and with `rectifying` where
    /// the pair is rectified first; `progress` with the share of the last step that is done, 0 to 1.
    #[wasm_bindgen(js_name = matchPair)]
    pub async fn match_pair(
        &self,
        left: View,
        right: View,
        task: &str,
        begin: js_sys::Function,
        progress: js_sys::Function,
    ) -> Result<Matched, JsValue> {
        let start = Instant::now();
        let task = Task::read(task, [left.0.size(), right.0.size()]).map_err(thrown)?;
        // An error of the page's callbacks does not stop the match.
        let run = Run {
            backend: &self.backend,
            views: (&left.0, &right.0),
            task: &task,
            begin: &|step| drop(begin.call1(&JsValue::NULL, &step.into())),
            progress: &|share| drop(progress.call1(&JsValue::NULL, &share.into())),
        };
        let found =
            self.cancel.unless(run.found()).await.ok_or_else(|| named("Cancelled", "the match was cancelled"))?;
        let Found { outcome, rectified, mirrored, warnings: on_the_way } = found.map_err(thrown)?;
        let total = start.elapsed();

        let pictures = rectified.as_ref().map_or([&left.0, &right.0], |pair| pair.pictures.each_ref());
        let mut calibration = match (&rectified, &task.cameras) {
            (Some(pair), _) => pair.rectification.calibration().copied(),
            (None, Cameras::Rectified(calibration)) => Some(*calibration),
            (None, _) => None,
        };
        let mut warnings = [task.warnings.clone(), on_the_way].concat();
        let mut not_trusted = doubts::not_trusted(&outcome, calibration.as_ref());
        match (mirrored, &mut not_trusted) {
            (Some(sides), Some(reason)) => *reason = doubts::mirrored(sides),
            _ => warnings.extend(doubts::warnings((pictures[0], pictures[1]), &task.config, &outcome)),
        }
        if task.config.force {
            warnings.extend(not_trusted.take());
        }
        let aside = calibration.filter(|_| rectified.is_none());
        if let Some(doubt) = aside.and_then(|calibration| doubts::looks_to_the_side(&outcome, &calibration)) {
            warnings.push(doubt);
            calibration = None;
        }
        let picture = pictures[0].clone();
        let backend = Rc::clone(&self.backend);
        Ok(Matched { backend, task, picture, calibration, outcome, rectified, warnings, not_trusted, total })
    }

    /// Cancels the match that is going on, at its next wait for the GPU.
    pub fn cancel(&self) {
        self.cancel.request();
    }
}

/// What matching gave, and the rectified pair that was matched, if one was.
struct Found {
    outcome: Outcome,
    rectified: Option<RectifiedPair>,
    /// How one view mirrors the other, looked for where the map is not to be trusted.
    mirrored: Option<Mirrored>,
    warnings: Vec<String>,
}

/// A pair on its way to a map.
struct Run<'a> {
    backend: &'a Backend,
    views: (&'a Picture, &'a Picture),
    task: &'a Task,
    begin: &'a dyn Fn(&str),
    progress: &'a dyn Fn(f32),
}

impl Run<'_> {
    /// The map of the pair, and whether one view is a mirror image if the pair was refused or its map is not to be trusted.
    async fn found(&self) -> Result<Found, Error> {
        let mut found = self.matched().await;
        let is_doubtful = match &found {
            Ok(found) => found.outcome.trust < TRUSTED && found.outcome.no_depth.is_none(),
            Err(error) => matches!(error, Error::NotRectified { .. } | Error::NotRectifiable { .. }),
        };
        let mirrored = if is_doubtful { pipeline::mirrored_async(self.backend, self.views).await? } else { None };
        match (&mut found, mirrored) {
            (Ok(found), mirrored) => found.mirrored = mirrored,
            (Err(_), Some(sides)) => return Err(Error::NotRectifiable { reason: doubts::mirrored(sides) }),
            (Err(_), None) => {}
        }
        found
    }

    /// Matches the pair as it is, or rectified first: by its calibration if that is of the pictures as they were taken, and from its
    /// matches if rows do not correspond.
    async fn matched(&self) -> Result<Found, Error> {
        if let Cameras::Taken(stereo) = &self.task.cameras {
            (self.begin)("rectifying");
            let pair = pipeline::rectify_by_async(self.backend, self.views, stereo).await?;
            return self.along_rows_of(pair, None).await;
        }
        let config = &self.task.config;
        let why = match self.as_it_is_unless_distorted().await {
            Ok(Some(outcome)) => return Ok(as_taken(outcome)),
            Ok(None) => "the lens distorts the pictures".into(),
            Err(Error::NotRectified { diagnosis }) if config.align => format!("the pair is not rectified: {diagnosis}"),
            Err(error @ Error::SizesDiffer { .. }) if config.align && !config.force => error.to_string(),
            Err(error) => return Err(error),
        };
        let is_distorted = why.starts_with("the lens");
        (self.begin)("rectifying");
        match pipeline::rectify_async(self.backend, self.views).await {
            // A distortion that matches do not tell is left to the small warp of the right view.
            Ok(pair) if is_distorted && pair.rectification.distortion() == 0.0 => self.as_it_is().await.map(as_taken),
            Err(Error::NotRectifiable { .. }) if is_distorted => self.as_it_is().await.map(as_taken),
            Ok(pair) => self.along_rows_of(pair, Some(why)).await,
            Err(Error::NotRectifiable { reason }) => Err(Error::NotRectifiable { reason: format!("{reason}; {why}") }),
            Err(error) => Err(error),
        }
    }

    async fn as_it_is(&self) -> Result<Outcome, Error> {
        let begin = |step: Step| (self.begin)(step.name());
        pipeline::run_with_progress(self.backend, self.views, &self.task.config, begin, self.progress).await
    }

    /// As [`Self::as_it_is`]; `None` if the lens distorts the rows, which no warp of the rows of one view mends, and nothing is lost by
    /// a rectification: without a calibration.
    async fn as_it_is_unless_distorted(&self) -> Result<Option<Outcome>, Error> {
        let Task { config, cameras, .. } = self.task;
        let may_rectify = config.align && !config.force && matches!(cameras, Cameras::Unknown);
        let is_unfit = |rows: &Rectification| may_rectify && rows.is_distorted();
        let begin = |step: Step| (self.begin)(step.name());
        pipeline::run_unless(self.backend, self.views, config, is_unfit, begin, self.progress).await
    }

    /// Matches a rectified pair; `why` it had to be rectified without a calibration.
    async fn along_rows_of(&self, pair: RectifiedPair, why: Option<String>) -> Result<Found, Error> {
        let config = &self.task.config;
        let begin = |step: Step| (self.begin)(step.name());
        let outcome = pipeline::run_rectified(self.backend, &pair, config, begin, self.progress).await?;
        let mut warnings: Vec<String> = doubts::of_rectified(&pair).into_iter().collect();
        if let Some(why) = why {
            warnings.push(format!("{why}; disparities are those of the pair rectified from its matches"));
            if matches!(self.task.cameras, Cameras::Rectified(_)) {
                warnings.push("no depth: a pair rectified without calibration has no known baseline".into());
            }
        }
        Ok(Found { outcome, rectified: Some(pair), mirrored: None, warnings })
    }
}

/// The outcome of a pair that was matched as it was taken.
fn as_taken(outcome: Outcome) -> Found {
    Found { outcome, rectified: None, mirrored: None, warnings: Vec::new() }
}
