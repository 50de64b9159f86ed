//! The compiled pipelines that a [`Gpu`] keeps, so that a stage is compiled once for all sizes that it does not depend on.

use std::{
    cell::RefCell,
    fmt,
    sync::{Arc, Mutex, PoisonError},
};

use super::{Gpu, pipeline::Pipeline, stage::Stage};

/// Number of pipelines kept. A matcher has up to 15, a detector 8.
const KEPT: usize = 64;

/// The pipelines used last, the latest at the end. Others live as long as kernels that use them: an application that
/// changes its ranges for ever keeps no more than these.
#[derive(Default)]
pub(super) struct Pipelines(Mutex<Vec<Arc<Pipeline>>>);

impl fmt::Debug for Pipelines {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = |kept: &[Arc<Pipeline>]| kept.iter().map(|pipeline| pipeline.stage.name).collect::<Vec<_>>();
        self.with(|kept| f.debug_tuple("Pipelines").field(&names(kept)).finish())
    }
}

impl Pipelines {
    fn with<T>(&self, work: impl FnOnce(&mut Vec<Arc<Pipeline>>) -> T) -> T {
        work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The kept pipeline of `stage`, which becomes the latest.
    fn find(&self, stage: &Stage) -> Option<Arc<Pipeline>> {
        self.with(|kept| {
            let index = kept.iter().position(|pipeline| pipeline.stage == *stage)?;
            kept[index..].rotate_left(1);
            kept.last().cloned()
        })
    }

    /// Keeps pipelines that the device has accepted. Where another thread has compiled the same meanwhile, its stays.
    pub(super) fn keep(&self, accepted: Vec<Arc<Pipeline>>) {
        let superseded = self.with(|kept| {
            for pipeline in accepted {
                if kept.iter().all(|other| other.stage != pipeline.stage) {
                    kept.push(pipeline);
                }
            }
            kept.drain(..kept.len().saturating_sub(KEPT)).collect::<Vec<_>>()
        });
        // A driver may take its time to free pipelines: not while other threads wait.
        drop(superseded);
    }
}

thread_local! {
    /// The new pipelines of the [`collect`] that runs on this thread, if any.
    static NEW: RefCell<Option<Vec<Arc<Pipeline>>>> = const { RefCell::new(None) };
}

/// Runs `build`. Returns its result, and the pipelines that it has asked for and that nobody has compiled before.
///
/// As the error scopes of wgpu, the list belongs to the thread.
pub(super) fn collect<T>(build: impl FnOnce() -> T) -> (T, Vec<Arc<Pipeline>>) {
    let outer = NEW.replace(Some(Vec::new()));
    let built = build();
    (built, NEW.replace(outer).unwrap_or_default())
}

/// The pipeline of `stage` on `gpu`: a kept one, one of the same [`collect`], or a new one.
pub(super) fn pipeline_of(gpu: &Gpu, stage: &Stage) -> Arc<Pipeline> {
    let same = |pipeline: &&Arc<Pipeline>| pipeline.stage == *stage;
    let of_this_build = || NEW.with_borrow(|new| new.as_ref()?.iter().find(same).cloned());
    gpu.pipelines.find(stage).or_else(of_this_build).unwrap_or_else(|| {
        let pipeline = Arc::new(Pipeline::new(gpu, stage.clone()));
        NEW.with_borrow_mut(|new| new.iter_mut().for_each(|new| new.push(pipeline.clone())));
        pipeline
    })
}
