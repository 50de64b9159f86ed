//! Options for depth, and the calibration that they name.

use std::path::{Path, PathBuf};

use clap::Args;
use hsad::{
    Error, Result,
    image::Size,
    io::{
        Calibration,
        calibration::{self, Hints},
    },
};

/// Geometry that turns disparities into depth.
#[derive(Args)]
#[command(next_help_heading = "Depth")]
pub struct DepthOptions {
    /// Calibration file of the pair: Middlebury, OpenCV, ROS, Kalibr, KITTI, EuRoC, COLMAP, K.txt or hsad's JSON, see
    /// docs/calibration.md; twice for formats with a file per camera, left first
    #[arg(long, value_name = "FILE", conflicts_with_all = ["focal", "baseline", "doffs"])]
    calib: Vec<PathBuf>,
    /// Unit of length of the calibration files, in metres: 0.001 for millimetres [default: that of the format]
    #[arg(long, value_name = "METRES", requires = "calib", allow_negative_numbers = true)]
    calib_unit: Option<f64>,
    /// Focal length in pixels, 10^-6 to 10^6
    #[arg(long, value_name = "PX", requires = "baseline", allow_negative_numbers = true)]
    focal: Option<f64>,
    /// Baseline, the distance between the cameras, in metres, 10^-6 to 10^6
    #[arg(long, value_name = "METRES", requires = "focal", allow_negative_numbers = true)]
    baseline: Option<f64>,
    /// Difference of the principal points, cx1 - cx0, in pixels, -10^6 to 10^6 [default: 0]
    #[arg(long, value_name = "PX", requires = "focal", allow_negative_numbers = true)]
    doffs: Option<f64>,
}

impl DepthOptions {
    /// The calibration for the rectified `pictures` of `size` (width and height in pixels), and what was assumed of it; `None`
    /// without options for it.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Format`] for a file that cannot be read or belongs to pictures of another size,
    /// [`Error::Parameter`] for values outside their range.
    pub fn calibration(&self, pictures: [&Path; 2], size: Size) -> Result<Option<(Calibration, Vec<String>)>> {
        if let Some(path) = self.calib.first() {
            if let Some(unit) = self.calib_unit {
                check_unit(unit)?;
            }
            let hints = Hints { pictures: Some(pictures), sizes: Some([size; 2]), unit: self.calib_unit };
            let loaded = calibration::read(&self.calib, &hints)?;
            let misfit = |error: Error| Error::Format { path: path.clone(), reason: error.to_string() };
            let (calibration, mut notes) = (loaded.for_rectified(size).map_err(misfit)?, loaded.notes);
            notes.extend(unsized_misfit(&calibration, size));
            return Ok(Some((calibration, notes)));
        }
        let Some((focal, baseline)) = self.focal.zip(self.baseline) else { return Ok(None) };
        Ok(Some((Calibration::centred(focal, baseline, self.doffs.unwrap_or(0.0), size)?, Vec::new())))
    }
}

/// A warning if a calibration without a size seems to be for larger pictures.
fn unsized_misfit(&Calibration { cx, cy, size, .. }: &Calibration, pictures: Size) -> Option<String> {
    let is_inside = (0.0..f64::from(pictures.width)).contains(&cx) && (0.0..f64::from(pictures.height)).contains(&cy);
    (size.is_none() && !is_inside).then(|| {
        format!(
            "the principal point ({cx:.1}, {cy:.1}) lies outside the pictures of {pictures} pixels: the calibration seems to \
             be for other pictures"
        )
    })
}

fn check_unit(unit: f64) -> Result<()> {
    if (1e-6..=1e6).contains(&unit) {
        return Ok(());
    }
    Err(Error::Parameter {
        name: "--calib-unit",
        value: unit.to_string(),
        expected: "it must be 10^-6 to 10^6 metres".into(),
    })
}
