//! File formats: pictures, disparity maps, calibrations, homographies, tables, point clouds and figures.
//!
//! Encoders write to anything that implements [`std::io::Write`]; decoders take the file's bytes, and its path for
//! error messages. Headers are not trusted: memory is allocated only for bytes that are really there, or up to
//! [`MAX_PIXELS`] where a codec expands them.
//!
//! Reading and writing pictures needs the feature `pictures`; writing whole files needs `files`; calibrations of other formats
//! than Middlebury's need `calibrations`, recordings of robots `recordings`. PFM, PLY, tables, homographies and colour maps are always available.

#[cfg(feature = "files")]
#[doc(hidden)]
pub mod atomic;
pub mod calibration;
#[cfg(feature = "pictures")]
mod claims;
#[cfg(feature = "pictures")]
mod codec;
pub mod color;
pub mod csv;
#[cfg(feature = "pictures")]
mod decoded;
#[cfg(feature = "pictures")]
pub mod depth_png;
#[cfg(feature = "files")]
pub mod disparities;
#[cfg(feature = "pictures")]
pub mod disparity_png;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod figure;
#[cfg(feature = "pictures")]
mod halves;
pub mod homography;
#[cfg(feature = "pictures")]
mod jpeg;
#[cfg(feature = "pictures")]
mod jps;
#[cfg(feature = "pictures")]
pub mod load;
pub mod mesh;
#[cfg(feature = "pictures")]
mod mpo;
pub mod pfm;
pub mod picture;
pub mod ply;
mod ply_reader;
#[cfg(feature = "pictures")]
pub mod png;
#[cfg(feature = "pictures")]
mod png_chunks;
#[cfg(feature = "pictures")]
mod png_text;
mod point_filter;
#[cfg(feature = "pictures")]
mod raw;
#[cfg(feature = "recordings")]
pub mod recording;
#[cfg(feature = "pictures")]
mod samples;
#[cfg(feature = "pictures")]
mod stretch;
#[cfg(feature = "pictures")]
mod tiff;
#[cfg(feature = "pictures")]
mod unseen;

pub use calibration::Calibration;
pub use picture::Picture;

use std::{fs::File, io::Read, path::Path, sync::mpsc, thread, time::Duration};

use crate::{
    error::{Error, Result, shown},
    image::Size,
    luma::MAX_SIDE,
};

/// Largest number of pixels of a picture or map that is read: 2^27, about 134 million.
///
/// The limit is needed because a file of a few kilobytes can claim any number of pixels.
pub const MAX_PIXELS: u64 = 1 << 27;

/// Bytes by which the kind of a file is told.
const HEAD: u64 = 16;

/// Time after which the log says that a pipe has no bytes yet.
const PATIENCE: Duration = Duration::from_secs(1);

/// A wait for the first bytes of a pipe.
struct Waiting {
    /// Ends the wait when it is dropped; `None` for a file that is no pipe.
    _bytes_came: Option<mpsc::Sender<()>>,
}

impl Waiting {
    fn new(path: &Path) -> Self {
        #[cfg(unix)]
        let is_pipe =
            std::fs::metadata(path).is_ok_and(|found| std::os::unix::fs::FileTypeExt::is_fifo(&found.file_type()));
        #[cfg(not(unix))]
        let is_pipe = false;
        if !is_pipe {
            return Self { _bytes_came: None };
        }
        let (sender, bytes_came) = mpsc::channel();
        let path = path.to_path_buf();
        let tell = move || {
            if bytes_came.recv_timeout(PATIENCE) == Err(mpsc::RecvTimeoutError::Timeout) {
                log::warn!("{} is a pipe, and nobody writes to it yet: waiting", shown(&path));
            }
        };
        // Without a thread the wait is silent.
        let is_told = thread::Builder::new().name("waiting".into()).spawn(tell).is_ok();
        Self { _bytes_came: is_told.then_some(sender) }
    }
}

/// Reads a file of 1 to `limit` bytes. A pipe is waited for, which the log says after a while.
///
/// # Errors
/// [`Error::Io`]; [`Error::Format`] for an empty file and a longer one.
pub fn read_whole(path: &Path, limit: u64) -> Result<Vec<u8>> {
    read_if(path, limit, |_| true)
}

/// Reads a file of 1 to `limit` bytes, or only its first [`HEAD`] bytes unless these are `wanted`.
///
/// A pipe is waited for, which the log says after a while.
fn read_if(path: &Path, limit: u64, wanted: impl FnOnce(&[u8]) -> bool) -> Result<Vec<u8>> {
    let failed = |source| Error::Io { path: path.into(), source };
    let waiting = Waiting::new(path);
    let mut bytes = Vec::new();
    // The file length that the system reports is not used: it is meaningless for pipes and devices.
    let mut file = File::open(path).map_err(failed)?;
    file.by_ref().take(HEAD.min(limit + 1)).read_to_end(&mut bytes).map_err(failed)?;
    drop(waiting);
    if wanted(&bytes) {
        file.take((limit + 1).saturating_sub(HEAD)).read_to_end(&mut bytes).map_err(failed)?;
    }
    if bytes.is_empty() {
        return Err(malformed(path, "the file is empty: it was not written, or not copied"));
    }
    if bytes.len() as u64 > limit {
        return Err(malformed(path, format!("the file is longer than {limit} bytes, the most that is read")));
    }
    Ok(bytes)
}

/// Refuses an empty size, a size above [`MAX_PIXELS`], and a side above [`MAX_SIDE`], the limit of the kernels'
/// workgroups.
fn check_pixels(size: impl Into<Size>, path: &Path) -> Result<()> {
    let Size { width, height } = size.into();
    if width == 0 || height == 0 {
        return Err(malformed(path, format!("its size is {width}x{height}: there is nothing in it")));
    }
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        let reason = format!("{width}x{height} pixels are more than the {MAX_PIXELS} that are read: scale it down");
        return Err(malformed(path, reason));
    }
    if width.max(height) > MAX_SIDE {
        return Err(malformed(path, format!("{width}x{height} pixels: no side may be longer than {MAX_SIDE}")));
    }
    Ok(())
}

fn malformed(path: &Path, reason: impl Into<String>) -> Error {
    Error::Format { path: path.into(), reason: reason.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reading_names_what_is_wrong_with_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        assert!(
            matches!(read_whole(&file, 9), Err(Error::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound)
        );
        assert!(matches!(read_whole(folder.path(), 9), Err(Error::Io { .. })));
        std::fs::write(&file, "").unwrap();
        assert!(matches!(read_whole(&file, 9), Err(Error::Format { reason, .. }) if reason.contains("empty")));
        std::fs::write(&file, "123456789").unwrap();
        assert_eq!(read_whole(&file, 9).unwrap(), b"123456789");
        assert!(matches!(read_whole(&file, 8), Err(Error::Format { reason, .. }) if reason.contains("8 bytes")));
    }

    #[test]
    fn sizes_that_nothing_can_work_on_are_refused() {
        let reason = |width, height| match check_pixels((width, height), Path::new("a.png")) {
            Err(Error::Format { reason, .. }) => reason,
            other => format!("{other:?}"),
        };
        assert!(reason(0, 9).contains("nothing in it") && reason(1 << 14, 1 << 14).contains("more than the"));
        assert_eq!(reason(9, MAX_SIDE + 1), "9x524289 pixels: no side may be longer than 524288");
        assert_eq!(reason(MAX_SIDE, 9), "Ok(())");
    }
}
