//! Runs all methods on one scene after the other.

use std::time::Instant;

use glam::DAffine2;
use hsad::{
    Backend, Result,
    config::Config,
    disparity::{fixed_point, in_pixels},
    eval::{
        conditions::Changed,
        scene::{Scene, SceneFiles},
    },
    image::Plane,
    io::{color, disparities, figure, pfm, png},
    pipeline,
    report::ResultFile,
};
use serde_json::Value;

use super::{Dense, Failure, OURS, Results, record::Record, supplied_maps::SuppliedMaps};
use crate::cli::{
    doubts,
    eval::{
        change::Change,
        moved::Moved,
        saved_results::SavedResults,
        truth_scale::{self, TruthOptions},
    },
    names::ERRORS,
    output::Output,
    products, report,
    terminal::Progress,
};

/// The methods, and where their results are saved.
pub struct Run<'a> {
    config: &'a Config,
    /// The change of the right views, and the seed of its random numbers.
    change: Option<(&'a Change, u64)>,
    truth: TruthOptions,
    methods: Vec<Method<'a>>,
    /// Where the results of all scenes are saved.
    saved: SavedResults,
    progress: Progress,
}

/// A scene, changed if a condition says so.
struct Prepared {
    scene: Scene,
    /// The map from pixels of the right view to those of the changed one, if it moves points.
    moved: Option<DAffine2>,
}

