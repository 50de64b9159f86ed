//! `hsad match`: computes a disparity map from two pictures.

use std::path::PathBuf;

use clap::Args;
use hsad::io::load::{LoadedPair, load_pair};

use super::{
    depth::DepthOptions,
    job::Job,
    options::{FeatureOptions, MatchOptions, RunOptions, UnseenOptions},
    output::Output,
    products, summary,
    terminal::{self, Progress},
};

/// Compute a disparity for every pixel of a rectified pair
///
/// Writes disparity.pfm (32-bit float, in pixels, +inf for no disparity), disparity.png (16 bit, 256
/// times the disparity, 0 for no disparity), disparity-color.png, confidence.png and report.json;
/// with a calibration also depth.pfm (in metres) and cloud.ply. A left pixel (x, y) with disparity d
/// corresponds to the right pixel (x - d, y). Without --disparities the range is found from matching
/// interest points.
#[derive(Args)]
#[command(name = "match", after_help = concat!("Examples:
  hsad match left.png right.png -o out
  hsad match left.png right.png -o out --disparities 128 --window 7
  hsad match left.png right.png -o out --focal 1400 --baseline 0.12
  hsad match im0.png im1.png -o out --calib calib.txt --device cpu
  hsad match left.png right.png -o out --preset paper --figures
  hsad match left.png right.png -o out --method kamencay
  hsad match left.png right.png -o out --mask round.png round.png
  hsad match left.tif right.tif -o out --nodata -9999

Exit codes: 0 done, 1 failed, 2 usage, 3 not rectified, 4 written but not to be trusted (--force goes on all the same)"))]
pub struct Match {
    /// Left view: PNG, JPEG, PNM, PFM, BMP, TIFF or WebP, of 8 bits, 16 bits or floats
    left: PathBuf,
    /// Right view, of the same size
    right: PathBuf,
    /// Output folder, created if missing
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
    #[command(flatten)]
    unseen: UnseenOptions,
}

impl Match {
    /// Matches the pair and writes all files; none of them appears unless every one could be written.
    pub fn run(self) -> anyhow::Result<()> {
        let (config, strongest) = (self.matching.config(&self.features)?, self.matching.strongest()?);
        let mut output = Output::open(&self.output)?;
        let LoadedPair { left, right, stretch, mut warnings } =
            load_pair(&self.left, &self.right, &self.unseen.unseen())?;
        let calibration = self.depth.calibration([&self.left, &self.right], left.size())?;
        let calibration = calibration.map(|(calibration, notes)| {
            warnings.extend(notes);
            calibration
        });
        // Told before the match, since they may be the reason why it fails.
        let told = warnings.len();
        if !self.run.quiet {
            warnings.iter().for_each(terminal::warning);
        }

        let names = [&self.left, &self.right].map(|path| path.display().to_string());
        let mut completed = Job { names, left, right, stretch, config, strongest, calibration }.run(&self.run)?;
        completed.warnings.splice(0..0, warnings);

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
            completed.warnings[told..].iter().for_each(terminal::warning);
            terminal::print(&(completed.summary() + &summary::files(&output)))?;
        }
        completed.not_trusted.map_or(Ok(()), |doubt| Err(doubt.into()))
    }
}
