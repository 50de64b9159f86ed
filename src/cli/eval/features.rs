//! `hsad eval features`: how good matches of interest points are.

mod supplied_matches;
mod table;
mod views;

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use clap::Args;
use hsad::{
    Error, Result,
    eval::{Judged, OfPoints, Point, PointMatch, conditions::Changed, curves::accuracy_of_first},
    io::{atomic::write_whole, png},
    pair::Backend,
    wide_baseline::{WideBaselineConfig, match_views},
};
use serde_json::json;

use crate::cli::{
    eval::{
        change::{Change, kinds},
        report_failures,
        saved_results::{self, SavedResults},
        scenes,
    },
    options::{FeatureOptions, RunOptions, with_default},
    output::{Output, check_writable},
    report,
    terminal::{self, Progress},
};
use table::{Column, Row, Table, Unit};
use views::{Pair, Views};

const DETAILS: &str = "\
A folder is what hsad eval dense takes for a scene or for scenes, or a homography set (img1.png, and img2.png with \
H1to2p, img3.png with H1to3p, ...: nine numbers that take a pixel of the first to the other).

What is measured, of each pair and in the mean, shares in per cent:
  points   interest points in what both views show, of the view with fewer
  matches  those whose truth is known; only they count
  right    precision: matches within the tolerance of the true place
  recall   right matches by what could have been found
  F        harmonic mean of precision and recall
  of N     precision among the N most confident, or all where there are fewer
  cover    points of the first view that have a match, right or not
  repeat   repeatability: pairs of points that correspond, by points
  score    matching score: matches of points that correspond, by points

Places are compared in pixels of the second view; where it does not show a point, no match of it is right. Two points \
correspond if the overlap error of their regions is at most 40 %, both enlarged until that of the first view has a \
radius of 30 px, each with one other at most (Mikolajczyk et al., IJCV 65, 2005). What could have been found are these, \
and right matches of others.

Conditions change the second view, and the truth with it: NAME or NAME=STRENGTH, several in a row joined by '+', or none:";

const EXAMPLES: &str = "\
Matches of another program (--matches): CSV with a header, columns x1, y1, x2, y2 in pixels of the first and the second \
view, and, if there is one, confidence, the greater the surer; without it the surest come first. Its points \
(--points): x, y and scale, as `hsad features` writes them; without them only precision is known. --write-views gives \
it the changed views.

With -o, DIR/PAIR/CONDITION/result.json is not computed again while pictures, options, device and program are the same.

Examples:
  hsad eval features data -o out
  hsad eval features data/planes --condition rotation=30 --condition blur=1+noise=5
  hsad eval features boat --view 3 --json boat.json
  hsad eval features data/planes --matches theirs.csv --points l.csv r.csv";

fn details() -> String {
    format!("{DETAILS}\n{}\n\n{EXAMPLES}", kinds())
}

/// The default here is not that of the other subcommands.
fn threshold_help() -> String {
    let default = WideBaselineConfig::default().features.threshold;
    with_default("Least determinant of the Hessian, with grey values of 0 to 1", default)
}

/// Measure how good matches of interest points are
#[derive(Args)]
#[command(after_help = details(), mut_arg("threshold", |option| option.help(threshold_help())))]
pub struct Features {
    /// Folders of stereo scenes or homography sets
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Change the second view first, such as rotation=30; each of several is a table of its own
    #[arg(long = "condition", value_name = "NAME[=STRENGTH]", default_value = "none")]
    conditions: Vec<String>,
    /// What is random in a condition is another for another seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How far from the true place a right match can be
    #[arg(long, value_name = "PX", default_value_t = 1.5, allow_negative_numbers = true)]
    tolerance: f64,
    /// Numbers of most confident matches whose precision is told
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "10,50,100,500")]
    first: Vec<usize>,
    /// Of a homography set only this view, 2 or more
    #[arg(long, value_name = "K")]
    view: Option<u32>,
    /// Score these matches, which another program found, of the only pair and condition
    #[arg(long, value_name = "FILE")]
    matches: Option<PathBuf>,
    /// The points that it found in the first and in the second view
    #[arg(long, num_args = 2, value_names = ["FIRST", "SECOND"], requires = "matches")]
    points: Option<Vec<PathBuf>>,
    /// Write the changed second views to this folder, for other programs, and evaluate nothing
    #[arg(long, value_name = "DIR", conflicts_with_all = ["matches", "csv", "json"])]
    write_views: Option<PathBuf>,
    /// Write the figures to this file, a line for each pair and condition
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write the figures and how they were found to this file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Folder for the results, created if need be
    #[arg(short, long, value_name = "DIR", conflicts_with_all = ["matches", "write_views"])]
    output: Option<PathBuf>,
    /// Compute again what an earlier run left in the folder
    #[arg(long, requires = "output")]
    fresh: bool,
    /// Match the views as they are: do not turn, scale or smooth them, nor ask neighbours
    #[arg(long)]
    plain: bool,
    #[arg(long, value_name = "R", help = with_default("Largest ratio of the distances of the best and the second \
        descriptor, up to 1", WideBaselineConfig::default().matching.ratio))]
    ratio: Option<f32>,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    features: FeatureOptions,
}

