//! How the rows of a pair come to correspond: what `--rectify` and the calibration say.

use clap::ValueEnum;
use hsad::{Error, Result, image::Size, io::Calibration, pipeline::Way};

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

/// A way, the geometry of the pair if its pictures are rectified, and notes.
pub struct Resolved {
    pub way: Way,
    pub calibration: Option<Calibration>,
    pub notes: Vec<String>,
}

impl Resolved {
    /// The way of a pair with views of these sizes, in pixels.
    ///
    /// # Errors
    /// [`Error::Format`] for a calibration of other pictures; [`Error::Parameter`] if there is none and there must be one, or one that
    /// there must not be.
    pub fn new(rectify: Rectify, cameras: Cameras, sizes: [Size; 2]) -> Result<Self> {
        let file = match (rectify, cameras) {
            (Rectify::Calibrated, Cameras::Unknown | Cameras::Rectified(_)) => return Err(needs_files()),
            (Rectify::Uncalibrated, Cameras::Unknown) => return Ok(Self::plain(Way::Uncalibrated, None)),
            (Rectify::Uncalibrated, _) => return Err(needs_none()),
            (Rectify::Never, Cameras::Unknown) => return Ok(Self::plain(Way::AsIs, None)),
            (Rectify::Never, Cameras::Rectified(calibration)) => return Ok(Self::plain(Way::AsIs, Some(calibration))),
            (Rectify::Auto, Cameras::Unknown) => return Ok(Self::plain(Way::AsNeeded, None)),
            (Rectify::Auto, Cameras::Rectified(calibration)) => {
                return Ok(Self::plain(Way::AsNeeded, Some(calibration)));
            }
            (_, Cameras::Files(file)) => file,
        };
        let stereo = &file.loaded.stereo;
        let by_calibration = |way: Way, notes: &[String]| Self { way, calibration: None, notes: notes.to_vec() };
        if rectify == Rectify::Calibrated {
            file.check_taken(sizes)?;
            return Ok(by_calibration(Way::Calibrated(*stereo), &file.loaded.notes));
        }
        let as_rectified = file.for_rectified(sizes[0]);
        // A file of a rectified pair alone has the same cameras as `stereo`.
        let is_of_taken = stereo.rectified().is_none() && stereo.check_sizes(sizes).is_ok();
        if rectify == Rectify::Auto && is_of_taken && as_rectified.is_err() {
            return Ok(by_calibration(Way::Calibrated(*stereo), &file.loaded.notes));
        }
        let (calibration, notes) = as_rectified?;
        let way = match rectify {
            Rectify::Auto if is_of_taken => Way::Either(*stereo),
            Rectify::Auto => Way::AsNeeded,
            _ => Way::AsIs,
        };
        Ok(Self { way, calibration: Some(calibration), notes })
    }

    fn plain(way: Way, calibration: Option<Calibration>) -> Self {
        Self { way, calibration, notes: Vec::new() }
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
