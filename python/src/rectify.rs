//! Rectification of pairs.

use std::sync::Arc;

use hsad::{
    Backend,
    io::load::LoadedPair,
    pipeline::{self, RectifiedPair},
    report,
};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    arrays::{Array2, Array3, array_of, picture_array},
    backend::backend,
    calibration::Calibration,
    errors::Raise,
    matching::{Match, match_rectified, pair},
    report::python,
};

/// A pair whose rows were brought to correspond: the result of :func:`rectify`.
///
/// Attributes
/// ----------
/// left, right : numpy.ndarray
///     uint8 of shape (height, width, 4): RGB, and alpha 0 where a picture shows nothing of its view.
/// left_mask, right_mask : numpy.ndarray
///     uint8 of shape (height, width): 255 where a picture shows its view, otherwise 0.
/// calibration : Calibration or None
///     The geometry of the rectified pair; None without a calibration.
/// report : dict
///     What was done, with matrices: what the command writes to ``rectification.json``.
#[pyclass(module = "hsad", frozen)]
pub struct Rectified {
    pair: RectifiedPair,
    backend: Arc<Backend>,
}

#[pymethods]
impl Rectified {
    #[getter]
    fn left<'py>(&self, py: Python<'py>) -> PyResult<Array3<'py, u8>> {
        picture_array(py, &self.pair.pictures[0])
    }

    #[getter]
    fn right<'py>(&self, py: Python<'py>) -> PyResult<Array3<'py, u8>> {
        picture_array(py, &self.pair.pictures[1])
    }

    #[getter]
    fn left_mask<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, u8>> {
        let [left, _] = self.pair.masks();
        array_of(py, left)
    }

    #[getter]
    fn right_mask<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, u8>> {
        let [_, right] = self.pair.masks();
        array_of(py, right)
    }

    #[getter]
    fn calibration(&self) -> PyResult<Option<Calibration>> {
        self.pair.rectification.calibration().copied().map(Calibration::of_rectified).transpose()
    }

    #[getter]
    fn report(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        Ok(python(py, &report::rectified(&self.pair))?.unbind())
    }

    /// Matches the pair, on the device that rectified it; where rows are still slightly off, the right view is resampled anew from the
    /// picture as it was taken.
    ///
    /// Parameters
    /// ----------
    /// **options
    ///     As for :func:`match`.
    ///
    /// Returns
    /// -------
    /// Match
    ///     The map of the rectified left picture.
    #[pyo3(name = "match", signature = (**options))]
    fn match_pair(&self, py: Python<'_>, options: Option<&Bound<'_, PyDict>>) -> PyResult<Match> {
        match_rectified(py, &self.pair, &self.backend, options)
    }
}

/// Rectifies a pair: brings its rows to correspond.
///
/// With a calibration of pictures as they were taken both views are turned by it. Without one everything is found from matching interest
/// points: views may be turned against each other, differ in size and scale, and have a distorted lens; disparities then have no known
/// baseline, and so no metres.
///
/// Parameters
/// ----------
/// left, right : array_like
///     As for :func:`match`; of any sizes without a calibration.
/// calibration : Calibration, optional
///     See :func:`read_calibration`.
/// device : str
///     As for :func:`match`.
///
/// Returns
/// -------
/// Rectified
///
/// Raises
/// ------
/// NotRectifiedError
///     No depth follows from the pair, or no warp brings its rows to correspond.
/// ParameterError
///     A calibration of pictures of other sizes.
#[pyfunction]
#[pyo3(signature = (left, right, calibration = None, *, device = "best"))]
pub fn rectify(
    py: Python<'_>,
    left: &Bound<'_, PyAny>,
    right: &Bound<'_, PyAny>,
    calibration: Option<&Calibration>,
    device: &str,
) -> PyResult<Rectified> {
    let [left, right] = pair(left, right)?;
    let backend = backend(py, device)?;
    let stereo = calibration.map(Calibration::stereo);
    let found = py.detach(|| {
        let LoadedPair { left, right, .. } = LoadedPair::from_raw(left, right)?;
        match stereo {
            Some(stereo) => pipeline::rectify_by(&backend, (&left, &right), stereo),
            None => pipeline::rectify(&backend, (&left, &right)),
        }
    });
    Ok(Rectified { pair: found.raise()?, backend })
}
