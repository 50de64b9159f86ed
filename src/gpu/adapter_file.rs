//! Files that a program keeps for an adapter between its runs, in the user's cache folder.

use std::path::{Path, PathBuf};

/// The file of the adapter in `folder` with this extension.
pub(super) fn path_of(info: &wgpu::AdapterInfo, folder: &Path, extension: &str) -> PathBuf {
    folder.join(format!("{:04x}-{:04x}.{extension}", info.vendor, info.device))
}

/// First line of a file, without which it is another's: the adapter, its driver and the version of this library.
pub(super) fn key_of(info: &wgpu::AdapterInfo) -> String {
    let wgpu::AdapterInfo { name, backend, driver, driver_info, .. } = info;
    let version = env!("CARGO_PKG_VERSION");
    format!("hsad {version}; {name}; {backend}; {driver}; {driver_info}").replace('\n', " ")
}

/// The folder of `hsad` in the user's cache folder (XDG Base Directory Specification; `%LOCALAPPDATA%` on Windows), where the
/// command keeps compiled kernels and what `hsad tune` has measured. `None` where the environment names no folder.
pub fn cache_folder() -> Option<PathBuf> {
    let absolute = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let cache = absolute("XDG_CACHE_HOME").or_else(|| {
        if cfg!(windows) { absolute("LOCALAPPDATA") } else { absolute("HOME").map(|home| home.join(".cache")) }
    })?;
    Some(cache.join("hsad"))
}
