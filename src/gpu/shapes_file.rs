//! The shapes of kernels that were measured to be the fastest, kept in a file.

use std::{
    fs,
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
};

use super::{
    Gpu, Shapes,
    adapter_file::{key_of, path_of},
};
use crate::{
    error::{Error, Result},
    io::{atomic::write_whole, read_whole},
};

/// Longest file that is read, in bytes.
const MOST: u64 = 1 << 12;

/// The file in which the shapes for an adapter are kept between runs of a program: what `hsad tune` measures.
///
/// ```no_run
/// use hsad::{DeviceChoice, Gpu, gpu::cache_folder};
/// # fn main() -> hsad::Result<()> {
/// let mut gpu = Gpu::open(&DeviceChoice::Best)?;
/// if let Some(folder) = cache_folder() {
///     gpu = gpu.with_kept_shapes(&folder)?;
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct ShapesFile {
    path: PathBuf,
    /// First line of the file.
    key: String,
}

impl ShapesFile {
    /// The file for the device's adapter in `folder`.
    pub fn of(gpu: &Gpu, folder: &Path) -> Self {
        let info = gpu.info();
        Self { path: path_of(&info, folder, "shapes"), key: key_of(&info) }
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The kept shapes; `None` if there is no file, or one of another driver or another version of this library, or a damaged one.
    ///
    /// # Errors
    /// [`Error::Io`] for a file that exists and cannot be read.
    pub fn read(&self) -> Result<Option<Shapes>> {
        let bytes = match read_whole(&self.path, MOST) {
            Err(Error::Io { source, .. }) if source.kind() == ErrorKind::NotFound => return Ok(None),
            Err(Error::Format { .. }) => return Ok(None),
            read => read?,
        };
        let text = String::from_utf8_lossy(&bytes);
        let kept = text.strip_prefix(&self.key).and_then(|text| text.strip_prefix('\n'));
        Ok(kept.and_then(|shapes| shapes.parse().ok()))
    }

    /// Keeps `shapes`. The file is written whole or not at all; the folder is created.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self, shapes: Shapes) -> Result<()> {
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder).map_err(|source| Error::Io { path: folder.into(), source })?;
        }
        write_whole(&self.path, |file| writeln!(file, "{}\n{shapes}", self.key))
    }

    /// Removes the file, and returns whether there was one.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn remove(&self) -> Result<bool> {
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
            removed => removed.map(|()| true).map_err(|error| self.failed(error)),
        }
    }

    fn failed(&self, source: std::io::Error) -> Error {
        Error::Io { path: self.path.clone(), source }
    }
}

impl Gpu {
    /// The device with the shapes that `folder` keeps for its adapter, if it does: see [`ShapesFile`].
    ///
    /// # Errors
    /// See [`ShapesFile::read`].
    pub fn with_kept_shapes(self, folder: &Path) -> Result<Self> {
        Ok(ShapesFile::of(&self, folder).read()?.into_iter().fold(self, Self::with_shapes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::SgmPlan;

    #[test]
    fn only_shapes_of_the_same_key_are_read() {
        let folder = std::env::temp_dir().join(format!("hsad-shapes-{}", std::process::id()));
        let file = |key: &str| ShapesFile { path: folder.join("1-2.shapes"), key: key.into() };
        let text = "sgm=lanes lane_disparities=16 lane_threads=32 exchange=memory block_match=tiles census=rows support=tiles weighted_median=rows";
        let shapes: Shapes = text.parse().expect("shapes");
        assert_eq!(file("a driver 1").read().expect("no file"), None);
        assert!(!file("a driver 1").remove().expect("no file"));
        file("a driver 1").write(shapes).expect("a folder");
        assert_eq!(file("a driver 1").read().expect("a file"), Some(shapes));
        assert_eq!(file("a driver 2").read().expect("a file"), None, "another driver");
        file("a driver 1").write(Shapes { sgm: SgmPlan::Lines, ..shapes }).expect("a folder");
        assert_eq!(file("a driver 1").read().expect("a file").map(|shapes| shapes.sgm), Some(SgmPlan::Lines));
        fs::write(folder.join("1-2.shapes"), "a driver 1\nsgm=lanes").expect("a folder");
        assert_eq!(file("a driver 1").read().expect("a file"), None, "a damaged file");
        assert!(file("a driver 1").remove().expect("a file"));
        fs::remove_dir(&folder).expect("an empty folder");
    }
}