/// Who finds the matches.
enum Finder {
    Hsad(Backend, WideBaselineConfig),
    Supplied { matches: PathBuf, points: Option<Vec<PathBuf>> },
}

impl Features {
    /// Measures, and tells in the end what could not be measured.
    pub fn run(mut self) -> anyhow::Result<()> {
        self.first.sort_unstable();
        self.first.dedup();
        let mut config = WideBaselineConfig { adapt: !self.plain, ..WideBaselineConfig::default() };
        config.features = self.features.over(config.features);
        config.matching.ratio = self.ratio.unwrap_or(config.matching.ratio);
        config.validate()?;
        self.check()?;
        let changes = Change::parse_all(&self.conditions)?;
        let (pairs, unread) = scenes::collect(&self.folders, |path| Pair::find(path, self.view), |pair| &pair.name)?;
        let mut failures: Vec<String> = unread.iter().map(Error::to_string).collect();
        if let Some(folder) = &self.write_views {
            self.write(folder, &pairs, &changes, &mut failures)?;
            return report_failures(&failures);
        }
        let root = self.output.as_deref().map(Output::open).transpose()?;
        for file in [&self.csv, &self.json].into_iter().flatten() {
            check_writable(file)?;
        }
        let finder = match self.matches.take() {
            None => Finder::Hsad(self.run.open()?, config),
            Some(matches) if pairs.len() > 1 || self.folders.len() > 1 || changes.len() > 1 => {
                return Err(Error::Parameter {
                    name: "matches",
                    value: matches.display().to_string(),
                    expected:
                        "they belong to one pair under one condition: name one folder, one --condition, and of a \
                               homography set the --view"
                            .into(),
                }
                .into());
            }
            Some(matches) => Finder::Supplied { matches, points: self.points.take() },
        };

        let mut table = Table { columns: self.columns(), rows: Vec::new() };
        let width = pairs.iter().map(|pair| pair.name.chars().count()).fold("mean".len(), usize::max);
        let saved = self.saved_results(&finder);
        let of_pair =
            |pair: &Pair| pair.files()?.into_iter().try_fold(saved.clone().below(&pair.name), SavedResults::depending_on_file);
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
            terminal::print(&format!("\nresults are in {}{reuse}\n", folder.display()))?;
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
        // Of a folder that is made for nothing, nothing is left.
        let _made = Output::open(folder)?;
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

    /// Where the results of all pairs are kept.
    fn saved_results(&self, finder: &Finder) -> SavedResults {
        let saved = SavedResults::new(self.output.as_deref(), self.fresh);
        let saved = saved.depending_on(&format!("{} {} {:?}", self.tolerance, self.seed, self.first));
        match finder {
            Finder::Hsad(backend, config) => {
                saved.depending_on(&format!("{config:?}")).depending_on(&report::device(backend).to_string())
            }
            Finder::Supplied { .. } => saved,
        }
    }

    /// The figures of a pair under a condition, and why they could not be kept; or what is wrong with the pair, or with
    /// it under this condition.
    fn row(
        &self,
        pair: &Pair,
        change: &Change,
        finder: &Finder,
        saved: &Result<SavedResults>,
        reused: &mut usize,
    ) -> std::result::Result<(Row, Option<String>), String> {
        let of_pair = |error: &Error| format!("{}: {error}", pair.name);
        let saved = saved.as_ref().map_err(of_pair)?.clone().below(&change.name).depending_on(&change.name);
        if let Some(row) = saved.load() {
            *reused += 1;
            return Ok((row, None));
        }
        let views = pair.views().map_err(|error| of_pair(&error))?;
        let described = |error: Error| format!("{}, {}: {error}", pair.name, change.name);
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
                let found = match_views(backend, &views.first.luma(), &changed.picture.luma(), config)?;
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
        let judged = Judged::new(&matches, &truth, self.tolerance)?;
        let of_points = points.map(|[first, second]| OfPoints::new(&matches, &judged, [&first, &second], &truth));
        let by_points = |figure: &dyn Fn(&OfPoints) -> f64| of_points.as_ref().map_or(f64::NAN, figure);
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

    /// The files that were asked for.
    fn write_figures(&self, table: &Table, finder: &Finder, failed: &[String]) -> Result<()> {
        if let Some(path) = &self.csv {
            write_whole(path, |out| out.write_all(table.csv().as_bytes()))?;
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
            write_whole(path, |out| writeln!(out, "{report:#}"))?;
        }
        Ok(())
    }
}
