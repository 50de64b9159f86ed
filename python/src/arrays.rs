//! NumPy's arrays as the library's pictures and maps, and back.

use hsad::{
    DisparityMap, Picture,
    disparity::{fixed_point, pixels},
    image::{Plane, Size},
    io::load::{RawPicture, RawSamples},
};
use numpy::{
    Element, PyArray1, PyArray2, PyArray3, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn,
    PyUntypedArray, PyUntypedArrayMethods, get_array_module, ndarray::ArrayViewMut2,
};
use pyo3::{exceptions::PyTypeError, import_exception, prelude::*};

use crate::errors::Raise;

import_exception!(hsad._errors, ParameterError);

/// An array of one dimension.
pub type Array1<'py, T> = Bound<'py, PyArray1<T>>;
/// An array of two dimensions.
pub type Array2<'py, T> = Bound<'py, PyArray2<T>>;
/// An array of three dimensions.
pub type Array3<'py, T> = Bound<'py, PyArray3<T>>;

/// What `object` is as an array in memory of the CPU: itself, or a view of whatever speaks DLPack, such as a torch tensor.
fn array<'py>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyUntypedArray>> {
    if let Ok(array) = object.cast::<PyUntypedArray>() {
        return Ok(array.clone());
    }
    let way = if object.hasattr("__dlpack__")? { "from_dlpack" } else { "asarray" };
    let array = get_array_module(object.py())?.call_method1(way, (object,)).map_err(|error| {
        PyTypeError::new_err(format!(
            "{name} is no array that NumPy can read ({error}): hand over memory of the CPU, of a torch tensor tensor.detach().cpu()"
        ))
    })?;
    Ok(array.cast_into()?)
}

/// The array in one piece, row by row, as a type that is one of ours.
fn in_one_piece<'py, T: Element>(
    array: &Bound<'py, PyUntypedArray>,
    name: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let py = array.py();
    let whole = get_array_module(py)?.call_method1("ascontiguousarray", (array, T::get_dtype(py)))?;
    whole.cast::<PyArrayDyn<T>>()?.try_readonly().map_err(|error| {
        PyTypeError::new_err(format!("{name} is being written to by another call ({error}): give it another array"))
    })
}

/// A picture as it was handed over.
pub struct Frame<'py> {
    pub size: Size,
    pub channels: usize,
    samples: Samples<'py>,
}

