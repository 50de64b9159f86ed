//! `hsad match`: computes a disparity map from two pictures.

use std::path::PathBuf;

use clap::Args;

use super::{
    options::RunOptions,
    output::Output,
    recipe::{Known, Prepared, Recipe},
    summary,
    terminal::{self, Progress},
    view_files::ViewOptions,
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
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    recipe: Recipe,
}

impl Match {
    /// Matches the pair and writes all files; none of them appears unless every one could be written.
    pub fn run(self) -> anyhow::Result<()> {
        self.recipe.config()?;
        let mut output = Output::open_set(&self.output)?;
        let Prepared { job, warnings } = self.recipe.prepare(&self.views.views(), Known::Nothing, &mut output)?;
        let told = warnings.len();
        if !self.run.quiet {
            warnings.iter().for_each(terminal::warning);
        }
        let mut completed = job.run(&self.run)?;
        completed.warnings.splice(0..0, warnings);

        let progress = Progress::new(self.run.quiet);
        progress.begin("writing");
        self.recipe.add_files(&mut completed, None, &mut output)?;
        let shortfall = completed.shortfall();
        output.finish_run(shortfall.as_ref().map_or(0, super::exit_code))?;
        drop(progress);

        if !self.run.quiet {
            completed.warnings[told..].iter().for_each(terminal::warning);
            terminal::print(&(completed.summary() + &summary::files(&output)))?;
        }
        shortfall.map_or(Ok(()), Err)
    }
}
