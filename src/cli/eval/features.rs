//! `hsad eval features`: scores matches of interest points against the ground truth.

mod supplied_matches;
mod table;
mod views;

use std::path::{Path, PathBuf};

use clap::Args;
use hsad::{
    Backend, Error, Result,
    eval::{Form, Judged, OtherForm, Point, PointMatch, PointScores, conditions::Changed, curves::accuracy_of_first},
    gpu::block_on,
    io::{atomic::write_whole, png},
    wide_baseline::{WideBaselineConfig, match_views},
};
use serde_json::json;

use crate::cli::{
    eval::{
        change::{Change, kinds},
        report_failures,
        saved_results::{self, SavedResults},
        scenes,
        truth_scale::TruthOptions,
    },
    options::{FeatureOptions, RunOptions, with_default},
    output::{Output, check_tables, is_stdout, write_text},
    report,
    terminal::{self, Progress},
    wording::in_options,
};
use table::{Column, Row, Table, Unit};
use views::{Pair, Views};

const DETAILS: &str = "\
A FOLDER is a scene or a folder of scenes as for hsad eval dense, or a homography set (img1, and img2 with H1to2p, img3 \
with H1to3p, ...: the nine numbers of the homography from the first view to the other, row by row; or 1, 2 and H_1_2, as in \
HPatches; pictures are .png, .ppm, .pgm or .jpg), or a folder of homography sets.

Figures of each pair and their means, shares in per cent:
  points   interest points in the area that both views show, of the view with fewer
  matches  matches with known ground truth; only these count
  right    precision: share of the matches within --tolerance of the true position
  recall   right matches divided by the matches that could have been found
  F        F-measure, the harmonic mean of precision and recall
  of N     precision of the N most confident matches, or of all if there are fewer
  cover    share of the points of the first view that have a match, right or wrong
  repeat   repeatability: corresponding points divided by points
  score    matching score: matches of corresponding points divided by points

Positions are compared in pixels of the second view; a match of an occluded point is wrong. Two points correspond if the \
overlap error of their regions is at most 40 %, after both regions are enlarged by one factor until that of the first \
view has a radius of 30 px; each point corresponds to one other at most (Mikolajczyk et al., IJCV 65, 2005). The matches \
that could have been found are these correspondences and the right matches of other points.

Conditions change the second view and its ground truth: NAME or NAME=STRENGTH, several applied in order joined by '+', \
or none:";

const EXAMPLES: &str = "\
Matches of another program (--matches): CSV with a header, columns x1, y1, x2, y2 in pixels of the first and the second \
view, and optionally confidence, larger for more confident matches; without it the lines must be in order of confidence, \
the most confident first. Its points (--points): columns x, y and scale, as `hsad features` writes them; without them \
only the precision is known. --write-views writes the changed views for the other program.

With -o, DIR/PAIR/CONDITION/result.json is reused while pictures, options, device and program are unchanged.

Examples:
  hsad eval features data -o out
  hsad eval features data/planes --condition rotation=30 --condition blur=1+noise=5
  hsad eval features boat --view 3 --json boat.json
  hsad eval features data/planes --matches theirs.csv --points l.csv r.csv";

fn details() -> String {
    format!("{DETAILS}\n{}\n\n{EXAMPLES}", kinds())
}

/// Help of `--threshold`, whose default differs from that of the other subcommands.
fn threshold_help() -> String {
    let default = WideBaselineConfig::default().features.threshold;
    with_default(
        "Smallest determinant of the Hessian of a point, for grey values of 0 to 1; above 0, at most 1",
        default,
    )
}

/// Options without effect where nothing is matched.
const OF_MATCHING: [&str; 10] =
    ["device", "self_test", "plain", "ratio", "octaves", "step", "threshold", "oriented", "upright", "max_features"];

