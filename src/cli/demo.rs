//! `hsad demo`: matches a scene built into the program and scores the map against its ground truth.

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use anyhow::Context;
use clap::Args;
use hsad::{
    Result,
    config::Preset,
    disparity::DisparityMap,
    eval::{self, Score},
    image::{Luma, Plane},
    io::{Calibration, Picture, figure, load, pfm, png},
    pipeline::Way,
};
use serde_json::Value;

use super::{
    cloud::CloudOptions,
    job::Job,
    names,
    options::RunOptions,
    output::Output,
    products, summary,
    terminal::{self, Progress},
};

const LEFT: &[u8] = include_bytes!("../../data/curved/left.png");
const RIGHT: &[u8] = include_bytes!("../../data/curved/right.png");
const TRUTH: &[u8] = include_bytes!("../../data/curved/disp_left.pfm");
const NON_OCCLUDED: &[u8] = include_bytes!("../../data/curved/nonocc.png");
const META: &str = include_str!("../../data/curved/meta.json");

/// Error thresholds of the wrong-pixel shares, in pixels.
const THRESHOLDS: [f32; 2] = [1.0, 2.0];

/// Match a pair built into this program and score the result against its ground truth
///
/// Writes the files of hsad match with depth and figures, the two pictures, and demo.png: the left
/// picture, the disparities found and the true disparities side by side.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad demo
  hsad demo -o /tmp/demo --device cpu")]
pub struct Demo {
    /// Output folder, created if missing
    #[arg(short, long, value_name = "DIR", default_value = "hsad-demo")]
    output: PathBuf,
    #[command(flatten)]
    run: RunOptions,
}

/// Luma of the two views of the built-in scene, and its largest disparity in pixels.
pub(super) fn views() -> anyhow::Result<([Luma; 2], f32)> {
    let scene = Scene::new()?;
    let known = scene.truth.data().iter().copied().filter(|disparity| disparity.is_finite());
    let largest = known.fold(0.0, f32::max);
    Ok(([scene.left.luma(), scene.right.luma()], largest))
}

impl Demo {
    /// Matches the built-in scene as `hsad match` does, writes all files and prints the scores.
    pub fn run(self) -> anyhow::Result<()> {
        let mut output = Output::open_set(&self.output)?;
        let files = names::DEMO.into_iter().chain(products::maps(true)).chain(names::FIGURES);
        files.into_iter().try_for_each(|name| output.check(name))?;
        let scene = Scene::new()?;
        let [_, left, right] = names::DEMO.map(String::from);
        let job = Job {
            names: [left, right],
            left: scene.left.clone(),
            right: scene.right.clone(),
            stretch: None,
            config: Preset::Balanced.config(),
            way: Way::AsIs,
            map_back: false,
            strongest: None,
            calibration: Some(scene.calibration),
        };
        let mut completed = job.run(&self.run)?;
        let accuracy = Accuracy::new(&completed.outcome.dense.disparity, &scene)?;

        let progress = Progress::new(self.run.quiet);
        progress.begin("writing");
        let panels = products::beside_truth(&scene.left, &completed.outcome.dense.disparity, &scene.truth);
        let panels = figure::side_by_side(&panels.each_ref());
        let [demo_file, left_file, right_file] = names::DEMO;
        output.add(demo_file, |out| png::write_rgb8(out, &panels))?;
        output.add(left_file, |out| out.write_all(LEFT))?;
        output.add(right_file, |out| out.write_all(RIGHT))?;
        completed.add_maps(&mut output, &CloudOptions::default())?;
        completed.add_figures(&mut output)?;
        let mut report = completed.report();
        report["accuracy"] = accuracy.report();
        products::add_report(&mut output, report)?;
        output.finish_run(0)?;
        drop(progress);

        if !self.run.quiet {
            completed.warnings.iter().for_each(terminal::warning);
            terminal::print(&(completed.summary() + &summary::files(&output) + &accuracy.summary()))?;
            let look = output.folder().join(demo_file);
            terminal::print(&format!(
                "\nLook at {}: left picture, disparities found, true disparities.\n",
                hsad::shown(&look)
            ))?;
        }
        Ok(())
    }
}

/// The scene built into the program.
struct Scene {
    left: Picture,
    right: Picture,
    truth: Plane<f32>,
    /// Mask of the left view: 255 where both cameras see the same point.
    non_occluded: Plane<u8>,
    calibration: Calibration,
}

impl Scene {
    fn new() -> anyhow::Result<Self> {
        let shipped = |name| Path::new("the shipped scene").join(name);
        let meta: Value = serde_json::from_str(META)?;
        let calib = meta["calib_txt"].as_str().context("the shipped meta.json has no calib_txt")?;
        Ok(Self {
            left: load::decode(LEFT, &shipped("left.png"))?,
            right: load::decode(RIGHT, &shipped("right.png"))?,
            truth: pfm::decode(TRUTH, &shipped("disp_left.pfm"))?,
            non_occluded: load::decode(NON_OCCLUDED, &shipped("nonocc.png"))?.luma(),
            calibration: Calibration::parse(calib, &shipped("calib.txt"))?,
        })
    }
}

/// Scores of the map over non-occluded pixels and over all pixels.
struct Accuracy {
    non_occluded: Score,
    all: Score,
}

impl Accuracy {
    fn new(map: &DisparityMap, scene: &Scene) -> Result<Self> {
        Ok(Self {
            non_occluded: eval::score(map, &scene.truth, Some(&scene.non_occluded), &THRESHOLDS)?,
            all: eval::score(map, &scene.truth, None, &THRESHOLDS)?,
        })
    }

    fn rows(&self) -> [(&'static str, &Score); 2] {
        [("non-occluded", &self.non_occluded), ("all", &self.all)]
    }

    fn summary(&self) -> String {
        let mut text = String::from(
            "\nWrong pixels in per cent, by more than\n                1 px    2 px   of those estimated:  1 px    2 px   estimated\n",
        );
        for (name, score) in self.rows() {
            let percent = |share: f64| format!("{:.1}", 100.0 * share);
            let [one, two] = [0, 1].map(|i| percent(score.bad[i].of_known));
            let [one_estimated, two_estimated] = [0, 1].map(|i| percent(score.bad[i].of_estimated));
            text += &format!(
                "  {name:<13}{one:>5}{two:>8}{one_estimated:>27}{two_estimated:>8}{:>12}\n",
                percent(score.coverage())
            );
        }
        text
    }

    fn report(&self) -> Value {
        self.rows().into_iter().map(|(name, figures)| (name.replace('-', "_"), hsad::report::score(figures))).collect()
    }
}

#[cfg(test)]
mod tests {
    use hsad::disparity::fixed_point;

    use super::*;

    #[test]
    fn the_scene_is_whole_and_its_truth_scores_perfectly() {
        let scene = Scene::new().unwrap();
        let size = scene.left.size();
        assert!(scene.right.size() == size && scene.truth.size() == size && scene.calibration.size == Some(size));
        let truth = scene.truth.map(|&pixels| fixed_point(pixels));
        let accuracy = Accuracy::new(&truth, &scene).unwrap();
        for (_, score) in accuracy.rows() {
            assert!(score.bad.iter().all(|bad| bad.of_known == 0.0) && score.coverage() == 1.0);
        }
        let share = accuracy.non_occluded.known as f64 / accuracy.all.known as f64;
        assert!((share - 0.8363).abs() < 1e-4, "nonocc_fraction of meta.json");
    }
}
