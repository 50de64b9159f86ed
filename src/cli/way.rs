//! How the rows of a pair come to correspond: what `--rectify` and the calibration say.

use clap::ValueEnum;
use hsad::{
    Error, Result,
    image::Size,
    pipeline::{Geometry, Way},
};

use super::depth::Cameras;

/// Whether a pair is rectified before it is matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Rectify {
    /// By the calibration, if it is of the pair as it was taken; otherwise where rows do not correspond and more than a small warp of
    /// the right view is needed, from matching interest points
    Auto,
    /// Never: a pair whose rows do not correspond is refused
    Never,
    /// By the calibration
    Calibrated,
    /// From matching interest points, without a calibration
    Uncalibrated,
}

impl Rectify {
    /// Checks that pairs can be brought to correspond so: whether any may have a calibration of the pair as it was taken, and whether the options
    /// have a calibration of all.
    ///
    /// # Errors
    /// [`Error::Parameter`] if none can.
    pub fn check_known(self, may_be_calibrated: bool, is_given: bool) -> Result<()> {
        match self {
            Self::Calibrated if !may_be_calibrated => Err(needs_files()),
            Self::Uncalibrated if is_given => Err(needs_none()),
            _ => Ok(()),
        }
    }

    /// The geometry of a pair with views of these sizes, in pixels.
    ///
    /// # Errors
    /// [`Error::Format`] for a calibration of other pictures; [`Error::Parameter`] if there is none and there must be one, or one that
    /// there must not be.
    pub fn geometry(self, cameras: Cameras, sizes: [Size; 2]) -> Result<Geometry> {
        let (file, calibration) = match cameras {
            Cameras::Unknown => (None, None),
            Cameras::Rectified(calibration) => (None, Some(calibration)),
            Cameras::Files(file) => (Some(file), None),
        };
        match (self, file, calibration) {
            (Self::Calibrated, None, _) => Err(needs_files()),
            (Self::Uncalibrated, None, None) => Ok(Geometry::new(Way::Uncalibrated, None)),
            (Self::Uncalibrated, ..) => Err(needs_none()),
            (Self::Never, None, calibration) => Ok(Geometry::new(Way::AsIs, calibration)),
            (Self::Auto, None, calibration) => Ok(Geometry::new(Way::AsNeeded, calibration)),
            (_, Some(file), _) => {
                let geometry = match self {
                    Self::Calibrated => Geometry::of_taken(&file.loaded, sizes),
                    Self::Never => Geometry::of_rectified(&file.loaded, sizes, Way::AsIs),
                    _ => Geometry::of_files(&file.loaded, sizes),
                };
                geometry.map_err(|error| file.misfit(&error))
            }
        }
    }
}

fn needs_none() -> Error {
    Error::Parameter {
        name: "--rectify",
        value: "uncalibrated".into(),
        expected: "a pair that is rectified from its matches has no depth: leave the calibration out, or rectify by it (calibrated)".into(),
    }
}

fn needs_files() -> Error {
    Error::Parameter {
        name: "--rectify",
        value: "calibrated".into(),
        expected: "it needs the calibration of the pair as it was taken: name it with --calib".into(),
    }
}
