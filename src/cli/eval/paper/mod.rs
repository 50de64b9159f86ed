//! `hsad eval paper`: the curves of the paper, and what they leave out.

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
    Error,
    eval::{conditions::Kind, scene::SceneFiles},
    pair::Backend,
};
use serde_json::json;

use self::{
    curve::Figure,
    results::{Cell, Group, groups},
    run::{SceneResults, Run},
};
use crate::cli::{
    eval::{
        change::{Change, kinds},
        report_failures, saved_results, scenes,
    },
    options::RunOptions,
    output::Output,
    report, terminal,
};

/// Where the scenes lie that come with the program's source.
const SHIPPED: &str = "data";

const DETAILS: &str = "\
Three methods are asked where the second view shows the same interest points of the first:
  sparse    matches of interest points, as hsad eval features has them
  kamencay  the method that the paper compares itself with, as hsad match --method kamencay
  balanced  as hsad match does it by default

The points are those that sparse finds in the first view, also those that it finds no match for. A dense method answers \
with the disparity of the pixel that a point lies in, and its confidence; where that is 0, so that the disparity was not \
measured or only filled in, there is no answer. An answer is right within the tolerance of the true place in the second \
view, and wrong where that does not show the point; where the truth is not known it does not count. Of answers with one \
confidence right and wrong ones take turns evenly, as in random order. Precision over coverage is also told of \
all pixels of the picture; a match of points is one pixel.

Dense methods look for a point in its own row. Under rotation and scale rows do not correspond, and nobody tells a method \
how the view was changed: there they are not applicable. Means are over the conditions under which all methods have a \
result, and over all of those that have more. Curves of means follow the number of answers; where a condition has no \
more of them, its last value stands.

Conditions change the second view, and the truth with it: NAME or NAME=STRENGTH, several in a row joined by '+', or none. \
Without --condition each of them at its usual strength, and none:";

const EXAMPLES: &str = "\
With -o, DIR/SCENE/ gets report.json and, as .csv and .svg, recall-precision (the paper's figure 7), f-measure (8), \
accuracy (9) and coverage; DIR/SCENE/CONDITION/METHOD/result.json is not computed again while pictures, options, \
device and program are the same.

Examples:
  hsad eval paper -o out
  hsad eval paper Art -o out
  hsad eval paper Art --condition none --condition noise=20 --condition gain=0.5+blur=1

Exit codes: 0 done, 1 something failed (the rest is told all the same), 2 usage";

fn details() -> String {
    format!("{DETAILS}\n{}\n\n{EXAMPLES}", kinds())
}

/// Repeat the paper's figures 7 to 9 for its method and the one that it compares itself with
///
/// A SCENE is what hsad eval dense takes for one: two rectified views and the true disparities.
#[derive(Args)]
#[command(after_help = details())]
pub struct Paper {
    /// Folders of scenes with known truth [default: data, the scenes that come with the source]
    #[arg(value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// Change the second view first, such as noise=20
    #[arg(long = "condition", value_name = "NAME[=STRENGTH]")]
    conditions: Vec<String>,
    /// What is random in a condition is another for another seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How far from the true place a right answer can be
    #[arg(long, value_name = "PX", default_value_t = 1.5, allow_negative_numbers = true)]
    tolerance: f64,
    /// Folder for curves, plots and results, created if need be
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Compute again what an earlier run left in the folder
    #[arg(long, requires = "output")]
    fresh: bool,
    #[command(flatten)]
    run: RunOptions,
}

impl Paper {
    /// Measures everything that can be measured, and fails at the end if anything could not.
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
        let backend = self.run.open()?;
        let run = Run::new(&self, &changes, &backend);
        let mut printed = false;
        for files in &scenes {
            match run.scene(files) {
                Ok(found) => {
                    let groups = groups(&found.cells);
                    if let Err(error) = self.write(&files.name, &groups, &found, &backend) {
                        failures.push(error.to_string());
                    }
                    if !self.run.quiet && !groups.is_empty() {
                        run.progress.suspend(|| self.print_results(&files.name, &groups, &found))?;
                        printed = true;
                    }
                    failures.extend(found.failures);
                }
                Err(error) => failures.push(format!("{}: {error}", files.name)),
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
            return scenes::find(&self.scenes);
        }
        if !Path::new(SHIPPED).is_dir() {
            return Err(refused("SCENE", "none", "there is no folder data here: name a scene"));
        }
        scenes::find(&[SHIPPED.into()])
    }

    /// The scene's curves, plots and report, where a folder was named.
    fn write(&self, scene: &str, groups: &[Group], found: &SceneResults, backend: &Backend) -> hsad::Result<()> {
        let Some(root) = &self.output else { return Ok(()) };
        let mut output = Output::open(&root.join(scene))?;
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
        output.add_json(
            "report.json",
            &json!({
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
            text += &format!("\ncurves and plots are in {}", folder.join(scene).display());
            let done = found.cells.iter().filter(|cell| matches!(cell, Cell::Measured(_))).count();
            text += &saved_results::reuse_note(found.reused, done);
            text.push('\n');
        }
        terminal::print(&(text + "\n"))
    }
}

/// The conditions where none is named: none, and each at its usual strength.
fn usual() -> Vec<String> {
    std::iter::once("none").chain(Kind::ALL.map(Kind::name)).map(String::from).collect()
}

fn refused(name: &'static str, value: impl Display, expected: &str) -> Error {
    Error::Parameter { name, value: value.to_string(), expected: expected.into() }
}
