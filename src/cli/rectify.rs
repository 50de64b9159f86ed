//! `hsad rectify`: brings the rows of two views to correspond.

use std::{path::PathBuf, time::Instant};

use clap::Args;
use hsad::{
    Error,
    io::load::LoadedPair,
    pipeline::{self, RectifiedPair},
    rectify::Residual,
};
use serde_json::json;

use super::{
    depth::CalibrationOptions,
    doubts,
    names::{RECTIFIED, REPORT},
    options::{RunOptions, UnseenOptions},
    output::Output,
    products, rectification, report, summary,
    terminal::{self, Progress},
    view_files::ViewOptions,
};

/// Number of matches below which nothing tells whether a calibration fits.
const LEAST: usize = 20;

/// Rectify a pair: bring its rows to correspond
///
/// Writes left.png and right.png, of one size and transparent where they show nothing, their masks,
/// epipolar-lines.png, matrices (rectification.json, rectification.yml for OpenCV) and report.json.
///
/// With --calib the views are turned by the calibration of the cameras as they stood; the matrices are
/// R1, R2, P1, P2 and Q, in metres. Without it everything is found from matching interest points: the
/// views may be turned against each other by any angle, differ in size and scale, and have a distorted
/// lens; the matrices are homographies, and k1. The left view then stays as it is where resampling the
/// right one suffices, and disparities have no known baseline, and so no metres.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad rectify left.jpg right.jpg -o rectified
  hsad rectify left.jpg right.jpg -o rectified --calib rig.yml
  hsad match rectified/left.png rectified/right.png -o out

Exit codes: 0 done, 1 failed, 2 usage, 3 cannot be rectified")]
pub struct Rectify {
    #[command(flatten)]
    views: ViewOptions,
    /// Output folder, created if missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    calibration: CalibrationOptions,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    unseen: UnseenOptions,
}

impl Rectify {
    /// Rectifies the pair and writes all files; none of them appears unless every one could be written.
    pub fn run(self) -> anyhow::Result<()> {
        let unseen = self.unseen.unseen();
        let mut output = Output::open_set(&self.output)?.sparing(self.views.views().paths()).sparing(unseen.files());
        RECTIFIED.all().into_iter().chain([REPORT]).try_for_each(|name| output.check(name))?;
        let LoadedPair { left, right, mut warnings, .. } = self.views.views().load(&unseen)?;
        let sizes = [left.size(), right.size()];
        let file = self.calibration.read(self.views.views().paths(), sizes)?;
        if let Some(file) = &file {
            file.check_taken(sizes)?;
            warnings.extend(file.loaded.notes.iter().cloned());
        }
        let start = Instant::now();
        let cached = self.run.open()?;
        let backend = &cached.backend;
        let progress = Progress::new(self.run.quiet);
        progress.begin("rectifying");
        let pair = match &file {
            Some(file) => pipeline::rectify_by(backend, (&left, &right), &file.loaded.stereo)?,
            None => pipeline::rectify(backend, (&left, &right)).or_else(|error| {
                let mirrored = match error {
                    Error::NotRectifiable { .. } => pipeline::mirrored(backend, (&left, &right))?,
                    _ => None,
                };
                Err(mirrored.map_or(error, |sides| Error::NotRectifiable { reason: doubts::mirrored(sides) }))
            })?,
        };
        cached.save();
        let seconds = start.elapsed().as_secs_f64();
        warnings.extend(misfit(&pair));
        warnings.extend(doubts::of_rectified(&pair));
        warnings.extend(exchanged(&pair));
        progress.begin("writing");
        rectification::add_files(&pair, &RECTIFIED, &mut output)?;
        let report = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "left": self.views.views().paths()[0].display().to_string(),
            "right": self.views.views().paths()[1].display().to_string(),
            "device": report::device(backend),
            "rectified": hsad::report::rectified(&pair),
            "seconds": { "total": seconds },
            "warnings": warnings,
        });
        products::add_report(&mut output, report)?;
        output.finish_run(0)?;
        drop(progress);
        if !self.run.quiet {
            warnings.iter().for_each(terminal::warning);
            terminal::print(&(summary::rectified(&pair) + &summary::files(&output)))?;
        }
        Ok(())
    }
}

/// A warning if most matches of a pair rectified from them have negative disparities.
fn exchanged(pair: &RectifiedPair) -> Option<String> {
    let place = |view, pixel| pair.rectification.rectified_of(view, pixel);
    let disparities: Vec<f64> =
        pair.points.iter().filter_map(|point| Some(place(0, point.left)?.x - place(1, point.right)?.x)).collect();
    let negative = disparities.iter().filter(|&&disparity| disparity < 0.0).count();
    (disparities.len() >= LEAST && 4 * negative > 3 * disparities.len()).then(|| {
        format!(
            "{negative} of {} matches have negative disparities: if left and right are mixed up, exchange them",
            disparities.len()
        )
    })
}

/// A warning if the rows of most matches do not correspond after all.
fn misfit(pair: &RectifiedPair) -> Option<String> {
    let Residual { points, right, .. } = pair.residual;
    (pair.rectification.calibration().is_some() && (points < LEAST || !pair.residual.is_of_most())).then(|| {
        format!(
            "rows of {right} of {points} matches correspond after the rectification: check that the calibration is that of the \
             pictures, and that left and right are not mixed up"
        )
    })
}