/// Score matches of interest points against the ground truth
#[derive(Args)]
#[command(after_help = details(), mut_arg("threshold", |option| option.help(threshold_help())))]
pub struct Features {
    /// Folders of stereo scenes or homography sets
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Change the second view before matching, for example rotation=30; repeatable, one table per condition
    #[arg(long = "condition", value_name = "NAME[=STRENGTH]", default_value = "none")]
    conditions: Vec<String>,
    /// Seed of the random numbers in conditions
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Largest distance of a right match from the true position, in pixels, at least 0
    #[arg(long, value_name = "PX", default_value_t = 1.5, allow_negative_numbers = true)]
    tolerance: f64,
    /// Report the precision of the N most confident matches, each N at least 1
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "10,50,100,500")]
    first: Vec<usize>,
    /// Use only this view of a homography set, 2 to 99 [default: all]
    #[arg(long, value_name = "K")]
    view: Option<u32>,
    /// Score the matches of another program instead, of a single pair and condition
    #[arg(long, value_name = "FILE", conflicts_with_all = OF_MATCHING)]
    matches: Option<PathBuf>,
    /// Interest points of the other program in the first and in the second view
    #[arg(long, num_args = 2, value_names = ["FIRST", "SECOND"], requires = "matches")]
    points: Option<Vec<PathBuf>>,
    /// Only write the changed second views to this folder, for other programs
    #[arg(long, value_name = "DIR", conflicts_with_all = OF_MATCHING, conflicts_with_all = ["matches", "csv", "json", "tolerance", "first"])]
    write_views: Option<PathBuf>,
    /// Write the figures to this file (- for standard output, without the tables) as CSV, one line per pair and condition; shares are 0 to 1
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write the figures, their means and the parameters to this file as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Output folder for the results, created if missing
    #[arg(short, long, value_name = "DIR", conflicts_with_all = ["matches", "write_views"])]
    output: Option<PathBuf>,
    /// Ignore the results of an earlier run in the output folder
    #[arg(long, requires = "output")]
    fresh: bool,
    /// Match the views as they are: without rotating, scaling or smoothing them, and without the support of
    /// neighbouring matches
    #[arg(long)]
    plain: bool,
    #[arg(long, value_name = "R", help = with_default("Ratio test: largest ratio of the distances of the best and the \
        second best descriptor, above 0, at most 1", WideBaselineConfig::default().matching.ratio))]
    ratio: Option<f32>,
    #[command(flatten)]
    truth: TruthOptions,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    features: FeatureOptions,
}

/// Source of the matches.
enum Finder {
    Hsad(Backend, WideBaselineConfig),
    Supplied { matches: PathBuf, points: Option<Vec<PathBuf>> },
}

impl Features {
    /// Scores all pairs under all conditions; failures do not stop the others and are returned at the end.
    pub fn run(mut self) -> anyhow::Result<()> {
        // Nothing else goes to standard output then.
        self.run.quiet |= [&self.csv, &self.json].into_iter().flatten().any(|file| is_stdout(file));
        self.first.sort_unstable();
        self.first.dedup();
        let mut config = WideBaselineConfig { adapt: !self.plain, ..WideBaselineConfig::default() };
        config.features = self.features.over(config.features)?;
        config.matching.ratio = self.ratio.unwrap_or(config.matching.ratio);
        config.validate()?;
        self.check()?;
        let changes = Change::parse_all(&self.conditions)?;
        let (pairs, unread) =
            scenes::collect(&self.folders, |path| Pair::find(path, self.view, self.truth), |pair| &pair.name)?;
        let mut failures: Vec<String> = unread.iter().map(Error::to_string).collect();
        if let Some(folder) = &self.write_views {
            self.write(folder, &pairs, &changes, &mut failures)?;
            return report_failures(&failures);
        }
        let root = self.output.as_deref().map(Output::open).transpose()?;
        let supplied = self.matches.iter().chain(self.points.iter().flatten()).map(PathBuf::as_path);
        let of_pairs = pairs.iter().filter_map(|pair| pair.files().ok()).flatten();
        let tables = [&self.csv, &self.json].into_iter().flatten().map(PathBuf::as_path);
        check_tables(tables, of_pairs.chain(supplied))?;
        let finder = match self.matches.take() {
            None => Finder::Hsad(self.run.open()?.backend, config),
            Some(matches) if pairs.len() > 1 || self.folders.len() > 1 || changes.len() > 1 => {
                return Err(Error::Parameter {
                    name: "matches",
                    value: matches.display().to_string(),
                    expected:
                        "they belong to one pair under one condition: name one folder, one --condition, and for a \
                               homography set one --view"
                            .into(),
                }
                .into());
            }
            Some(matches) => Finder::Supplied { matches, points: self.points.take() },
        };

        let mut table = Table { columns: self.columns(), rows: Vec::new() };
        let width = pairs.iter().map(|pair| pair.name.chars().count()).fold("mean".len(), usize::max);
        let saved = self.saved_results(&finder);
        let of_pair = |pair: &Pair| {
            pair.files()?.into_iter().try_fold(saved.clone().below(&pair.name), SavedResults::depending_on_file)
        };
        let saved_by_pair: Vec<Result<SavedResults>> = pairs.iter().map(of_pair).collect();
        let progress = Progress::new(self.run.quiet);
        let total = pairs.len() * changes.len();
        let (mut done, mut reused) = (0, 0);
        for change in &changes {
            let before = table.rows.len();
            for (pair, saved) in pairs.iter().zip(&saved_by_pair) {
                done += 1;
                progress.piece(&format!("{}, {}", pair.name, change.name), done, total);
                let failure = match self.row(pair, change, &finder, saved, &mut reused) {
                    Ok((row, unsaved)) => {
                        table.rows.push(row);
                        unsaved
                    }
                    Err(failure) => Some(failure),
                };
                failures.extend(failure.filter(|failure| !failures.contains(failure)));
            }
            if table.rows.len() > before && !self.run.quiet {
                let gap = if before == 0 { "" } else { "\n" };
                progress.suspend(|| terminal::print(&format!("{gap}{}", table.text(&change.name, width))))?;
            }
        }
        drop((progress, root));
        if let (Some(folder), true, false) = (&self.output, !table.rows.is_empty(), self.run.quiet) {
            let reuse = saved_results::reuse_note(reused, table.rows.len());
            terminal::print(&format!("\nresults are in {}{reuse}\n", hsad::shown(folder)))?;
        }
        self.write_figures(&table, &finder, &failures)?;
        report_failures(&failures)
    }

