//! Options for depth, and what they tell of the cameras.

use std::path::{Path, PathBuf};

use clap::Args;
use hsad::{
    Error, Result,
    image::Size,
    io::{
        Calibration,
        calibration::{self, Hints, Loaded},
        recording::RecordedCalibration,
    },
};

use super::wording::in_options;

/// Calibration files of a pair.
#[derive(Args, Clone, Debug)]
pub struct CalibrationOptions {
    /// Calibration file of the pair: Middlebury, OpenCV, ROS, Kalibr, KITTI, EuRoC, COLMAP, K.txt or hsad's JSON, see
    /// docs/calibration.md; twice for formats with a file per camera, left first
    #[arg(long, value_name = "FILE")]
    calib: Vec<PathBuf>,
    /// Unit of length of the calibration files, in metres: 0.001 for millimetres [default: that of the format]
    #[arg(long, value_name = "METRES", requires = "calib", allow_negative_numbers = true)]
    calib_unit: Option<f64>,
}

impl CalibrationOptions {
    /// The calibration of `pictures` of these sizes in pixels; `None` without files.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Format`] for a file that cannot be read, [`Error::Parameter`] for a unit outside its range.
    pub fn read(&self, pictures: [&Path; 2], sizes: [Size; 2]) -> Result<Option<CalibrationFile>> {
        let Some(path) = self.calib.first() else { return Ok(None) };
        let loaded = calibration::read(&self.calib, &self.hints(pictures, sizes)?)?;
        Ok(Some(CalibrationFile { path: path.clone(), loaded }))
    }

    /// As [`Self::read`], from the text of one file.
    fn parse(&self, file: (&Path, &str), pictures: [&Path; 2], sizes: [Size; 2]) -> Result<CalibrationFile> {
        let loaded = calibration::parse(&[file], &self.hints(pictures, sizes)?)?;
        Ok(CalibrationFile { path: file.0.into(), loaded })
    }

    /// Checks the files before any picture is read.
    ///
    /// # Errors
    /// As [`Self::read`].
    fn check(&self) -> Result<()> {
        self.calib_unit.map_or(Ok(()), check_unit)?;
        if self.calib.is_empty() { Ok(()) } else { calibration::check(&self.calib, self.calib_unit) }
    }

    fn hints<'a>(&self, pictures: [&'a Path; 2], sizes: [Size; 2]) -> Result<Hints<'a>> {
        self.calib_unit.map_or(Ok(()), check_unit)?;
        Ok(Hints { pictures: Some(pictures), sizes: Some(sizes), unit: self.calib_unit })
    }
}

/// A calibration, and the file that is named where it does not fit.
pub struct CalibrationFile {
    path: PathBuf,
    pub loaded: Loaded,
}

impl CalibrationFile {
    /// Checks that the file is for pictures as they were taken of these sizes, left and right, in pixels.
    ///
    /// # Errors
    /// [`Error::Format`] if it is not.
    pub fn check_taken(&self, sizes: [Size; 2]) -> Result<()> {
        self.loaded.stereo.check_sizes(sizes).map_err(|error| self.misfit(&error))
    }

    /// The error of a calibration that does not fit the pictures, with the file.
    pub fn misfit(&self, error: &Error) -> Error {
        Error::Format { path: self.path.clone(), reason: in_options(error) }
    }
}

/// Geometry that turns disparities into depth.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Depth")]
pub struct DepthOptions {
    #[command(flatten)]
    files: CalibrationOptions,
    /// Focal length in pixels, 10^-6 to 10^6
    #[arg(long, value_name = "PX", requires = "baseline", conflicts_with = "calib", allow_negative_numbers = true)]
    focal: Option<f64>,
    /// Baseline, the distance between the cameras, in metres, 10^-6 to 10^6
    #[arg(long, value_name = "METRES", requires = "focal", conflicts_with = "calib", allow_negative_numbers = true)]
    baseline: Option<f64>,
    /// Difference of the principal points, cx1 - cx0, in pixels, -10^6 to 10^6 [default: 0]
    #[arg(long, value_name = "PX", requires = "focal", conflicts_with = "calib", allow_negative_numbers = true)]
    doffs: Option<f64>,
}

/// What is known of the cameras of a pair besides the options.
#[derive(Clone, Copy)]
pub enum Known<'a> {
    Nothing,
    /// A calibration file of the pair and its text, which takes the place of those that the options name.
    File(&'a Path, &'a str),
    /// The calibration of a recording, unless the options have one.
    Recorded(&'a RecordedCalibration),
}

/// What is known of the cameras of a pair.
pub enum Cameras {
    Unknown,
    /// The geometry of the pictures, if they are rectified.
    Rectified(Calibration),
    /// Files, of pictures as they were taken or of rectified ones, or both.
    Files(Box<CalibrationFile>),
}

impl DepthOptions {
    /// The calibration files.
    pub fn files_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        self.files.calib.iter_mut()
    }

    /// Checks the calibration files before any picture is read, and returns whether there are any.
    ///
    /// # Errors
    /// As [`CalibrationOptions::read`].
    pub fn check_files(&self) -> Result<bool> {
        self.files.check().map(|()| !self.files.calib.is_empty())
    }

    /// Whether options tell anything of the cameras.
    pub fn are_given(&self) -> bool {
        !self.files.calib.is_empty() || self.focal.is_some()
    }

    /// What is known of the cameras of `pictures` of these sizes in pixels.
    ///
    /// # Errors
    /// As [`CalibrationOptions::read`]; [`Error::Parameter`] for values outside their range; [`Error::Format`] for a recorded calibration of
    /// pictures of other sizes.
    pub fn cameras(&self, pictures: [&Path; 2], sizes: [Size; 2], known: Known<'_>) -> Result<Cameras> {
        let file = match known {
            Known::File(path, text) => Some(self.files.parse((path, text), pictures, sizes)?),
            _ => self.files.read(pictures, sizes)?,
        };
        if let Some(file) = file {
            return Ok(Cameras::Files(file.into()));
        }
        if let Some((focal, baseline)) = self.focal.zip(self.baseline) {
            return Ok(Cameras::Rectified(Calibration::centred(focal, baseline, self.doffs.unwrap_or(0.0), sizes[0])?));
        }
        let Known::Recorded(RecordedCalibration { loaded, is_rectified, path }) = known else {
            return Ok(Cameras::Unknown);
        };
        let file = CalibrationFile { path: path.clone(), loaded: loaded.clone() };
        if !is_rectified {
            return Ok(Cameras::Files(file.into()));
        }
        file.loaded.for_rectified(sizes[0]).map(Cameras::Rectified).map_err(|error| file.misfit(&error))
    }
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