/// Source of a disparity map.
#[derive(Clone, Copy)]
enum Method<'a> {
    Ours(&'a Backend),
    Supplied(&'a SuppliedMaps),
}

impl<'a> Run<'a> {
    /// The methods of `options`; without a backend only the supplied maps.
    pub fn new(options: &'a Dense, config: &'a Config, backend: Option<&'a Backend>) -> Self {
        let supplied = options.supplied.iter().map(Method::Supplied);
        Self {
            config,
            change: options.condition.as_ref().map(|change| (change, options.seed)),
            truth: options.truth,
            methods: backend.map(Method::Ours).into_iter().chain(supplied).collect(),
            saved: SavedResults::new(options.output.as_deref(), options.fresh)
                .depending_on(&format!("{:?}", options.truth)),
            progress: Progress::new(options.run.quiet),
        }
    }

    /// Scores all methods on all `scenes` and adds the records to `results`.
    pub fn all(&self, scenes: &[SceneFiles], results: &mut Results) {
        for (number, files) in (1..).zip(scenes) {
            self.progress.piece(&files.name, number, scenes.len());
            if let Err(error) = self.scene(files, results) {
                results.failures.push(Failure { what: Some(files.name.clone()), error });
            }
        }
    }

    /// Scores all methods on one scene. A method that fails is noted and does not stop the others.
    ///
    /// # Errors
    /// If the scene cannot be read.
    fn scene(&self, files: &SceneFiles, results: &mut Results) -> Result<()> {
        let paths = files.files(self.config.reference)?;
        let of_scene =
            paths.into_iter().try_fold(self.saved.clone().below(&files.name), SavedResults::depending_on_file)?;
        let supplied = self.methods.iter().filter_map(|method| match method {
            Method::Supplied(maps) => Some(maps.path(&files.name)),
            Method::Ours(_) => None,
        });
        let of_scene = of_scene.sparing(supplied);
        let of_scene = match self.change {
            Some((change, seed)) => of_scene.depending_on(&format!("{} {seed}", change.name)),
            None => of_scene,
        };
        // The scene is read when a method first needs it, which with saved results may be never.
        let mut scene = None;
        for &method in &self.methods {
            let made = match self.saved_results(of_scene.clone(), &files.name, method) {
                Ok(saved) => match saved.load() {
                    Some(record) => {
                        results.reused += 1;
                        Ok(record)
                    }
                    None => {
                        let scene = match &mut scene {
                            Some(scene) => scene,
                            unread => unread.insert(self.read(files)?),
                        };
                        self.make(&files.name, scene, method, &saved, &mut results.failures)
                    }
                },
                Err(error) => Err(error),
            };
            match made {
                Ok(record) => results.records.push(record),
                Err(error) => {
                    results.failures.push(Failure { what: Some(name_of(&files.name, method)), error });
                }
            }
        }
        Ok(())
    }

    /// Where a method's result for the scene called `name` is saved, from the scene's own dependencies.
    fn saved_results(&self, of_scene: SavedResults, name: &str, method: Method) -> Result<SavedResults> {
        match method {
            Method::Ours(backend) => Ok(of_scene
                .depending_on(&format!("{:?}", self.config))
                .depending_on(&report::device(backend).to_string())),
            Method::Supplied(maps) => of_scene.below(&maps.name).depending_on_file(&maps.path(name)),
        }
    }

    fn read(&self, files: &SceneFiles) -> Result<Prepared> {
        self.progress.begin("reading");
        let scene = files.read(self.config.reference)?;
        let Some((change, seed)) = self.change else { return Ok(Prepared { scene, moved: None }) };
        let changed = Changed::by(&change.conditions, &scene.right, seed);
        let scene = scene.changed(&changed);
        Ok(Prepared { scene, moved: change.moves().then_some(changed.map) })
    }

    /// Scores one method on one scene and saves the result. A failure to save is noted beside the result.
    fn make(
        &self,
        name: &str,
        prepared: &Prepared,
        method: Method,
        saved: &SavedResults,
        failures: &mut Vec<Failure>,
    ) -> Result<Record> {
        let (map, record) = match method {
            Method::Ours(backend) => self.ours(backend, name, prepared)?,
            Method::Supplied(maps) => self.supplied(maps, name, &prepared.scene)?,
        };
        let written = saved.save(&record, |output| {
            self.progress.begin("writing");
            add_files(output, &prepared.scene, &map)
        });
        failures.extend(written.err().map(|error| Failure { what: Some(name_of(name, method)), error }));
        Ok(record)
    }

    fn ours(&self, backend: &Backend, name: &str, prepared: &Prepared) -> Result<(Plane<f32>, Record)> {
        let Prepared { scene, moved } = prepared;
        let views = (&scene.left, &scene.right);
        let begin = |step| self.progress.step(step);
        let start = Instant::now();
        let (map, outcome, warnings) = match *moved {
            None => {
                let outcome = pipeline::run(backend, views, self.config, begin)?;
                let warnings = doubts::warnings(views, self.config, &outcome, None);
                (in_pixels(&outcome.dense.disparity), outcome, warnings)
            }
            Some(change) => {
                let moved = Moved::new(backend, views, self.config, begin)?;
                let [left, right] = &moved.pair.pictures;
                let warnings = doubts::warnings((left, right), self.config, &moved.outcome, Some(&moved.pair));
                (moved.before(change), moved.outcome, warnings)
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        self.truth.check(&scene.truth, &map)?;
        let record = Record {
            scene: name.into(),
            method: OURS.into(),
            scores: scene.score(&map)?,
            range: report::searched(&outcome),
            seconds: Some(seconds),
            warnings,
        };
        Ok((map, record))
    }

    fn supplied(&self, maps: &SuppliedMaps, name: &str, scene: &Scene) -> Result<(Plane<f32>, Record)> {
        let map = disparities::read(&maps.path(name))?;
        let record = Record {
            scene: name.into(),
            method: maps.name.clone(),
            scores: scene.score(&map)?,
            range: Value::Null,
            seconds: None,
            warnings: truth_scale::warning(&scene.truth, &map).into_iter().collect(),
        };
        Ok((map, record))
    }
}

/// Name of the scene, and of the method unless it is this program, for failures.
fn name_of(name: &str, method: Method) -> String {
    match method {
        Method::Ours(_) => name.into(),
        Method::Supplied(maps) => format!("{name}, {}", maps.name),
    }
}

/// Adds the map, its errors, and a figure: picture, ground truth, map and errors.
fn add_files(output: &mut Output, scene: &Scene, map: &Plane<f32>) -> Result<()> {
    let errors = color::error_colors(map, &scene.truth, scene.non_occluded.as_ref());
    let in_fixed_point = map.map(|&pixels| fixed_point(pixels));
    let [view, found, truth] = products::beside_truth(scene.reference_view(), &in_fixed_point, &scene.truth);
    let figure = figure::side_by_side(&[&view, &truth, &found, &errors]);
    let [error_file, figure_file] = ERRORS;
    output.add(ResultFile::Disparities.name(), |out| pfm::write(out, map))?;
    output.add(error_file, |out| png::write_rgb8(out, &errors))?;
    output.add(figure_file, |out| png::write_rgb8(out, &figure))
}
