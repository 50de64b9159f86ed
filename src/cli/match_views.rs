//! `hsad match`: computes a disparity map from two pictures.

use std::path::PathBuf;

use clap::Args;
use hsad::io::load::LoadedPair;

use super::{
    cloud::CloudOptions,
    depth::{Cameras, DepthOptions},
    job::Job,
    options::{FigureOptions, MatchOptions, RunOptions, UnseenOptions},
    output::Output,
    products,
    rectification::{self, Names},
    summary,
    terminal::{self, Progress},
    view_files::ViewOptions,
    way::{Rectify, Resolved},
};

/// Names of the files of a pair that was rectified first.
const NAMES: Names = Names {
    pictures: ["rectified-left.png", "rectified-right.png"],
    masks: ["rectified-left-mask.png", "rectified-right-mask.png"],
    figure: "epipolar-lines.png",
    json: "rectification.json",
    yaml: "rectification.yml",
};

/// Compute a disparity for every pixel of a pair
///
/// Writes disparity.pfm (32-bit float, in pixels, +inf for no disparity), disparity.png (16 bit, 256
/// times the disparity, 0 for no disparity; with an offset where disparities are negative), disparity-color.png, confidence.png and report.json;
/// with a calibration also depth.pfm (in metres), depth.png (16 bit, in millimetres) and cloud.ply, which
/// has the measured pixels whose depth is known to a tenth. A left pixel (x, y) with disparity d corresponds to the right pixel
/// (x - d, y). Without --disparities the range is found from a coarse map of the pair and from
/// matching interest points.
///
/// A pair that is not rectified is rectified first, by the calibration or from its matches (see hsad
/// rectify); disparities are then those of rectified-left.png and rectified-right.png, which are written
/// beside the map. Depth is then that of the rectified left camera, and the cloud is in coordinates of
/// the left camera as it stood; with --map-back depth is that of the left camera as it stood, too.
#[derive(Args)]
#[command(name = "match", after_help = concat!("Examples:
  hsad match left.png right.png -o out
  hsad match left.png right.png -o out --disparities 128 --window 7
  hsad match left.png right.png -o out --focal 1400 --baseline 0.12
  hsad match im0.png im1.png -o out --calib calib.txt --device cpu
  hsad match im0.png im1.png -o out --calib calib.txt --max-depth 30 --min-confidence 128
  hsad match left.png right.png -o out --preset paper --figures
  hsad match left.png right.png -o out --calib rig.yml --map-back
  hsad match left.png right.png -o out --rectify never
  hsad match left.png right.png -o out --method kamencay
  hsad match left.png right.png -o out --mask round.png round.png
  hsad match left.tif right.tif -o out --nodata -9999
  hsad match DSCF0001.MPO -o out
  hsad match both.jps -o out --side-by-side right-left

Exit codes: 0 done, 1 failed, 2 usage, 3 not rectified and cannot be, 4 written but not to be trusted,
5 written but without the depth that was asked for (--force goes on all the same)"))]
pub struct Match {
    #[command(flatten)]
    views: ViewOptions,
    /// Output folder, created if missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Also draw interest points (keypoints.png) and matches (matches.png)
    #[arg(long)]
    figures: bool,
    /// Also write the matches of the interest points (matches.csv), found in any row: positions, scales and orientations in
    /// both views, distance and ratio of the descriptors, confidence, and 1 where rows agree
    #[arg(long)]
    matches: bool,
    /// Whether and how to rectify the pair before it is matched
    #[arg(long, value_enum, default_value = "auto")]
    rectify: Rectify,
    /// Take the map of a pair that was rectified first back to the left picture as it was taken (with --reference right to
    /// the right one); disparities remain those of the rectified pair
    #[arg(long)]
    map_back: bool,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    matching: MatchOptions,
    #[command(flatten)]
    figure: FigureOptions,
    #[command(flatten)]
    depth: DepthOptions,
    #[command(flatten)]
    cloud: CloudOptions,
    #[command(flatten)]
    unseen: UnseenOptions,
}

impl Match {
    /// Matches the pair and writes all files; none of them appears unless every one could be written.
    pub fn run(self) -> anyhow::Result<()> {
        let (config, strongest) = (self.matching.config()?, self.figure.strongest(&self.matching)?);
        let unseen = self.unseen.unseen();
        let mut output = Output::open_set(&self.output)?.sparing(self.views.paths()).sparing(unseen.files());
        let LoadedPair { left, right, stretch, mut warnings } = self.views.load(&unseen)?;
        let sizes = [left.size(), right.size()];
        let cameras = self.depth.cameras(self.views.paths(), sizes)?;
        let is_calibrated = !matches!(cameras, Cameras::Unknown);
        self.cloud.check(is_calibrated)?;
        self.check_places(&output, is_calibrated)?;
        let Resolved { way, calibration, notes } = Resolved::new(self.rectify, cameras, sizes)?;
        warnings.extend(notes);
        // Told before the match, since they may be the reason why it fails.
        let told = warnings.len();
        if !self.run.quiet {
            warnings.iter().for_each(terminal::warning);
        }

        let names = self.views.paths().map(|path| path.display().to_string());
        let job = Job { names, left, right, stretch, config, way, map_back: self.map_back, strongest, calibration };
        let mut completed = job.run(&self.run)?;
        completed.warnings.splice(0..0, warnings);

        let progress = Progress::new(self.run.quiet);
        progress.begin("writing");
        completed.add_maps(&mut output, &self.cloud)?;
        if let Some(pair) = &completed.rectified {
            rectification::add_files(pair, &NAMES, &mut output)?;
        }
        if self.figures {
            completed.add_figures(&mut output)?;
        }
        if self.matches {
            completed.add_matches(&mut output)?;
        }
        products::add_report(&mut output, completed.report())?;
        let shortfall = completed.shortfall();
        output.finish_run(shortfall.as_ref().map_or(0, super::exit_code))?;
        drop(progress);

        if !self.run.quiet {
            completed.warnings[told..].iter().for_each(terminal::warning);
            terminal::print(&(completed.summary() + &summary::files(&output)))?;
        }
        shortfall.map_or(Ok(()), Err)
    }

    /// Checks that each file that is sure to be written may be.
    fn check_places(&self, output: &Output, is_calibrated: bool) -> hsad::Result<()> {
        let of = |names: &'static [&str], are_written: bool| if are_written { names } else { &[] };
        let names = [
            &products::MAPS[..],
            of(&products::DEPTH, is_calibrated),
            of(&products::FIGURES, self.figures),
            of(&[products::MATCHES], self.matches),
        ];
        names.concat().into_iter().try_for_each(|name| output.check(name))
    }
}
