//! Files: pictures, disparity maps and point clouds. Files appear whole or not at all.

use std::path::PathBuf;

use hsad::{
    Picture,
    image::Plane,
    io::{
        atomic::write_whole,
        disparities as disparity_files,
        disparity_png::{self, Encoding},
        load::{self, LoadedPair, Unseen},
        pfm,
        ply::{self, Point},
        png,
    },
};
use pyo3::{import_exception, prelude::*};

use crate::{
    arrays::{Array2, Array3, Frame, array_of, disparities, in_pixels, picture_array, plane, triples},
    errors::Raise,
    geometry::cloud,
};

import_exception!(hsad._errors, ParameterError);

/// Reads a picture file: PNG, JPEG, PNM, PFM, BMP, TIFF or WebP, of 8 bits, 16 bits or floats.
///
/// Returns
/// -------
/// numpy.ndarray
///     uint8 of shape (height, width, 4): RGB, and alpha 0 where nothing was seen. Deep samples are stretched to 8 bits:
///     :func:`read_pair` does so alike for both views.
///
/// Raises
/// ------
/// OSError
///     The file cannot be read.
/// FormatError
///     It is no picture, is damaged, or shows nothing.
#[pyfunction]
pub fn read_image<'py>(py: Python<'py>, path: PathBuf) -> PyResult<Array3<'py, u8>> {
    let (picture, doubt) = py.detach(|| load::load_with_doubt(&path)).raise()?;
    if let Some(doubt) = doubt {
        py.import("warnings")?.call_method1("warn", (doubt,))?;
    }
    picture_array(py, &picture)
}

/// Reads the views of one pair, deep samples stretched to 8 bits alike.
///
/// Parameters
/// ----------
/// left, right : path
///     Picture files, as for :func:`read_image`.
/// masks : tuple of path or None, optional
///     Pictures that are 0 where the left and the right view were not seen.
/// nodata : float, optional
///     Value of pixels that were not seen, in the unit of the files.
///
/// Returns
/// -------
/// tuple of numpy.ndarray
///     Both pictures, as from :func:`read_image`.
///
/// Raises
/// ------
/// OSError, FormatError
///     As for :func:`read_image`; also masks of another size.
#[pyfunction]
#[pyo3(signature = (left, right, *, masks = None, nodata = None))]
pub fn read_pair<'py>(
    py: Python<'py>,
    left: PathBuf,
    right: PathBuf,
    masks: Option<(Option<PathBuf>, Option<PathBuf>)>,
    nodata: Option<f32>,
) -> PyResult<(Array3<'py, u8>, Array3<'py, u8>)> {
    let unseen = Unseen { masks: masks.unwrap_or_default().into(), nodata };
    let LoadedPair { left, right, warnings, .. } = py.detach(|| load::load_pair(&left, &right, &unseen)).raise()?;
    for warning in warnings {
        py.import("warnings")?.call_method1("warn", (warning,))?;
    }
    Ok((picture_array(py, &left)?, picture_array(py, &right)?))
}

/// Writes a picture as PNG.
///
/// Parameters
/// ----------
/// path : path
/// picture : array_like
///     uint8 of shape (height, width), (height, width, 3) or (height, width, 4): grey, RGB or RGBA.
///
/// Raises
/// ------
/// OSError
///     The file cannot be written.
#[pyfunction]
pub fn write_png(path: PathBuf, picture: &Bound<'_, PyAny>) -> PyResult<()> {
    let frame = Frame::new(picture, "the picture")?;
    let Some(bytes) = frame.bytes() else {
        return Err(ParameterError::new_err("a PNG is written of uint8: convert the picture first"));
    };
    let size = frame.size;
    match frame.channels {
        1 => {
            let grey = Plane::new(size, bytes.to_vec()).raise()?;
            write_whole(&path, |out| png::write_grey8(out, &grey))
        }
        3 => {
            let rgb = Plane::new(size, bytes.as_chunks().0.to_vec()).raise()?;
            write_whole(&path, |out| png::write_rgb8(out, &rgb))
        }
        4 => {
            let rgba = Picture::from_rgba8(size, bytes).raise()?;
            write_whole(&path, |out| png::write_rgba8(out, &rgba))
        }
        channels => {
            return Err(ParameterError::new_err(format!("a picture of {channels} channels: a PNG has 1, 3 or 4")));
        }
    }
    .raise()
}

/// Reads a disparity map from a PFM or from a 16-bit PNG of KITTI's kind; the content tells which.
///
/// Returns
/// -------
/// numpy.ndarray
///     float32 of shape (height, width), in pixels, NaN where there is none.
///
/// Raises
/// ------
/// OSError
///     The file cannot be read.
/// FormatError
///     It is neither, or is damaged.
#[pyfunction]
pub fn read_disparity<'py>(py: Python<'py>, path: PathBuf) -> PyResult<Array2<'py, f32>> {
    array_of(py, nan_for_none(disparity_files::read(&path).raise()?))
}

