//! Depth and points.

use hsad::io::{load::picture_of, ply};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::{
    arrays::{Array2, Frame, array_of, plane},
    calibration::Calibration,
    errors::Raise,
};

/// Depth along the optical axis from disparities: ``baseline * focal / (disparity + doffs)``.
///
/// Parameters
/// ----------
/// disparity : array_like
///     Floats of shape (height, width), in pixels, NaN where there is none.
/// calibration : Calibration
///     Of rectified pictures.
///
/// Returns
/// -------
/// numpy.ndarray
///     float32 of shape (height, width), in metres; NaN where there is no disparity, inf at infinity and beyond.
///
/// Raises
/// ------
/// ParameterError
///     A calibration of pictures as they were taken.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> calibration = hsad.Calibration(1000.0, 0.2, cx=1.0, cy=0.0)
/// >>> hsad.depth(np.array([[40.0, 0.0, np.nan]]), calibration)
/// array([[ 5., inf, nan]], dtype=float32)
#[pyfunction]
pub fn depth<'py>(
    py: Python<'py>,
    disparity: &Bound<'py, PyAny>,
    calibration: &Calibration,
) -> PyResult<Array2<'py, f32>> {
    let calibration = calibration.rectified()?;
    let depth = plane(disparity, "disparity")?.map(|&disparity| match disparity.is_finite() {
        true => calibration.depth(disparity.into()).map_or(f32::INFINITY, |depth| depth as f32),
        false => f32::NAN,
    });
    array_of(py, depth)
}

/// The points of a depth map in coordinates of its camera: x right, y down, z forward, in metres.
///
/// Parameters
/// ----------
/// depth : array_like
///     Floats of shape (height, width), in metres: see :func:`depth`. Pixels without a finite depth have no point.
/// picture : array_like
///     The picture of the depth map, as for :func:`match`: the points' colours.
/// calibration : Calibration
///     Of rectified pictures.
///
/// Returns
/// -------
/// tuple of numpy.ndarray
///     Points, float32 of shape (n, 3), in metres, and colours, uint8 of shape (n, 3), RGB.
///
/// Raises
/// ------
/// ParameterError
///     A picture of another size, or a calibration of pictures as they were taken.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> calibration = hsad.Calibration(8.0, 1.0, cx=0.0, cy=0.5)
/// >>> points, colors = hsad.points(np.array([[np.inf, 4.0]]), np.array([[[1, 2, 3], [4, 5, 6]]], np.uint8), calibration)
/// >>> points.tolist(), colors.tolist()
/// ([[0.5, -0.25, 4.0]], [[4, 5, 6]])
#[pyfunction]
pub fn points<'py>(
    py: Python<'py>,
    depth: &Bound<'py, PyAny>,
    picture: &Bound<'py, PyAny>,
    calibration: &Calibration,
) -> PyResult<(Array2<'py, f32>, Array2<'py, u8>)> {
    let depth = plane(depth, "depth")?;
    let picture = picture_of(Frame::new(picture, "the picture")?.raw()?).raise()?;
    cloud(py, &ply::of_depth(&depth, &picture, calibration.rectified()?).raise()?)
}

/// Points and colours as arrays of shape (n, 3).
pub fn cloud<'py>(py: Python<'py>, points: &[ply::Point]) -> PyResult<(Array2<'py, f32>, Array2<'py, u8>)> {
    let positions = points.iter().flat_map(|point| point.position).collect();
    let colors = points.iter().flat_map(|point| point.color).collect();
    let shape = [points.len(), 3];
    Ok((PyArray1::from_vec(py, positions).reshape(shape)?, PyArray1::from_vec(py, colors).reshape(shape)?))
}
