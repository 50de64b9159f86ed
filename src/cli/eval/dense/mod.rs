//! `hsad eval dense`: scores disparity maps against the ground truth of scenes.

mod record;
mod run;
mod supplied_maps;
mod table;

use std::{
    fmt::{self, Display, Formatter},
    path::PathBuf,
};

use clap::Args;
use hsad::{Error, dense::View};
use serde_json::{Value, json};

use self::{record::Record, run::Run, supplied_maps::SuppliedMaps};
use crate::cli::{
    eval::{change::Change, report_failures, saved_results, scenes, truth_scale::TruthOptions},
    options::{MatchOptions, RunOptions},
    output::{Output, check_tables, is_stdout, write_text},
    report, terminal,
    wording::in_options,
};

/// Name of this program among the methods.
const OURS: &str = "hsad";

/// Score disparity maps against the ground truth of scenes, by the measures of Middlebury and KITTI
///
/// A SCENE is a folder with left.png, right.png, disp_left.pfm and optionally nonocc.png (255: non-occluded); a folder
/// of Middlebury 2014 or ETH3D (im0.png, im1.png, disp0.pfm or disp0GT.pfm, mask0nocc.png), or of Middlebury 2001 to 2006
/// (im2, im6, disp2 or view1, view5, disp1); one of KITTI 2015 (image_2, image_3, disp_occ_0, disp_noc_0) or 2012
/// (colored_0 or image_0, disp_occ, disp_noc), or a single picture in it; one of SceneFlow (frames_cleanpass and
/// disparity, or a folder below frames_cleanpass); or a folder of such folders. Each pair is matched as by hsad
/// match, with the disparity range found for each pair unless --disparities is given, and scored over the non-occluded
/// pixels, over all pixels, and over the estimated pixels. A pixel without an estimate counts as wrong in the first
/// two.
#[derive(Args)]
#[command(
    after_help = "With -o, DIR/SCENE/ gets disparity.pfm, error.png, figure.png (picture, truth, map and errors) and
result.json; DIR/SCENE/NAME/ gets the same files for the map of another program. In error.png an error of at most
0.5 px is blue, 1 px light blue, 2 px yellow, 4 px orange and above that red; a missing estimate is white; occluded
pixels have a third of their brightness, and pixels without ground truth are black. Results whose files, options,
device and program are unchanged are not computed again.

Examples:
  hsad eval dense data
  hsad eval dense Art Teddy --preset quality -o out --csv out/errors.csv
  hsad eval dense Art --disparity sgbm=sgbm.pfm
  hsad eval dense Art Teddy --condition rotation=90
  hsad eval dense kitti/training --disparity theirs=maps/{scene}.png --given-only --json errors.json

Exit codes: 0 success, 1 a scene failed (the others are scored all the same), 2 usage"
)]
pub struct Dense {
    /// Folders of scenes with ground truth
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<PathBuf>,
    /// Also score FILE, a map of the same view by another program: PFM (in pixels, +inf for no disparity) or PNG
    /// (16 bit, 256 times the disparity, 0 for no disparity). {scene} in FILE stands for the scene's name; repeatable
    #[arg(long = "disparity", value_name = "NAME=FILE", value_parser = SuppliedMaps::parse)]
    supplied: Vec<SuppliedMaps>,
    /// Score only the maps of --disparity, without matching
    #[arg(long, requires = "supplied", conflicts_with_all = ["device", "self_test"])]
    given_only: bool,
    /// Change the right view before matching, for example rotation=30 or scale=0.7+noise=5 (see hsad eval paper --help). A pair whose
    /// right view is turned or scaled is rectified from its own matches first; its map is scored where the changed view shows the
    /// pixel, in disparities of the pair before the change
    #[arg(long, value_name = "NAME[=STRENGTH]", value_parser = Change::parse)]
    condition: Option<Change>,
    /// Seed of the random numbers in the condition
    #[arg(long, value_name = "N", default_value_t = 1, requires = "condition")]
    seed: u64,
    /// Output folder for maps, pictures and results, created if missing
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Ignore the results of an earlier run in the output folder
    #[arg(long, requires = "output")]
    fresh: bool,
    /// Write all figures to FILE (- for standard output, without the tables) as CSV, one line per scene, method and region; shares are
    /// 0 to 1
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write all figures, their means, the parameters and the failures to FILE as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    truth: TruthOptions,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    matching: MatchOptions,
}