/// Reads a PFM of one channel: float32 of shape (height, width), NaN where a value is unknown.
///
/// Raises
/// ------
/// OSError, FormatError
///     As for :func:`read_disparity`.
#[pyfunction]
pub fn read_pfm<'py>(py: Python<'py>, path: PathBuf) -> PyResult<Array2<'py, f32>> {
    array_of(py, nan_for_none(pfm::read(&path).raise()?))
}

fn nan_for_none(plane: Plane<f32>) -> Plane<f32> {
    plane.map(|&value| if value.is_finite() { value } else { f32::NAN })
}

/// Writes floats of shape (height, width) as PFM; what is not finite becomes +inf, Middlebury's 'unknown'.
///
/// Raises
/// ------
/// OSError
///     The file cannot be written.
#[pyfunction]
pub fn write_pfm(path: PathBuf, values: &Bound<'_, PyAny>) -> PyResult<()> {
    let values = plane(values, "the map")?.map(|&value| if value.is_finite() { value } else { f32::INFINITY });
    write_whole(&path, |out| pfm::write(out, &values)).raise()
}

/// Reads disparities from a 16-bit PNG of KITTI's kind, 256 times the pixels, 0 for none.
///
/// Returns
/// -------
/// numpy.ndarray
///     float32 of shape (height, width), in pixels, NaN where there is none.
///
/// Raises
/// ------
/// OSError, FormatError
///     As for :func:`read_disparity`.
#[pyfunction]
pub fn read_kitti<'py>(py: Python<'py>, path: PathBuf) -> PyResult<Array2<'py, f32>> {
    array_of(py, disparity_png::read(&path).raise()?.map(|&disparity| in_pixels(disparity)))
}

/// Writes disparities in pixels, of shape (height, width), as a 16-bit PNG of KITTI's kind, rounded to 1/256 px.
///
/// Returns
/// -------
/// bool
///     Whether any reader of KITTI's files reads it. Disparities below 0 or from 256 px on are held by an offset, and in larger
///     steps where they span more than 254 px, which the file says in a text that :func:`read_kitti` follows; a warning tells.
///     In KITTI's own encoding a disparity of exactly 0 becomes 1/256 px.
///
/// Raises
/// ------
/// OSError
///     The file cannot be written.
#[pyfunction]
pub fn write_kitti(py: Python<'_>, path: PathBuf, disparity: &Bound<'_, PyAny>) -> PyResult<bool> {
    let map = disparities(disparity, "disparity")?;
    write_whole(&path, |out| disparity_png::write(out, &map)).raise()?;
    let encoding = Encoding::of(&map);
    let is_kittis = encoding == Encoding::KITTI;
    if !is_kittis {
        let warning = format!(
            "disparities lie outside the 0 to 255.996 px of a 16-bit PNG: in {} a disparity is its value times {} px, plus {} px",
            path.display(),
            encoding.px_per_value(),
            encoding.offset
        );
        py.import("warnings")?.call_method1("warn", (warning,))?;
    }
    Ok(is_kittis)
}

/// Reads the points of a PLY file.
///
/// Returns
/// -------
/// tuple of numpy.ndarray
///     Points, float32 of shape (n, 3), and colours, uint8 of shape (n, 3), white where the file has none.
///
/// Raises
/// ------
/// OSError, FormatError
///     As for :func:`read_disparity`.
#[pyfunction]
pub fn read_ply<'py>(py: Python<'py>, path: PathBuf) -> PyResult<(Array2<'py, f32>, Array2<'py, u8>)> {
    cloud(py, &ply::read(&path).raise()?)
}

/// Writes coloured points as a binary PLY.
///
/// Parameters
/// ----------
/// path : path
/// points : array_like
///     Floats of shape (n, 3).
/// colors : array_like, optional
///     uint8 of shape (n, 3), RGB; white by default.
///
/// Raises
/// ------
/// ParameterError
///     Other shapes, or other numbers of points and colours.
/// OSError
///     The file cannot be written.
#[pyfunction]
#[pyo3(signature = (path, points, colors = None))]
pub fn write_ply(path: PathBuf, points: &Bound<'_, PyAny>, colors: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    let positions = triples::<f32>(points, "points")?;
    let colors = match colors {
        Some(colors) => triples::<u8>(colors, "colors")?,
        None => vec![[255; 3]; positions.len()],
    };
    if colors.len() != positions.len() {
        let (colors, points) = (colors.len(), positions.len());
        return Err(ParameterError::new_err(format!("there are {points} points, but {colors} colors")));
    }
    let points: Vec<Point> =
        positions.into_iter().zip(colors).map(|(position, color)| Point { position, color }).collect();
    write_whole(&path, |out| ply::write(out, &points)).raise()
}
