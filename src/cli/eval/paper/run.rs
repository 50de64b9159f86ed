//! Runs all methods under one condition after the other.

use std::time::Instant;

use glam::DVec2;
use hsad::{
    Backend, Result,
    dense::View,
    eval::{
        Truth,
        conditions::Changed,
        scene::{Scene, SceneFiles},
    },
    io::Picture,
};

use super::{Paper, method::Method, record::Record};
use crate::cli::{
    eval::{change::Change, saved_results::SavedResults},
    report,
    terminal::Progress,
    wording::in_options,
};

/// The device, the conditions, and where results are saved.
pub struct Run<'a> {
    options: &'a Paper,
    changes: &'a [Change],
    backend: &'a Backend,
    /// Where the results of all scenes are saved.
    saved: SavedResults,
    pub progress: Progress,
}

/// The results of a scene so far.
#[derive(Default)]
pub struct SceneResults {
    pub records: Vec<Record>,
    /// How many of them an earlier run made.
    pub reused: usize,
    pub failures: Vec<String>,
}

/// A scene, and its second view after a change; each is made when it is first needed, which with saved results may be
/// never.
struct Views<'s> {
    files: &'s SceneFiles,
    scene: Option<(Scene, Truth)>,
    changed: Option<(Picture, Truth)>,
}

impl Views<'_> {
    /// The scene, its changed second view, and the ground truth for that view.
    fn get(&mut self, change: &Change, seed: u64) -> Result<(&Scene, &Picture, &Truth)> {
        let (scene, truth) = match &mut self.scene {
            Some(read) => read,
            unread => {
                let scene = self.files.read(View::Left)?;
                let truth = Truth::stereo(scene.truth.clone(), scene.non_occluded.as_ref())?;
                unread.insert((scene, truth))
            }
        };
        let (second, truth) = self.changed.get_or_insert_with(|| {
            let changed = Changed::by(&change.conditions, &scene.right, seed);
            let truth = truth.clone().changed(&changed);
            (changed.picture, truth)
        });
        Ok((scene, second, truth))
    }
}

impl<'a> Run<'a> {
    pub fn new(options: &'a Paper, changes: &'a [Change], backend: &'a Backend) -> Self {
        let saved = SavedResults::new(options.output.as_deref(), options.fresh)
            .depending_on(&report::device(backend).to_string())
            .depending_on(&format!("{} {} {:?}", options.tolerance, options.seed, options.truth))
            .depending_on(&Method::Sparse.described());
        Self { options, changes, backend, saved, progress: Progress::new(options.run.quiet) }
    }

    /// Runs all methods on a scene under all conditions. A failure does not stop the other conditions.
    ///
    /// # Errors
    /// If a file that the results depend on cannot be read.
    pub fn scene(&self, files: &SceneFiles) -> Result<SceneResults> {
        let paths = files.files(View::Left)?;
        let of_scene =
            paths.into_iter().try_fold(self.saved.clone().below(&files.name), SavedResults::depending_on_file)?;
        let mut found = SceneResults::default();
        let mut views = Views { files, scene: None, changed: None };
        for (number, change) in (1..).zip(self.changes) {
            let name = format!("{}, {}", files.name, change.name);
            self.progress.piece(&name, number, self.changes.len());
            views.changed = None;
            let mut points = Vec::new();
            for method in Method::ALL {
                self.progress.begin(method.name());
                let saved = of_scene.clone().below(&change.name).below(method.name());
                let saved = saved.depending_on(&change.name).depending_on(&method.described());
                match self.record(&mut views, change, method, &points, &saved, &mut found) {
                    Ok(record) => {
                        if !method.is_dense() {
                            points.clone_from(&record.points);
                        }
                        found.records.push(record);
                    }
                    Err(error) => {
                        found.failures.push(format!("{name}, {}: {}", method.name(), in_options(&error)));
                        if !method.is_dense() {
                            // Without its points the other methods have nothing to match.
                            break;
                        }
                    }
                }
            }
        }
        Ok(found)
    }

    fn record(
        &self,
        views: &mut Views,
        change: &Change,
        method: Method,
        points: &[DVec2],
        saved: &SavedResults,
        found: &mut SceneResults,
    ) -> Result<Record> {
        if let Some(record) = saved.load() {
            found.reused += 1;
            return Ok(record);
        }
        let (scene, second, truth) = views.get(change, self.options.seed)?;
        let start = Instant::now();
        let answers = method.run(self.backend, (&scene.left, second), points, change.moves())?;
        let seconds = start.elapsed().as_secs_f64();
        let judged = (truth, &scene.truth);
        let record = Record::new((&change.name, method), answers, judged, self.options.tolerance, seconds)?;
        // A result that cannot be saved is shown all the same.
        let described = |error| format!("{}, {}, {}: {error}", views.files.name, change.name, method.name());
        found.failures.extend(saved.save(&record, |_| Ok(())).err().map(described));
        Ok(record)
    }
}