/// A scene, or a method on a scene, that could not be scored.
struct Failure {
    /// Name of the scene, and of the method unless it is this program; `None` if no scene was found.
    what: Option<String>,
    error: Error,
}

impl Display for Failure {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        if let Some(what) = &self.what {
            write!(f, "{what}: ")?;
        }
        f.write_str(&in_options(&self.error))
    }
}

/// Records and failures of all scenes.
#[derive(Default)]
struct Results {
    records: Vec<Record>,
    /// Number of records reused from an earlier run.
    reused: usize,
    failures: Vec<Failure>,
}

impl Dense {
    /// Scores all scenes by all methods; a failure does not stop the others and is returned at the end.
    pub fn run(mut self) -> anyhow::Result<()> {
        // Nothing else goes to standard output then.
        self.run.quiet |= [&self.csv, &self.json].into_iter().flatten().any(|file| is_stdout(file));
        let config = self.matching.config()?;
        if let Some(option) = self.matching.any_but(&["reference"]).filter(|_| self.given_only) {
            return Err(Error::Parameter {
                name: "--given-only",
                value: "given".into(),
                expected: format!("then nothing is matched: leave --{option} out"),
            }
            .into());
        }
        if self.condition.is_some() && config.reference == View::Right {
            return Err(Error::Parameter {
                name: "--reference",
                value: "right".into(),
                expected: "it must be left, since --condition changes the right view".into(),
            }
            .into());
        }
        let (scenes, unread) = scenes::find(&self.scenes, self.truth)?;
        let failures = unread.into_iter().map(|error| Failure { what: None, error }).collect();
        supplied_maps::check(&self.supplied, scenes.len())?;
        let root = self.output.as_deref().map(Output::open).transpose()?;
        let supplied: Vec<PathBuf> =
            self.supplied.iter().flat_map(|maps| scenes.iter().map(|scene| maps.path(&scene.name))).collect();
        let of_scenes = scenes.iter().filter_map(|scene| scene.files(config.reference).ok()).flatten();
        let tables = [&self.csv, &self.json].into_iter().flatten().map(PathBuf::as_path);
        check_tables(tables, of_scenes.chain(supplied.iter().map(PathBuf::as_path)))?;
        let backend = if self.given_only { None } else { Some(self.run.open()?.backend) };

        let mut results = Results { failures, ..Default::default() };
        Run::new(&self, &config, backend.as_ref()).all(&scenes, &mut results);
        drop(root);

        let methods: Vec<&str> =
            backend.iter().map(|_| OURS).chain(self.supplied.iter().map(|maps| &*maps.name)).collect();
        if let Some(file) = &self.csv {
            write_text(file, &record::csv(&results.records))?;
        }
        if let Some(file) = &self.json {
            let mut report = results.report(&methods);
            report["condition"] = self.condition.as_ref().map(|change| &*change.name).into();
            report["device"] = backend.as_ref().map(report::device).into();
            report["parameters"] = backend.as_ref().map(|_| report::parameters(&config, None)).into();
            write_text(file, &format!("{report:#}\n"))?;
        }
        if !self.run.quiet {
            self.print_results(&results, &methods)?;
        }
        report_failures(&results.failures)
    }

    fn print_results(&self, results: &Results, methods: &[&str]) -> std::io::Result<()> {
        for record in &results.records {
            record.warnings.iter().for_each(|text| terminal::warning(format!("{}: {text}", record.scene)));
        }
        if results.records.is_empty() {
            return Ok(());
        }
        let mut text = format!("{}\n{}", table::tables(&results.records, methods), table::LEGEND);
        if let Some(folder) = &self.output {
            text += &format!("\nmaps and pictures of errors are in {}", hsad::shown(folder));
            text += &saved_results::reuse_note(results.reused, results.records.len());
            text.push('\n');
        }
        terminal::print(&text)
    }
}

impl Results {
    /// Records, means and failures as JSON.
    fn report(&self, methods: &[&str]) -> Value {
        let failed =
            self.failures.iter().map(|Failure { what, error }| json!({ "what": what, "error": in_options(error) }));
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "results": self.records.iter().map(saved_results::Saveable::to_json).collect::<Vec<_>>(),
            "means": record::means(&self.records, methods),
            "failed": failed.collect::<Vec<_>>(),
        })
    }
}
