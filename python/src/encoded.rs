//! One pair as `hsad match` matches it: from the bytes of two files to those of the maps.

use std::{path::Path, time::Instant};

use hsad::{
    Backend, Config, DisparityRange, Size,
    disparity::DisparityMap,
    image::Plane,
    io::{
        Calibration,
        calibration::{self, Hints},
        disparity_png,
        load::{LoadedPair, Stretch, Unseen, decode_both, decode_pair},
        png,
    },
    pipeline::{Geometry, Judgement, Matched, Outcome, RectifiedPair, Task, Way},
    report::{self, Value},
};
use pyo3::{
    import_exception,
    prelude::*,
    types::{PyBytes, PyDict},
};

use crate::{
    arrays::{Array2, array_of, in_pixels},
    backend::backend,
    errors::Raise,
    options::given,
    report::python,
};

import_exception!(hsad._errors, FormatError);

/// The result of :func:`match_encoded`.
///
/// Attributes
/// ----------
/// disparity_png : bytes
///     The map as a 16-bit PNG of KITTI's kind: the bytes of the command's ``disparity.png``.
/// confidence_png : bytes
///     Confidences as an 8-bit PNG: the bytes of ``confidence.png``.
/// disparity : numpy.ndarray
///     The map as in :class:`Match`: float32 of shape (height, width), in pixels, NaN where there is none.
/// confidence : numpy.ndarray
///     Confidences as in :class:`Match`: uint8 of shape (height, width).
/// range : tuple of int
///     The smallest and the largest disparity that were searched, in pixels.
/// trust : float
///     Trust in the map, 0 to 1.
/// report : dict
///     What the command writes to ``report.json``, but for files: with ``not_trusted``, the reason why the map is not to be trusted or
///     None, and ``warnings``.
#[pyclass(module = "hsad", frozen)]
pub struct Encoded {
    map: DisparityMap,
    confidence: Plane<u8>,
    range: DisparityRange,
    trust: f32,
    report: Value,
}

#[pymethods]
impl Encoded {
    #[getter]
    fn disparity_png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        encoded(py, |out| disparity_png::write(out, &self.map))
    }

    #[getter]
    fn confidence_png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        encoded(py, |out| png::write_grey8(out, &self.confidence))
    }

    #[getter]
    fn disparity<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, f32>> {
        array_of(py, self.map.map(|&disparity| in_pixels(disparity)))
    }

    #[getter]
    fn confidence<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py, u8>> {
        array_of(py, self.confidence.clone())
    }

    #[getter]
    fn range(&self) -> (i32, i32) {
        (self.range.min, self.range.last())
    }

    #[getter]
    fn trust(&self) -> f32 {
        self.trust
    }

    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python(py, &self.report)
    }

    fn __repr__(&self) -> String {
        let (size, range) = (self.map.size(), self.range);
        format!(
            "<hsad.Encoded of {size} pixels, {} to {} px searched, trust {:.2}>",
            range.min,
            range.last(),
            self.trust
        )
    }
}

fn encoded<'py>(
    py: Python<'py>,
    write: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()> + Send,
) -> PyResult<Bound<'py, PyBytes>> {
    let bytes = py.detach(|| {
        let mut bytes = Vec::new();
        write(&mut bytes).map(|()| bytes)
    });
    Ok(PyBytes::new(py, &bytes?))
}

/// Matches a pair as the command does, from the bytes of its files: decoded, rectified where its rows do not correspond, matched, encoded.
///
/// Parameters
/// ----------
/// left, right : bytes
///     The files of the views, as for :func:`read_image`; without `right`, an MPO or JPS with both.
/// names : tuple of str
///     What errors and the report call the views.
/// calibration : bytes, optional
///     A calibration file, as for :func:`read_calibration`: of rectified pictures, or of pictures as they were taken, which are rectified by
///     it.
/// depth : tuple of float, optional
///     Focal length (px), baseline (m) and difference of the principal points (px) of a rectified pair, in place of a file.
/// device : str
///     As for :func:`match`.
/// **options
///     As for :func:`match`.
///
/// Returns
/// -------
/// Encoded
///     Maps as PNG, range, trust and report. Disparities of a pair that was rectified first (``rectified`` in the report) are those of the
///     rectified pair.
///
/// Raises
/// ------
/// FormatError
///     Bytes of no picture, or a damaged one; a calibration that cannot be read or is of other pictures.
/// ParameterError, NotRectifiedError, NoRangeError, DeviceError
///     As for :func:`match`; NotRectifiedError for pairs that cannot be rectified.
#[pyfunction]
#[pyo3(signature = (left, right = None, *, names = ("left".into(), "right".into()), calibration = None, depth = None, device = "best", **options))]
#[expect(clippy::too_many_arguments, reason = "keywords")]
pub fn match_encoded(
    py: Python<'_>,
    left: &[u8],
    right: Option<&[u8]>,
    names: (String, String),
    calibration: Option<&[u8]>,
    depth: Option<(f64, f64, f64)>,
    device: &str,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Encoded> {
    let config = given(options)?.config().raise()?;
    let backend = backend(py, device)?;
    let names = [names.0, names.1];
    let found = py.detach(|| {
        let loaded = decoded([Some(left), right], names.each_ref().map(Path::new))?;
        let cameras = Cameras { file: calibration, of_rectified: depth };
        run(&backend, loaded, &names, &config, &cameras)
    });
    found.raise()
}

/// The views in the bytes of two files, or of one with both.
pub fn decoded([left, right]: [Option<&[u8]>; 2], names: [&Path; 2]) -> hsad::Result<LoadedPair> {
    let (left, unseen) = (left.unwrap_or_default(), Unseen::default());
    match right {
        Some(right) => decode_pair((left, names[0]), (right, names[1]), &unseen),
        None => decode_both(left, names[0], &unseen)?.ok_or_else(|| hsad::Error::Format {
            path: names[0].into(),
            reason: "it holds one view: give the right one, too".into(),
        }),
    }
}

/// What is told of the cameras.
struct Cameras<'a> {
    file: Option<&'a [u8]>,
    /// Focal length, baseline, difference of the principal points.
    of_rectified: Option<(f64, f64, f64)>,
}

