//! `hsad match`: a disparity map from two pictures.

use std::path::PathBuf;

use clap::Args;
use hsad::{Error, io::load};

use super::{
    job::Job,
    options::{DepthOptions, FeatureOptions, MatchOptions, RunOptions},
    output::Output,
    products, summary,
    terminal::{self, Progress},
};

/// Compute a disparity for every pixel of a rectified pair
///
/// Writes disparity.pfm (float, +inf where there is none), disparity.png (16 bit, 256 times the
/// disparity, 0 where there is none), disparity-color.png, confidence.png and report.json; with a
/// calibration also depth.pfm (metres) and cloud.ply. A left pixel (x, y) with disparity d is the
/// right pixel (x - d, y). The disparity range is found from matching interest points.
#[derive(Args)]
#[command(name = "match", after_help = concat!("Examples:
  hsad match left.png right.png -o out
  hsad match left.png right.png -o out --disparities 128 --window 7
  hsad match left.png right.png -o out --focal 1400 --baseline 0.12
  hsad match im0.png im1.png -o out --calib calib.txt --device cpu
  hsad match left.png right.png -o out --preset paper --figures
  hsad match left.png right.png -o out --method kamencay

Exit codes: 0 done, 1 failed, 2 usage, 3 not rectified (--force goes on all the same)"))]
pub struct Match {
    /// The left view: PNG, JPEG, PNM, BMP, TIFF or WebP
    left: PathBuf,
    /// The right view
    right: PathBuf,
    /// Folder for the results, created if need be
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Also draw interest points (keypoints.png) and matches (matches.png)
    #[arg(long)]
    figures: bool,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    matching: MatchOptions,
    #[command(flatten)]
    features: FeatureOptions,
    #[command(flatten)]
    depth: DepthOptions,
}

impl Match {
    /// Does it all, and lets the files appear at the end.
    pub fn run(self) -> anyhow::Result<()> {
        let config = self.matching.config(&self.features)?;
        let mut output = Output::open(&self.output)?;
        let (left, right) = (load::load(&self.left)?, load::load(&self.right)?);
        if left.size() != right.size() {
            return Err(Error::SizesDiffer { left: left.size(), right: right.size() }.into());
        }
        let calibration = self.depth.calibration(left.size())?;
        let names = [&self.left, &self.right].map(|path| path.display().to_string());
        let mut completed = Job { names, left, right, config, calibration }.run(&self.run)?;

        let progress = Progress::new(self.run.quiet);
        progress.begin("writing");
        completed.add_maps(&mut output)?;
        if self.figures {
            completed.add_figures(&mut output)?;
        }
        products::add_report(&mut output, completed.report())?;
        output.finish()?;
        drop(progress);

        if !self.run.quiet {
            completed.warnings.iter().for_each(terminal::warning);
            terminal::print(&(completed.summary() + &summary::files(&output)))?;
        }
        Ok(())
    }
}