    fn check(&self) -> Result<()> {
        let refuse =
            |name, value: String, expected: &str| Err(Error::Parameter { name, value, expected: expected.into() });
        if !(self.tolerance >= 0.0 && self.tolerance.is_finite()) {
            return refuse("tolerance", self.tolerance.to_string(), "it must be a number of pixels from 0 up");
        }
        if self.first.contains(&0) {
            return refuse("first", "0".into(), "it must be at least 1");
        }
        Ok(())
    }

    fn write(
        &self,
        folder: &Path,
        pairs: &[Pair],
        changes: &[Change],
        failures: &mut Vec<String>,
    ) -> anyhow::Result<()> {
        // A folder that stays empty is removed again when this is dropped.
        let _folder = Output::open(folder)?;
        for pair in pairs {
            let views = match pair.views() {
                Ok(views) => views,
                Err(error) => {
                    failures.push(format!("{}: {error}", pair.name));
                    continue;
                }
            };
            for change in changes {
                let changed = Changed::by(&change.conditions, &views.second, self.seed);
                let name = format!("{} {}.png", pair.name, change.name);
                let rgb = changed.picture.map(|&[red, green, blue, _]| [red, green, blue]);
                write_whole(&folder.join(&name), |out| png::write_rgb8(out, &rgb))?;
            }
        }
        Ok(())
    }

    /// Where the results of all pairs are saved.
    fn saved_results(&self, finder: &Finder) -> SavedResults {
        let saved = SavedResults::new(self.output.as_deref(), self.fresh);
        let saved = saved.depending_on(&format!("{} {} {:?} {:?}", self.tolerance, self.seed, self.first, self.truth));
        match finder {
            Finder::Hsad(backend, config) => {
                saved.depending_on(&format!("{config:?}")).depending_on(&report::device(backend).to_string())
            }
            Finder::Supplied { .. } => saved,
        }
    }

    /// The figures of a pair under a condition, with the reason if they could not be saved.
    ///
    /// # Errors
    /// A message that names the pair and, if it is to blame, the condition.
    fn row(
        &self,
        pair: &Pair,
        change: &Change,
        finder: &Finder,
        saved: &Result<SavedResults>,
        reused: &mut usize,
    ) -> std::result::Result<(Row, Option<String>), String> {
        let of_pair = |error: &Error| format!("{}: {}", pair.name, in_options(error));
        let saved = saved.as_ref().map_err(of_pair)?.clone().below(&change.name).depending_on(&change.name);
        if let Some(row) = saved.load() {
            *reused += 1;
            return Ok((row, None));
        }
        let views = pair.views().map_err(|error| of_pair(&error))?;
        let described = |error: Error| format!("{}, {}: {}", pair.name, change.name, in_options(&error));
        let figures = self.figures(views, change, finder).map_err(described)?;
        let row = Row { scene: pair.name.clone(), condition: change.name.clone(), figures };
        let unsaved = saved.save(&row, |_| Ok(())).err().map(described);
        Ok((row, unsaved))
    }

