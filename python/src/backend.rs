//! Devices, each opened once per process.

use std::{
    collections::HashMap,
    process,
    sync::{Arc, Mutex, PoisonError},
};

use hsad::{
    Backend, DeviceChoice, Error,
    gpu::{self, cache_folder},
};
use pyo3::{import_exception, prelude::*};

use crate::errors::Raise;

import_exception!(hsad._errors, ForkError);

/// What this process, or the one it was forked from, has opened.
#[derive(Default)]
struct Opened {
    /// The process that began to work; `None` before.
    process: Option<u32>,
    backends: Option<HashMap<String, Arc<Backend>>>,
}

static OPENED: Mutex<Opened> = Mutex::new(Opened { process: None, backends: None });

/// Says that this process works with threads, of the driver or of the library, from now on; a process that was forked from one that
/// does has none of the threads and would wait for them for ever.
///
/// # Errors
/// `ForkError` in a process forked from one that works.
pub fn begin_work() -> PyResult<()> {
    let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    let here = process::id();
    if *opened.process.get_or_insert(here) == here {
        return Ok(());
    }
    Err(ForkError::new_err(
        "this process was forked after hsad had begun to work in its parent, and the threads of the device did not come along: start \
         processes with multiprocessing.get_context('spawn') (for torch's DataLoader: multiprocessing_context='spawn'), or use hsad \
         in the forked processes only",
    ))
}

/// The backend of a device by its name; for `best` the CPU takes over where there is no usable device, with a warning.
pub fn backend(py: Python<'_>, device: &str) -> PyResult<Arc<Backend>> {
    begin_work()?;
    let (backend, warning) = py.detach(|| open(device)).raise()?;
    if let Some(warning) = warning {
        py.import("warnings")?.call_method1("warn", (warning,))?;
    }
    Ok(backend)
}

fn open(device: &str) -> hsad::Result<(Arc<Backend>, Option<String>)> {
    let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    let backends = opened.backends.get_or_insert_default();
    if let Some(backend) = backends.get(device) {
        return Ok((backend.clone(), None));
    }
    let choice: DeviceChoice = device.parse().unwrap_or_default();
    let (backend, warning) = match Backend::open(&choice) {
        Err(error @ (Error::NoAdapter | Error::Unsupported(_))) if choice == DeviceChoice::Best => {
            (Backend::Cpu, Some(format!("the CPU does the work: {error}")))
        }
        opened => (tuned(opened?)?, None),
    };
    let backend = Arc::new(backend);
    backends.insert(device.into(), backend.clone());
    Ok((backend, warning))
}

/// The devices that ``device=`` can name, the best first.
///
/// Returns
/// -------
/// list of str
///     Names of adapters with their graphics interface and, where they have one, their place on the PCI bus; ``device=`` takes
///     ``"best"``, an index of this list, a part of a name, a place such as ``"pci:0000:3b:00.0"``, or ``"cpu"`` for the library's path
///     without any device, which gives the same bytes.
///
/// Examples
/// --------
/// >>> hsad.devices()[-1]
/// 'cpu'
#[pyfunction]
pub fn devices(py: Python<'_>) -> PyResult<Vec<String>> {
    begin_work()?;
    let adapters = py.detach(|| gpu::block_on(gpu::list_adapters()));
    let named = adapters.iter().map(|info| {
        let place = gpu::pci_name(info).map_or_else(String::new, |place| format!(", {place}"));
        format!("{} ({}{place})", info.name, info.backend)
    });
    Ok(named.chain(["cpu".into()]).collect())
}

/// The backend with the shapes of kernels that `hsad tune` has found for the device, if it has.
fn tuned(backend: Backend) -> hsad::Result<Backend> {
    match (backend, cache_folder()) {
        (Backend::Gpu(gpu), Some(folder)) => Ok(Backend::Gpu(gpu.with_kept_shapes(&folder)?)),
        (backend, _) => Ok(backend),
    }
}