impl Cameras<'_> {
    /// The geometry of a pair.
    fn geometry(&self, names: [&Path; 2], sizes: [Size; 2]) -> hsad::Result<Geometry> {
        let path = Path::new("the calibration");
        let told = |reason: String| hsad::Error::Format { path: path.into(), reason };
        if let Some(file) = self.file {
            let text = std::str::from_utf8(file).map_err(|_| told("it is no text in UTF-8".into()))?;
            let hints = Hints { pictures: Some(names), sizes: Some(sizes), unit: None };
            let loaded = calibration::parse(&[(path, text)], &hints)?;
            return Geometry::of_files(&loaded, sizes).map_err(|error| told(error.to_string()));
        }
        let calibration =
            self.of_rectified.map(|(focal, baseline, doffs)| Calibration::centred(focal, baseline, doffs, sizes[0]));
        Ok(Geometry::new(Way::AsNeeded, calibration.transpose()?))
    }
}

fn run(
    backend: &Backend,
    loaded: LoadedPair,
    names: &[String; 2],
    config: &Config,
    cameras: &Cameras<'_>,
) -> hsad::Result<Encoded> {
    let start = Instant::now();
    let LoadedPair { left, right, stretch, mut warnings } = loaded;
    let Geometry { way, calibration, notes } =
        cameras.geometry(names.each_ref().map(Path::new), [left.size(), right.size()])?;
    warnings.extend(notes);
    let matched = Task {
        backend,
        views: (&left, &right),
        config,
        way: &way,
        calibration,
        precedent: None,
        begin: &|_| (),
        progress: &|_| (),
    }
    .run()?;
    let Matched { outcome, rectified, judgement, .. } = matched;
    let found = Found { names, stretch, warnings, rectified, judgement, start };
    Ok(found.encoded(backend, config, outcome))
}

/// What is known of a pair besides its map.
struct Found<'a> {
    names: &'a [String; 2],
    stretch: Option<Stretch>,
    /// Doubts about the files.
    warnings: Vec<String>,
    rectified: Option<RectifiedPair>,
    judgement: Judgement,
    start: Instant,
}

impl Found<'_> {
    fn encoded(self, backend: &Backend, config: &Config, outcome: Outcome) -> Encoded {
        let Self { names, stretch, mut warnings, rectified, judgement, start } = self;
        let Judgement { calibration, warnings: doubts, not_trusted } = judgement;
        // Here options are keywords, spelled as they are.
        warnings.extend(doubts.iter().map(|doubt| doubt.replace('`', "")));
        let report = report::run(&report::Run {
            names: names.each_ref().map(String::as_str),
            size: outcome.dense.disparity.size(),
            stretch,
            backend,
            calibration: calibration.as_ref(),
            cloud: None,
            depth_png: None,
            rectified: rectified.as_ref(),
            mapped_back: false,
            no_depth: None,
            not_trusted: not_trusted.as_deref(),
            warnings: &warnings,
            config,
            outcome: &outcome,
            total: start.elapsed(),
        });
        let (range, trust) = (outcome.range, outcome.trust);
        Encoded { map: outcome.dense.disparity, confidence: outcome.dense.confidence, range, trust, report }
    }
}

/// The result of a pair whose tiles were put together.
pub fn of_tiles(
    backend: &Backend,
    pair: &LoadedPair,
    names: &[String; 2],
    config: &Config,
    (outcome, start): (Outcome, Instant),
) -> Encoded {
    let judgement = Judgement::of_taken(&outcome, (&pair.left, &pair.right), None, config, None);
    let (stretch, warnings) = (pair.stretch, pair.warnings.clone());
    let found = Found { names, stretch, warnings, rectified: None, judgement, start };
    found.encoded(backend, config, outcome)
}