    fn columns(&self) -> Vec<Column> {
        let column = |name: &str, title: &str, unit| Column { name: name.into(), title: title.into(), unit };
        let mut columns = vec![
            column("points", "points", Unit::Count),
            column("matches", "matches", Unit::Count),
            column("precision", "right", Unit::Share),
            column("recall", "recall", Unit::Share),
            column("f_measure", "F", Unit::Share),
        ];
        columns
            .extend(self.first.iter().map(|k| column(&format!("precision_of_{k}"), &format!("of {k}"), Unit::Share)));
        columns.extend([
            column("coverage", "cover", Unit::Share),
            column("repeatability", "repeat", Unit::Share),
            column("matching_score", "score", Unit::Share),
        ]);
        columns
    }

    /// The figures of a pair under a condition, in the order of [`Self::columns`].
    fn figures(&self, views: &Views, change: &Change, finder: &Finder) -> Result<Vec<f64>> {
        let changed = Changed::by(&change.conditions, &views.second, self.seed);
        let truth = views.truth.clone().changed(&changed);
        let (matches, points) = match finder {
            Finder::Hsad(backend, config) => {
                let found = block_on(match_views(backend, &views.first.luma(), &changed.picture.luma(), config))?;
                let points = found.features.each_ref().map(|view| view.iter().map(Point::from).collect::<Vec<_>>());
                (found.matches.iter().map(PointMatch::from).collect(), Some(points))
            }
            Finder::Supplied { matches, points } => {
                let sizes = truth.sizes();
                let mut matches: Vec<PointMatch> = supplied_matches::matches(matches, sizes)?;
                let points = match points.as_deref() {
                    Some([first, second]) => {
                        Some([supplied_matches::points(first, sizes[0])?, supplied_matches::points(second, sizes[1])?])
                    }
                    _ => None,
                };
                if let Some([first, second]) = &points {
                    supplied_matches::join(&mut matches, [first, second]);
                }
                (matches, points)
            }
        };
        if let Some(other) = OtherForm::of(&matches, &truth, self.tolerance)? {
            return Err(of_another_form(other, finder));
        }
        let judged = Judged::new(&matches, &truth, self.tolerance)?;
        let point_scores = points.map(|[first, second]| PointScores::new(&matches, &judged, [&first, &second], &truth));
        let by_points = |figure: &dyn Fn(&PointScores) -> f64| point_scores.as_ref().map_or(f64::NAN, figure);
        let mut figures = vec![
            by_points(&|found| found.repeatability.fewer() as f64),
            judged.right.len() as f64,
            judged.precision(),
            by_points(&|found| found.recall),
            by_points(&|found| found.f_measure),
        ];
        figures.extend(self.first.iter().map(|&k| accuracy_of_first(&judged.right, k)));
        figures.extend([
            by_points(&|found| found.coverage),
            by_points(&|found| found.repeatability.share()),
            by_points(&|found| found.matching_score),
        ]);
        Ok(figures)
    }

    /// Writes the files of `--csv` and `--json`.
    fn write_figures(&self, table: &Table, finder: &Finder, failed: &[String]) -> Result<()> {
        if let Some(path) = &self.csv {
            write_text(path, &table.csv())?;
        }
        if let Some(path) = &self.json {
            let mut report = json!({
                "version": env!("CARGO_PKG_VERSION"),
                "matches_of": match finder {
                    Finder::Hsad(..) => "hsad".into(),
                    Finder::Supplied { matches, .. } => matches.display().to_string(),
                },
                "tolerance_px": self.tolerance,
                "seed": self.seed,
                "failed": failed,
            });
            if let Finder::Hsad(backend, config) = finder {
                report["device"] = json!(backend.name());
                report["adapt"] = json!(config.adapt);
            }
            if let (Some(report), Some(figures)) = (report.as_object_mut(), table.json().as_object_mut()) {
                report.append(figures);
            }
            write_text(path, &format!("{report:#}\n"))?;
        }
        Ok(())
    }
}

/// The error of a homography that would agree with the matches in another form.
fn of_another_form(OtherForm { form, agree }: OtherForm, finder: &Finder) -> Error {
    let [as_it_is, other] = agree.map(|share| 100.0 * share);
    let or_exchange = match (form, finder) {
        (Form::Inverse, Finder::Supplied { .. }) => {
            ", or exchange the columns of the first and the second view in the matches"
        }
        _ => "",
    };
    Error::Parameter {
        name: "the homography",
        value: "in another form than from the first view to the second, row by row".into(),
        expected: format!(
            "{as_it_is:.0} % of the matches agree with it, and {other:.0} % if it is {0}: write it {0}{or_exchange}",
            form.words()
        ),
    }
}
