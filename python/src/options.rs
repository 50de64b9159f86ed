//! Keyword arguments as the library's options.

use hsad::{
    Options,
    options::{Choice, Kind},
};
use pyo3::{
    prelude::*,
    types::{PyDict, PyList},
};

use crate::errors::Raise;

/// The options among keyword arguments; None stands for an option that was not given.
pub fn given(arguments: Option<&Bound<'_, PyDict>>) -> PyResult<Options> {
    let mut options = Options::default();
    for (name, value) in arguments.into_iter().flatten() {
        let name: String = name.extract()?;
        if value.is_none() {
            Options::described(&name).raise()?;
            continue;
        }
        // NumPy's booleans, too.
        let text = match value.extract::<bool>() {
            Ok(flag) => flag.to_string(),
            Err(_) => value.str()?.to_string(),
        };
        options.set(&name, &text).raise()?;
    }
    Ok(options)
}

/// The options of :func:`match`, :class:`Matcher` and, as far as they are about interest points, :func:`features`: those of the
/// command, whose names have dashes in place of underscores.
///
/// Returns
/// -------
/// list of dict
///     ``name``, ``heading``, ``kind`` (``"flag"``, ``"whole"``, ``"number"`` or ``"choice"``), ``unit``, ``help`` and ``choices``
///     (the names of a choice, otherwise empty).
///
/// Examples
/// --------
/// >>> next(option for option in hsad.options() if option["name"] == "preset")["choices"]
/// ['fast', 'balanced', 'quality', 'paper']
#[pyfunction]
pub fn options(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let described = Options::ALL.iter().map(|option| {
        let entry = PyDict::new(py);
        let (kind, choices) = match option.kind() {
            Kind::Flag => ("flag", Vec::new()),
            Kind::Whole => ("whole", Vec::new()),
            Kind::Number => ("number", Vec::new()),
            Kind::Choice(choices) => ("choice", choices),
        };
        entry.set_item("name", option.name)?;
        entry.set_item("heading", option.group.heading())?;
        entry.set_item("kind", kind)?;
        entry.set_item("unit", option.unit)?;
        entry.set_item("help", option.help().replace('`', ""))?;
        entry.set_item("choices", choices.iter().map(|&Choice { name, .. }| name).collect::<Vec<_>>())?;
        Ok(entry)
    });
    PyList::new(py, described.collect::<PyResult<Vec<_>>>()?)
}
