//! Interest points and their matches.

use hsad::{
    Feature,
    features::{DESCRIPTOR_LENGTH, Detected, FeatureConfig},
    gpu::block_on,
    io::load::picture_of,
    matching::{self, MatchConfig},
};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    arrays::{Array1, Array2, Frame},
    backend::{backend, begin_work},
    errors::Raise,
    options::given,
};

/// The interest points of a picture, sorted by octave, layer, row and column.
///
/// Attributes
/// ----------
/// positions : numpy.ndarray
///     float32 of shape (n, 2): x and y of the centres, in pixels; pixel centres are whole numbers.
/// scales : numpy.ndarray
///     float32 of shape (n,), in pixels.
/// responses : numpy.ndarray
///     float32 of shape (n,): determinants of the Hessian.
/// orientations : numpy.ndarray
///     float32 of shape (n,), in radians, 0 unless ``oriented=True``.
/// dark : numpy.ndarray
///     bool of shape (n,): whether a point is a dark blob on light ground.
/// descriptors : numpy.ndarray
///     float32 of shape (n, 64), of unit length, or 0 where the surroundings are flat.
/// found : int
///     Number of points of the picture; more than n if only the strongest were kept.
#[pyclass(module = "hsad", frozen)]
pub struct Features(Detected);

impl Features {
    fn each<'py, T: numpy::Element>(&self, py: Python<'py>, f: impl Fn(&Feature) -> T) -> Array1<'py, T> {
        PyArray1::from_iter(py, self.0.features.iter().map(f))
    }
}

#[pymethods]
impl Features {
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, f32>> {
        let places: Vec<f32> = self.0.features.iter().flat_map(|point| [point.x, point.y]).collect();
        PyArray1::from_vec(py, places).reshape([self.0.features.len(), 2])
    }

    #[getter]
    fn scales<'py>(&self, py: Python<'py>) -> Array1<'py, f32> {
        self.each(py, |point| point.scale)
    }

    #[getter]
    fn responses<'py>(&self, py: Python<'py>) -> Array1<'py, f32> {
        self.each(py, |point| point.response)
    }

    #[getter]
    fn orientations<'py>(&self, py: Python<'py>) -> Array1<'py, f32> {
        self.each(py, |point| point.orientation)
    }

    #[getter]
    fn dark<'py>(&self, py: Python<'py>) -> Array1<'py, bool> {
        self.each(py, |point| point.dark)
    }

    #[getter]
    fn descriptors<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, f32>> {
        let values: Vec<f32> = self.0.features.iter().flat_map(|point| point.descriptor).collect();
        PyArray1::from_vec(py, values).reshape([self.0.features.len(), DESCRIPTOR_LENGTH])
    }

    #[getter]
    fn found(&self) -> usize {
        self.0.found
    }

    fn __len__(&self) -> usize {
        self.0.features.len()
    }

    fn __repr__(&self) -> String {
        format!("<hsad.Features: {} of {} interest points>", self.0.features.len(), self.0.found)
    }
}

/// Finds and describes the interest points of a picture.
///
/// Parameters
/// ----------
/// picture : array_like
///     As for :func:`match`.
/// device : str
///     As for :func:`match`.
/// **options
///     ``octaves``, ``step``, ``threshold``, ``oriented``, ``upright``, ``max_features``: see :func:`options`.
///
/// Returns
/// -------
/// Features
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> picture = np.zeros((64, 64), np.uint8)
/// >>> picture[30:35, 30:35] = 255
/// >>> found = hsad.features(picture, device="cpu")
/// >>> found.positions.shape[1], found.descriptors.shape[1], len(found) > 0
/// (2, 64, True)
#[pyfunction]
#[pyo3(signature = (picture, *, device = "best", **options))]
pub fn features(
    py: Python<'_>,
    picture: &Bound<'_, PyAny>,
    device: &str,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Features> {
    let config = given(options)?.features_over(FeatureConfig::default()).raise()?;
    config.validate().raise()?;
    let raw = Frame::new(picture, "the picture")?.raw()?;
    let backend = backend(py, device)?;
    let found = py.detach(|| block_on(backend.features(&picture_of(raw)?.luma(), &config)));
    Ok(Features(found.raise()?))
}

/// Matches interest points by their descriptors, the most confident match first.
///
/// Parameters
/// ----------
/// left, right : Features
///     Points of both views.
/// ratio : float
///     Largest ratio of the distances of the best and the second best descriptor, above 0, at most 1.
/// mutual : bool
///     Whether each of two points must be the nearest of the other.
/// same_contrast : bool
///     Whether dark blobs match dark ones only.
/// max_dy : float, optional
///     Largest row difference in pixels, for views whose rows correspond; any by default.
/// strongest : int, optional
///     Number of matches to keep.
///
/// Returns
/// -------
/// tuple of numpy.ndarray
///     Indices, int64 of shape (n, 2): left and right point; confidences, float32 of shape (n,), 0 to 1; distances, float32 of shape
///     (n,), 0 to 2.
///
/// Raises
/// ------
/// ParameterError
///     A parameter outside its range.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> picture = np.random.default_rng(1).integers(0, 256, (96, 96), dtype=np.uint8)
/// >>> points = hsad.features(picture, device="cpu")
/// >>> indices, confidences, distances = hsad.match_features(points, points)
/// >>> bool((indices[:, 0] == indices[:, 1]).all()), float(distances.max())
/// (True, 0.0)
#[pyfunction]
#[pyo3(signature = (left, right, *, ratio = None, mutual = true, same_contrast = true, max_dy = None, strongest = None))]
#[expect(clippy::too_many_arguments, reason = "keywords")]
pub fn match_features<'py>(
    py: Python<'py>,
    left: &Features,
    right: &Features,
    ratio: Option<f32>,
    mutual: bool,
    same_contrast: bool,
    max_dy: Option<f32>,
    strongest: Option<usize>,
) -> PyResult<(Array2<'py, i64>, Array1<'py, f32>, Array1<'py, f32>)> {
    let default = MatchConfig::default();
    let ratio = ratio.unwrap_or(default.ratio);
    let config = MatchConfig { ratio, mutual, same_contrast, max_dy, strongest, ..default };
    begin_work()?;
    let found = py.detach(|| matching::match_features(&left.0.features, &right.0.features, &config)).raise()?;
    let indices: Vec<i64> = found.iter().flat_map(|found| [found.left as i64, found.right as i64]).collect();
    Ok((
        PyArray1::from_vec(py, indices).reshape([found.len(), 2])?,
        PyArray1::from_iter(py, found.iter().map(|found| found.confidence)),
        PyArray1::from_iter(py, found.iter().map(|found| found.distance)),
    ))
}
