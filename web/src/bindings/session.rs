//! Matching on the browser's GPU.

use std::rc::Rc;

use hsad::{
    Backend,
    gpu::DeviceChoice,
    pipeline::{self, Activity},
};
use wasm_bindgen::prelude::*;
use web_time::Instant;

use super::{
    cancel::Cancel,
    errors::{named, thrown},
    matched::Matched,
    task::Task,
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

    /// Matches a pair as `task` says, see [`Task::read`], in the way of `hsad match`. `begin` is called with the name of each step, and
    /// with `rectifying` and `mirror`; `progress` with the share of the last step that is done, 0 to 1.
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
        let pair = pipeline::Task {
            precedent: None,
            backend: &self.backend,
            views: (&left.0, &right.0),
            config: &task.config,
            way: &task.way,
            calibration: task.calibration,
            // An error of the page's callbacks does not stop the match.
            begin: &|activity| drop(begin.call1(&JsValue::NULL, &name(activity).into())),
            progress: &|share| drop(progress.call1(&JsValue::NULL, &share.into())),
        };
        let matched = self.cancel.unless(pair.run_async()).await;
        let mut matched = matched.ok_or_else(|| named("Cancelled", "the match was cancelled"))?.map_err(thrown)?;
        matched.judgement.warnings.splice(0..0, task.warnings.iter().cloned());
        if matched.rectified.is_some() && matched.judgement.calibration.is_none() && task.calibration.is_some() {
            matched
                .judgement
                .warnings
                .push("no depth: a pair rectified without calibration has no known baseline".into());
        }
        let picture = matched.rectified.as_ref().map_or(&left.0, |pair| &pair.pictures[0]).clone();
        Ok(Matched { backend: Rc::clone(&self.backend), task, picture, matched, total: start.elapsed() })
    }

    /// Cancels the match that is going on, at its next wait for the GPU.
    pub fn cancel(&self) {
        self.cancel.request();
    }
}

fn name(activity: Activity) -> &'static str {
    match activity {
        Activity::Rectifying => "rectifying",
        Activity::LookingForMirrorImage => "mirror",
        Activity::Step(step) => step.name(),
    }
}
