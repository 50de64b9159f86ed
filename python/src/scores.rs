//! Scores against the truth, and false colours.

use hsad::{
    disparity::fixed_point,
    eval::score_pixels,
    image::Plane,
    io::color::{self, disparity_colors, disparity_range},
    report,
};
use pyo3::{import_exception, prelude::*};

use crate::{
    arrays::{Array3, disparities, mask, pixels_of, plane},
    errors::Raise,
    report::python,
};

import_exception!(hsad._errors, ParameterError);

/// Scores a disparity map against the truth, by the measures of Middlebury and KITTI.
///
/// Parameters
/// ----------
/// disparity : array_like
///     Floats of shape (height, width), in pixels, not finite where there is no estimate.
/// truth : array_like
///     The same, not finite where the truth is unknown.
/// mask : array_like, optional
///     Of the same shape; only pixels that are not 0 count.
/// thresholds : sequence of float
///     Errors in pixels above which a pixel is wrong.
///
/// Returns
/// -------
/// dict
///     ``pixels``, ``estimated``, ``density``, ``bad`` (a list with ``above_px``, ``of_all``, ``of_estimated``), ``d1``,
///     ``average_error_px``, ``rms_error_px``, ``a50_px``, ``a90_px``, ``a99_px``: shares are 0 to 1, and what is undefined is None.
///
/// Raises
/// ------
/// ParameterError
///     Different sizes, or a threshold below 0.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> score = hsad.evaluate(np.array([[1.0, 5.0, np.nan]]), np.array([[1.5, 2.0, 3.0]]), thresholds=[1.0])
/// >>> round(score["density"], 2), score["bad"][0]["of_estimated"], score["average_error_px"]
/// (0.67, 0.5, 1.75)
#[pyfunction]
#[pyo3(signature = (disparity, truth, mask = None, *, thresholds = vec![0.5, 1.0, 2.0, 4.0]))]
pub fn evaluate(
    py: Python<'_>,
    disparity: &Bound<'_, PyAny>,
    truth: &Bound<'_, PyAny>,
    mask: Option<&Bound<'_, PyAny>>,
    thresholds: Vec<f32>,
) -> PyResult<Py<PyAny>> {
    let [map, truth] = [plane(disparity, "disparity")?, plane(truth, "truth")?];
    let mask = mask.map(|given| self::mask(given, "mask")).transpose()?;
    let score = py.detach(|| score_pixels(&map, &truth, mask.as_ref(), &thresholds)).raise()?;
    Ok(python(py, &report::score(&score))?.unbind())
}

/// A disparity map in false colours: blue far, red near, black for none.
///
/// Parameters
/// ----------
/// disparity : array_like
///     Floats of shape (height, width), in pixels, not finite where there is none.
/// range : tuple of float, optional
///     Disparities of the first and of the last colour, in pixels; by default those of the map but for 1 % at either end.
///
/// Returns
/// -------
/// numpy.ndarray
///     uint8 of shape (height, width, 3), RGB.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> hsad.colorize(np.array([[np.nan, 1.0, 9.0]])).shape
/// (1, 3, 3)
#[pyfunction]
#[pyo3(signature = (disparity, range = None))]
pub fn colorize<'py>(
    py: Python<'py>,
    disparity: &Bound<'py, PyAny>,
    range: Option<(f32, f32)>,
) -> PyResult<Array3<'py, u8>> {
    pixels_of(py, colors_of(disparity, range)?)
}

/// The colours of a map; `range` in pixels.
pub fn colors_of(disparity: &Bound<'_, PyAny>, range: Option<(f32, f32)>) -> PyResult<Plane<[u8; 3]>> {
    let map = disparities(disparity, "disparity")?;
    let range = range.map(|(far, near)| (fixed_point(far), fixed_point(near)));
    let range = range.or_else(|| disparity_range(&map)).unwrap_or((0, 0));
    Ok(disparity_colors(&map, range))
}

/// The errors of a disparity map in colours, from blue (up to 0.5 px) to red (above 4 px); white where there is no estimate, black where
/// the truth is unknown, and a third as bright outside the mask.
///
/// Parameters
/// ----------
/// disparity, truth, mask
///     As for :func:`evaluate`.
///
/// Returns
/// -------
/// numpy.ndarray
///     uint8 of shape (height, width, 3), RGB.
///
/// Raises
/// ------
/// ParameterError
///     Different sizes.
#[pyfunction]
#[pyo3(signature = (disparity, truth, mask = None))]
pub fn error_colors<'py>(
    py: Python<'py>,
    disparity: &Bound<'py, PyAny>,
    truth: &Bound<'py, PyAny>,
    mask: Option<&Bound<'py, PyAny>>,
) -> PyResult<Array3<'py, u8>> {
    let [map, truth] = [plane(disparity, "disparity")?, plane(truth, "truth")?];
    let mask = mask.map(|given| self::mask(given, "mask")).transpose()?;
    let sizes = [Some(truth.size()), mask.as_ref().map(Plane::size)];
    if let Some(other) = sizes.into_iter().flatten().find(|&size| size != map.size()) {
        let own = map.size();
        return Err(ParameterError::new_err(format!("the map is {own} pixels and what it is compared with {other}")));
    }
    pixels_of(py, color::error_colors(&map, &truth, mask.as_ref()))
}
