//! `hsad eval paper`: the curves of the paper's figures 7 to 9, and coverage.

mod curve;
mod method;
mod plot;
mod record;
mod results;
mod run;
mod table;

use std::{
    fmt::Display,
    io::{self, Write},
    path::{Path, PathBuf},
};

use clap::Args;
use hsad::{
    Backend, Error,
    eval::{conditions::Kind, scene::SceneFiles},
};
use serde_json::json;

use self::{
    curve::Figure,
    results::{Group, groups},
    run::{Run, SceneResults},
};
use crate::cli::{
    eval::{
        change::{Change, kinds},
        report_failures, saved_results, scenes,
        truth_scale::TruthOptions,
    },
    options::RunOptions,
    output::Output,
    products, report, terminal,
    wording::in_options,
};

/// Folder of the scenes that come with the source.
const SHIPPED: &str = "data";

const DETAILS: &str = "\
Three methods match the same interest points of the first view to the second view:
  sparse    matches of interest points, as in hsad eval features
  kamencay  the method that the paper compares itself with, as in hsad match --method kamencay
  balanced  dense matching, as in hsad match by default

The points are those that sparse detects in the first view, matched or not. A dense method answers with the disparity and \
the confidence of the pixel that a point lies in; with a confidence of at most 15, where the disparity was not measured or only \
filled in, there is no answer. An answer is right within --tolerance of the true position in the second view, and wrong if \
the point is occluded there; answers without ground truth do not count. Right and wrong answers of equal confidence are \
interleaved evenly, as in random order. Precision over coverage is also given for all pixels of the picture; a match of \
an interest point counts as one pixel.

Dense methods search along rows. Under rotation and scale rows do not correspond, and no method is told how the view was \
changed: the pair is rectified from its own matches first, as hsad match does, and the map is taken back to the first view. \
Without enough matches for that, a dense method has no answers. Means are over the conditions under which all methods have a \
result; a method with more results also has a mean over all of its conditions. Curves of means are over the number of \
answers; a condition with fewer answers keeps its last value.

Conditions change the second view and its ground truth: NAME or NAME=STRENGTH, several applied in order joined by '+', \
or none. Without --condition: none, and each condition at its default strength:";

const EXAMPLES: &str = "\
With -o, DIR/SCENE/ gets report.json and, as .csv and .svg, recall-precision (the paper's figure 7), f-measure (8), \
accuracy (9) and coverage; DIR/SCENE/CONDITION/METHOD/result.json is reused while pictures, options, device and \
program are unchanged.

Examples:
  hsad eval paper -o out
  hsad eval paper Art -o out
  hsad eval paper Art --condition none --condition noise=20 --condition gain=0.5+blur=1

Exit codes: 0 success, 1 a scene or a method failed (the others are evaluated all the same), 2 usage";

fn details() -> String {
    format!("{DETAILS}\n{}\n\n{EXAMPLES}", kinds())
}

/// Reproduce the paper's figures 7 to 9 for its method and the one that it compares itself with
///
/// A SCENE is a folder as for hsad eval dense: two rectified views and the true disparities.
#[derive(Args)]
#[command(after_help = details())]
pub struct Paper {
    /// Folders of scenes with ground truth [default: data, the scenes that come with the source]
    #[arg(value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// Change the second view before matching, for example noise=20; repeatable [default: none, and each condition
    /// at its default strength]
    #[arg(long = "condition", value_name = "NAME[=STRENGTH]")]
    conditions: Vec<String>,
    /// Seed of the random numbers in conditions
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Largest distance of a right answer from the true position, in pixels, at least 0
    #[arg(long, value_name = "PX", default_value_t = 1.5, allow_negative_numbers = true)]
    tolerance: f64,
    /// Output folder for curves, plots and results, created if missing
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Ignore the results of an earlier run in the output folder
    #[arg(long, requires = "output")]
    fresh: bool,
    #[command(flatten)]
    truth: TruthOptions,
    #[command(flatten)]
    run: RunOptions,
}

