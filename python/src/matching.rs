//! One pair: from two pictures to a disparity map.

use std::sync::Arc;

use hsad::{
    Backend, Config, DisparityRange,
    gpu::block_on,
    io::load::{LoadedPair, RawPicture},
    pipeline::{self, Judgement, Matched, Outcome, RectifiedPair, Task, Way},
    report,
};
use numpy::{PyArray2, PyUntypedArrayMethods};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    arrays::{Array3, Frame, array_of, in_pixels, pixels_of},
    backend::{backend, begin_work},
    errors::Raise,
    options::given,
    report::python,
    scores::colors_of,
};

/// The result of :func:`match`.
///
/// Attributes
/// ----------
/// disparity : numpy.ndarray
///     float32 of shape (height, width), in pixels, NaN where there is none. A left pixel (x, y) with disparity d corresponds to the
///     right pixel (x - d, y); disparities may be negative, and 0 is a disparity.
/// confidence : numpy.ndarray
///     uint8 of shape (height, width): 16 to 255 where a disparity was measured, 1 to 15 where it was filled, 0 for none.
/// range : tuple of int
///     The smallest and the largest disparity that were searched, in pixels.
/// trust : float
///     Trust in the map, 0 to 1; a map below 0.5 is likely to be wrong in large parts.
/// warnings : list of str
///     Doubts about the map, one sentence each.
/// not_trusted : str or None
///     Why the map is likely to be wrong in large parts, or shows no depth; None for a map that is to be trusted, and with ``force=True``.
/// report : dict
///     Parameters, figures and seconds: what the command writes to ``report.json``.
#[pyclass(module = "hsad", frozen, get_all)]
pub struct Match {
    disparity: Py<PyArray2<f32>>,
    confidence: Py<PyArray2<u8>>,
    range: (i32, i32),
    trust: f32,
    warnings: Vec<String>,
    not_trusted: Option<String>,
    report: Py<PyAny>,
}

#[pymethods]
impl Match {
    /// The map in false colours, blue far and red near, black for none: uint8 of shape (height, width, 3).
    fn colors<'py>(&self, py: Python<'py>) -> PyResult<Array3<'py, u8>> {
        pixels_of(py, colors_of(self.disparity.bind(py), None)?)
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let shape = self.disparity.bind(py).shape();
        format!(
            "<hsad.Match of {}x{} pixels, {} to {} px searched, trust {:.2}>",
            shape[1], shape[0], self.range.0, self.range.1, self.trust
        )
    }
}

impl Match {
    fn new(
        py: Python<'_>,
        config: &Config,
        outcome: Outcome,
        judgement: Judgement,
        of_device: &Backend,
    ) -> PyResult<Self> {
        let DisparityRange { min, .. } = outcome.range;
        // Here options are keywords, spelled as they are.
        let warnings: Vec<String> = judgement.warnings.iter().map(|warning| warning.replace('`', "")).collect();
        let mut figures = report::outcome(config, &outcome);
        figures.insert("device".into(), report::device(of_device));
        figures.insert("warnings".into(), warnings.clone().into());
        figures.insert("not_trusted".into(), judgement.not_trusted.clone().into());
        Ok(Self {
            disparity: array_of(py, outcome.dense.disparity.map(|&disparity| in_pixels(disparity)))?.unbind(),
            range: (min, outcome.range.last()),
            trust: outcome.trust,
            warnings,
            not_trusted: judgement.not_trusted,
            report: python(py, &figures.into())?.unbind(),
            confidence: array_of(py, outcome.dense.confidence)?.unbind(),
        })
    }
}

/// Matches a pair: a disparity for every pixel of the left picture.
///
/// The disparity range is found from the pictures unless ``disparities`` is given. Rows that are slightly off are aligned; a pair that
/// needs more is refused, and :func:`rectify` brings its rows to correspond.
///
/// Parameters
/// ----------
/// left, right : array_like
///     Pictures of one size, (height, width) or (height, width, channels) with grey, grey and alpha, RGB or RGBA, of any strides:
///     uint8; uint16 and floats, of which both views are stretched alike to 8 bits. Alpha 0 and samples that are not finite stand for
///     'not seen'. Tensors are taken by DLPack from memory of the CPU. OpenCV's pictures are BGR: ``picture[..., ::-1]``.
/// device : str
///     ``"best"``, ``"cpu"``, or an index, a part of a name or a place in :func:`devices`.
/// **options
///     Options of the command with underscores, such as ``preset="quality"``, ``min_disparity=-8``, ``disparities=128``,
///     ``no_fill=True``: :func:`options` describes all of them.
///
/// Returns
/// -------
/// Match
///     Disparities, confidences, range, trust and report.
///
/// Raises
/// ------
/// ParameterError
///     Views of different sizes, or an option that does not exist, lies outside its range or excludes another one.
/// NotRectifiedError
///     Rows do not correspond, unless ``force=True``.
/// NoRangeError
///     No disparity range was found, and none was given.
/// DeviceError
///     A device that is not there, cannot run this, was lost or ran out of memory.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> left = np.random.default_rng(1).integers(0, 256, (60, 90), dtype=np.uint8)
/// >>> right = np.roll(left, -7, axis=1)
/// >>> found = hsad.match(left, right, device="cpu", disparities=16, force=True)
/// >>> found.disparity.shape, found.disparity.dtype, float(np.nanmedian(found.disparity))
/// ((60, 90), dtype('float32'), 7.0)
#[pyfunction]
#[pyo3(name = "match", signature = (left, right, *, device = "best", **options))]
pub fn match_pair(
    py: Python<'_>,
    left: &Bound<'_, PyAny>,
    right: &Bound<'_, PyAny>,
    device: &str,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Match> {
    let config = given(options)?.config().raise()?;
    let [left, right] = pair(left, right)?;
    let backend = backend(py, device)?;
    let matched = py.detach(|| {
        let LoadedPair { left, right, .. } = LoadedPair::from_raw(left, right)?;
        Task {
            backend: &backend,
            views: (&left, &right),
            config: &config,
            way: &Way::AsIs,
            calibration: None,
            precedent: None,
            begin: &|_| (),
            progress: &|_| (),
        }
        .run()
    });
    let Matched { outcome, judgement, .. } = matched.raise()?;
    Match::new(py, &config, outcome, judgement, &backend)
}

/// Copies of both views.
pub fn pair(left: &Bound<'_, PyAny>, right: &Bound<'_, PyAny>) -> PyResult<[RawPicture; 2]> {
    Ok([Frame::new(left, "the left view")?.raw()?, Frame::new(right, "the right view")?.raw()?])
}

/// Matches a rectified pair.
pub fn match_rectified(
    py: Python<'_>,
    pair: &RectifiedPair,
    backend: &Arc<Backend>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Match> {
    let config = given(options)?.config().raise()?;
    begin_work()?;
    let outcome = py.detach(|| block_on(pipeline::run_rectified(backend, pair, &config, |_| (), |_| ()))).raise()?;
    let judgement = Judgement::of_rectified(&outcome, pair, &config, None);
    Match::new(py, &config, outcome, judgement, backend)
}