enum Samples<'py> {
    Eight(PyReadonlyArrayDyn<'py, u8>),
    Sixteen(PyReadonlyArrayDyn<'py, u16>),
    Float(PyReadonlyArrayDyn<'py, f32>),
}

impl<'py> Frame<'py> {
    /// A picture of (height, width) or (height, width, channels), of any strides and byte order.
    ///
    /// # Errors
    /// `TypeError` for another type of samples, `ParameterError` for another shape.
    pub fn new(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let array = array(object, name)?;
        let dtype = array.dtype();
        let (kind, bytes) = (dtype.kind(), dtype.itemsize());
        if !matches!((kind, bytes), (b'u', 1 | 2) | (b'f', _)) {
            return Err(PyTypeError::new_err(format!(
                "{name} is an array of {dtype}, but pictures are uint8, uint16 or floats: convert it, as by .astype(numpy.float32)"
            )));
        }
        let (height, width, channels) = match *array.shape() {
            [height, width] => (height, width, 1),
            [height, width, channels @ 1..=4] => (height, width, channels),
            _ => {
                return Err(ParameterError::new_err(format!(
                    "{name} is an array of shape {:?}, but a picture has (height, width), grey, or (height, width, channels) with 1 to \
                     4 channels: grey, grey and alpha, RGB, RGBA",
                    array.shape()
                )));
            }
        };
        let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
        let samples = match (kind, bytes) {
            (b'u', 1) => Samples::Eight(in_one_piece(&array, name)?),
            (b'u', _) => Samples::Sixteen(in_one_piece(&array, name)?),
            _ => Samples::Float(in_one_piece(&array, name)?),
        };
        Ok(Self { size: Size::new(side(width), side(height)), channels, samples })
    }

    /// The samples of a picture of 8 bits, pixel by pixel and row by row; `None` for others.
    pub fn bytes(&self) -> Option<&[u8]> {
        match &self.samples {
            Samples::Eight(samples) => samples.as_slice().ok(),
            _ => None,
        }
    }

    /// The bytes of a grey picture of 8 bits; `None` for others.
    pub fn grey(&self) -> Option<&[u8]> {
        self.bytes().filter(|_| self.channels == 1)
    }

    /// A copy for the library.
    pub fn raw(&self) -> PyResult<RawPicture> {
        fn copy<T: Element + Copy>(samples: &PyReadonlyArrayDyn<'_, T>) -> PyResult<Vec<T>> {
            Ok(samples.as_slice()?.to_vec())
        }
        let samples = match &self.samples {
            Samples::Eight(samples) => RawSamples::Eight(copy(samples)?),
            Samples::Sixteen(samples) => RawSamples::Sixteen(copy(samples)?),
            Samples::Float(samples) => RawSamples::Float(copy(samples)?),
        };
        RawPicture::new(self.size, self.channels, samples).raise()
    }
}

/// A plane of floats of shape (height, width), from floats or integers of any strides.
pub fn plane(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Plane<f32>> {
    let array = array(object, name)?;
    let [height, width] = *array.shape() else {
        return Err(ParameterError::new_err(format!(
            "{name} is an array of shape {:?}, but it must be (height, width)",
            array.shape()
        )));
    };
    if !matches!(array.dtype().kind(), b'f' | b'i' | b'u') {
        return Err(PyTypeError::new_err(format!("{name} is an array of {}, but it must be of floats", array.dtype())));
    }
    let values = in_one_piece::<f32>(&array, name)?;
    Plane::new(Size::new(width as u32, height as u32), values.as_slice()?.to_vec()).raise()
}

/// A mask of shape (height, width): 255 where `object`, of booleans or integers, is not 0.
pub fn mask(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Plane<u8>> {
    let array = array(object, name)?;
    let [height, width] = *array.shape() else {
        return Err(ParameterError::new_err(format!(
            "{name} is an array of shape {:?}, but it must be (height, width)",
            array.shape()
        )));
    };
    let is_set = array.call_method1("__ne__", (0,))?.cast_into::<PyUntypedArray>()?;
    let values = in_one_piece::<bool>(&is_set, name)?;
    let bytes = values.as_slice()?.iter().map(|&is_set| if is_set { 255 } else { 0 }).collect();
    Plane::new(Size::new(width as u32, height as u32), bytes).raise()
}

/// Disparities in pixels as the library's fixed point; what is not finite is none.
pub fn disparities(object: &Bound<'_, PyAny>, name: &str) -> PyResult<DisparityMap> {
    Ok(plane(object, name)?.map(|&pixels| fixed_point(pixels)))
}

/// Rows of three numbers, of shape (n, 3).
pub fn triples<T: Element + Copy>(object: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<[T; 3]>> {
    let array = array(object, name)?;
    let [_, 3] = *array.shape() else {
        return Err(ParameterError::new_err(format!(
            "{name} is an array of shape {:?}, but it must be (n, 3)",
            array.shape()
        )));
    };
    Ok(in_one_piece::<T>(&array, name)?.as_slice()?.as_chunks().0.to_vec())
}

/// A disparity in pixels; NaN for none.
pub fn in_pixels(disparity: i32) -> f32 {
    pixels(disparity).unwrap_or(f32::NAN)
}

/// A plane as an array of shape (height, width).
pub fn array_of<'py, T: Element>(py: Python<'py>, plane: Plane<T>) -> PyResult<Array2<'py, T>> {
    let Size { width, height } = plane.size();
    PyArray1::from_vec(py, plane.into_data()).reshape([height as usize, width as usize])
}

/// Pixels of several channels as an array of shape (height, width, channels).
pub fn pixels_of<'py, const N: usize>(py: Python<'py>, plane: Plane<[u8; N]>) -> PyResult<Array3<'py, u8>> {
    let Size { width, height } = plane.size();
    PyArray1::from_vec(py, plane.into_data().into_flattened()).reshape([height as usize, width as usize, N])
}

/// A picture as an array of shape (height, width, 4): red, green, blue, and alpha, 0 where nothing was seen.
pub fn picture_array<'py>(py: Python<'py>, picture: &Picture) -> PyResult<Array3<'py, u8>> {
    pixels_of(py, picture.clone())
}

/// An array for an answer: the caller's, which must have this size and type and can have any strides, or a new one.
pub fn answer<'py, T: Element>(
    py: Python<'py>,
    given: Option<&Bound<'py, PyAny>>,
    size: Size,
    name: &str,
) -> PyResult<Array2<'py, T>> {
    let shape = [size.height as usize, size.width as usize];
    let Some(given) = given else { return Ok(PyArray2::zeros(py, shape, false)) };
    let fits = given.cast::<PyArray2<T>>().ok().filter(|array| array.shape() == shape);
    fits.cloned().ok_or_else(|| {
        let found = given.cast::<PyUntypedArray>().map_or_else(
            |_| "no NumPy array".into(),
            |array| format!("an array of {} of shape {:?}", array.dtype(), array.shape()),
        );
        ParameterError::new_err(format!(
            "{name} is {found}, but the answer is an array of {} of shape {shape:?}",
            T::get_dtype(py)
        ))
    })
}

/// Writes a plane to an array of the same size, each value by `f`.
pub fn write<T: Copy, U>(plane: &Plane<T>, mut to: ArrayViewMut2<'_, U>, f: impl Fn(T) -> U) {
    for (y, mut row) in (0..).zip(to.rows_mut()) {
        let values = plane.row(y).iter().map(|&value| f(value));
        // Slices are written many values at once.
        match row.as_slice_mut() {
            Some(row) => row.iter_mut().zip(values).for_each(|(to, value)| *to = value),
            None => row.iter_mut().zip(values).for_each(|(to, value)| *to = value),
        }
    }
}
