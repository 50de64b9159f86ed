//! Errors of the library as Python's exceptions: the class says what to catch, the sentence is the library's.

use hsad::Error;
use pyo3::{PyErr, exceptions::PyMemoryError, import_exception};

import_exception!(hsad._errors, DeviceError);
import_exception!(hsad._errors, DeviceLostError);
import_exception!(hsad._errors, FormatError);
import_exception!(hsad._errors, NoRangeError);
import_exception!(hsad._errors, NotRectifiedError);
import_exception!(hsad._errors, ParameterError);

/// The exception of an error.
pub fn raised(error: Error) -> PyErr {
    let sentence = error.to_string();
    match error {
        Error::SizesDiffer { .. }
        | Error::TooSmall { .. }
        | Error::Parameter { .. }
        | Error::TooManyFeatures { .. } => ParameterError::new_err(sentence),
        Error::Format { .. } => FormatError::new_err(sentence),
        Error::Io { source, .. } => std::io::Error::new(source.kind(), sentence).into(),
        Error::NotRectified { diagnosis } => NotRectifiedError::new_err(format!(
            "the pair is not rectified: {}; hsad.rectify rectifies pairs, or search along rows all the same with force=True",
            diagnosis.replace('`', "")
        )),
        Error::NotRectifiable { .. } => NotRectifiedError::new_err(sentence),
        Error::NoRange { reason } => NoRangeError::new_err(format!(
            "the disparity range could not be found: {reason}; name it with min_disparity and disparities"
        )),
        Error::DeviceLost(_) => DeviceLostError::new_err(sentence),
        Error::NotEnoughMemory { .. } => PyMemoryError::new_err(sentence),
        // The rest is of devices, also what a later version of the library adds.
        _ => DeviceError::new_err(sentence),
    }
}

/// The result with Python's exception.
pub trait Raise<T> {
    fn raise(self) -> pyo3::PyResult<T>;
}

impl<T> Raise<T> for hsad::Result<T> {
    fn raise(self) -> pyo3::PyResult<T> {
        self.map_err(raised)
    }
}