impl Paper {
    /// Evaluates all scenes; a failure does not stop the others and is returned at the end.
    pub fn run(self) -> anyhow::Result<()> {
        if !(self.tolerance >= 0.0 && self.tolerance.is_finite()) {
            return Err(refused("tolerance", self.tolerance, "it must be a number of pixels from 0 up").into());
        }
        let changes = match &self.conditions[..] {
            [] => Change::parse_all(&usual())?,
            named => Change::parse_all(named)?,
        };
        let (scenes, unread) = self.find()?;
        let mut failures: Vec<String> = unread.iter().map(Error::to_string).collect();
        let root = self.output.as_deref().map(Output::open).transpose()?;
        let backend = self.run.open()?.backend;
        let run = Run::new(&self, &changes, &backend);
        let mut printed = false;
        for files in &scenes {
            match run.scene(files) {
                Ok(found) => {
                    let groups = groups(&found.records);
                    if let Err(error) = self.write(&files.name, &groups, &found, &backend) {
                        failures.push(in_options(&error));
                    }
                    if !self.run.quiet && !groups.is_empty() {
                        run.progress.suspend(|| self.print_results(&files.name, &groups, &found))?;
                        printed = true;
                    }
                    failures.extend(found.failures);
                }
                Err(error) => failures.push(format!("{}: {}", files.name, in_options(&error))),
            }
        }
        drop((run, root));
        if printed {
            terminal::print(table::LEGEND)?;
        }
        report_failures(&failures)
    }

    fn find(&self) -> hsad::Result<(Vec<SceneFiles>, Vec<Error>)> {
        if !self.scenes.is_empty() {
            return scenes::find(&self.scenes, self.truth);
        }
        if !Path::new(SHIPPED).is_dir() {
            return Err(refused("SCENE", "none", "there is no folder 'data' here: name a scene"));
        }
        scenes::find(&[SHIPPED.into()], self.truth)
    }

    /// Writes the scene's curves, plots and report, if there is an output folder.
    fn write(&self, scene: &str, groups: &[Group], found: &SceneResults, backend: &Backend) -> hsad::Result<()> {
        let Some(root) = &self.output else { return Ok(()) };
        let mut output = Output::open_set(&root.join(scene))?;
        for figure in Figure::ALL {
            let [csv_file, svg_file] = figure.files();
            let curves: Vec<_> = groups.iter().map(|group| (group, group.curve(figure))).collect();
            let lines = curves.iter().map(|(group, curve)| (&*group.name, group.method.name(), &curve[..]));
            let csv = curve::csv(figure, lines);
            output.add(csv_file, |out| out.write_all(csv.as_bytes()))?;
            output.add(svg_file, |out| {
                let svg = plot::svg(figure, scene, groups).map_err(io::Error::other)?;
                out.write_all(svg.as_bytes())
            })?;
        }
        products::add_report(
            &mut output,
            json!({
                "version": env!("CARGO_PKG_VERSION"),
                "device": report::device(backend),
                "scene": scene,
                "tolerance_px": self.tolerance,
                "seed": self.seed,
                "results": table::json(groups),
                "failed": found.failures,
            }),
        )?;
        output.finish()
    }

    fn print_results(&self, scene: &str, groups: &[Group], found: &SceneResults) -> io::Result<()> {
        let mut text = table::text(scene, groups);
        if let Some(folder) = &self.output {
            text += &format!("\ncurves and plots are in {}", hsad::shown(&folder.join(scene)));
            text += &saved_results::reuse_note(found.reused, found.records.len());
            text.push('\n');
        }
        terminal::print(&(text + "\n"))
    }
}

/// The default conditions: none, and each kind at its default strength.
fn usual() -> Vec<String> {
    std::iter::once("none").chain(Kind::ALL.map(Kind::name)).map(String::from).collect()
}

fn refused(name: &'static str, value: impl Display, expected: &str) -> Error {
    Error::Parameter { name, value: value.to_string(), expected: expected.into() }
}
