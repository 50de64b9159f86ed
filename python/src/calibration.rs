//! Calibrations of pairs.

use std::path::{Path, PathBuf};

use hsad::{
    calibration::StereoCalibration,
    image::Size,
    io::{
        self,
        calibration::{Hints, Loaded, read},
    },
};
use pyo3::{import_exception, prelude::*};

use crate::errors::Raise;

import_exception!(hsad._errors, ParameterError);

/// The geometry of a pair of cameras: of rectified pictures, for depth, or of pictures as they were taken, for :func:`rectify`.
///
/// Parameters
/// ----------
/// focal : float
///     Focal length, in pixels.
/// baseline : float
///     Distance between the cameras, in metres.
/// cx, cy : float
///     Principal point of the left picture, in pixels.
/// doffs : float
///     Difference of the principal points, cx1 - cx0, in pixels.
///
/// Attributes
/// ----------
/// is_rectified : bool
///     Whether the geometry of rectified pictures is known; otherwise the numbers above raise ParameterError.
/// notes : list of str
///     What was assumed of a file.
///
/// Examples
/// --------
/// >>> hsad.Calibration(1000.0, 0.2, cx=320.0, cy=240.0).focal
/// 1000.0
#[pyclass(module = "hsad", frozen)]
pub struct Calibration {
    rectified: Option<io::Calibration>,
    stereo: StereoCalibration,
    #[pyo3(get)]
    notes: Vec<String>,
}

impl Calibration {
    pub fn of_rectified(calibration: io::Calibration) -> PyResult<Self> {
        let stereo = StereoCalibration::from_rectified(&calibration).raise()?;
        Ok(Self { rectified: Some(calibration), stereo, notes: Vec::new() })
    }

    /// The geometry of rectified pictures.
    pub fn rectified(&self) -> PyResult<&io::Calibration> {
        self.rectified.as_ref().ok_or_else(|| {
            ParameterError::new_err(
                "the calibration is of pictures as they were taken: rectify the pair by it first, the result has the calibration of \
                 the rectified pair",
            )
        })
    }

    /// The cameras as they stood.
    pub fn stereo(&self) -> &StereoCalibration {
        &self.stereo
    }
}

#[pymethods]
impl Calibration {
    #[new]
    #[pyo3(signature = (focal, baseline, *, cx, cy, doffs = 0.0))]
    fn new(focal: f64, baseline: f64, cx: f64, cy: f64, doffs: f64) -> PyResult<Self> {
        let calibration = io::Calibration { focal, baseline, doffs, cx, cy, size: None };
        calibration.validate().raise()?;
        Self::of_rectified(calibration)
    }

    #[getter]
    fn is_rectified(&self) -> bool {
        self.rectified.is_some()
    }

    #[getter]
    fn focal(&self) -> PyResult<f64> {
        Ok(self.rectified()?.focal)
    }

    #[getter]
    fn baseline(&self) -> PyResult<f64> {
        Ok(self.rectified()?.baseline)
    }

    #[getter]
    fn doffs(&self) -> PyResult<f64> {
        Ok(self.rectified()?.doffs)
    }

    #[getter]
    fn cx(&self) -> PyResult<f64> {
        Ok(self.rectified()?.cx)
    }

    #[getter]
    fn cy(&self) -> PyResult<f64> {
        Ok(self.rectified()?.cy)
    }

    fn __repr__(&self) -> String {
        self.rectified.as_ref().map_or_else(
            || "<hsad.Calibration of pictures as they were taken>".into(),
            |own| {
                format!(
                    "<hsad.Calibration: focal {} px, baseline {} m, doffs {} px>",
                    own.focal, own.baseline, own.doffs
                )
            },
        )
    }
}

/// Reads the calibration of a pair: Middlebury, OpenCV, ROS, Kalibr, KITTI, EuRoC, COLMAP, K.txt or hsad's JSON.
///
/// Parameters
/// ----------
/// *paths : path
///     One file, or one per camera, left first.
/// unit : float, optional
///     Unit of length of the files, in metres: 0.001 for millimetres; that of the format by default.
/// size : tuple of int, optional
///     Width and height of the pictures, in pixels; files that describe pictures before and after rectification tell these by it.
/// pictures : tuple of path, optional
///     Files of the left and the right picture; formats of many cameras or pictures are searched for them.
///
/// Returns
/// -------
/// Calibration
///
/// Raises
/// ------
/// OSError
///     A file that cannot be read.
/// FormatError
///     A file that has no calibration, or none of this pair.
#[pyfunction]
#[pyo3(signature = (*paths, unit = None, size = None, pictures = None))]
pub fn read_calibration(
    paths: Vec<PathBuf>,
    unit: Option<f64>,
    size: Option<(u32, u32)>,
    pictures: Option<(PathBuf, PathBuf)>,
) -> PyResult<Calibration> {
    if paths.is_empty() {
        return Err(ParameterError::new_err("no file was named: a calibration has one file, or one per camera"));
    }
    if let Some(unit) = unit.filter(|unit| !(1e-6..=1e6).contains(unit)) {
        return Err(ParameterError::new_err(format!("unit is {unit}, but it must be 10^-6 to 10^6 metres")));
    }
    let pictures = pictures.as_ref().map(|(left, right)| [Path::new(left), Path::new(right)]);
    let hints = Hints { pictures, sizes: size.map(|size| [Size::from(size); 2]), unit };
    let Loaded { stereo, rectified, notes } = read(&paths, &hints).raise()?;
    Ok(Calibration { rectified, stereo, notes })
}
