//! Storage that takes no more files, which ends a run: all pairs after it would be matched in vain.

use std::io::{Error, ErrorKind};

use anyhow::anyhow;

/// What helps, if the error says that nothing more can be written.
pub fn way_out(error: &anyhow::Error) -> Option<&'static str> {
    error.chain().find_map(|cause| match cause.downcast_ref::<Error>()?.kind() {
        ErrorKind::StorageFull => Some("make room on the disk"),
        ErrorKind::QuotaExceeded => Some("make room within the quota"),
        ErrorKind::ReadOnlyFilesystem => Some("make the file system writable"),
        _ => None,
    })
}

/// The error that ends a run, with what helps.
pub fn told(error: anyhow::Error) -> anyhow::Error {
    match way_out(&error) {
        Some(way_out) => anyhow!("{error}: {way_out}, and go on with --resume"),
        None => error,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use hsad::{
        image::Plane,
        io::{atomic::write_whole, png},
    };

    use super::*;

    fn of(kind: ErrorKind) -> anyhow::Error {
        hsad::Error::Io { path: "out/a".into(), source: kind.into() }.into()
    }

    #[test]
    fn errors_that_every_other_pair_would_have_are_told_apart() {
        for (kind, way_out) in [
            (ErrorKind::StorageFull, "make room on the disk, and go on with --resume"),
            (ErrorKind::QuotaExceeded, "make room within the quota"),
            (ErrorKind::ReadOnlyFilesystem, "make the file system writable"),
        ] {
            let told = told(of(kind)).to_string();
            assert!(told.starts_with("out/a: ") && told.contains(way_out), "{told}");
        }
        for other in [of(ErrorKind::PermissionDenied), of(ErrorKind::NotFound), hsad::Error::NoAdapter.into()] {
            assert_eq!(way_out(&other), None);
            assert!(told(other).is::<hsad::Error>(), "as it was");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_known_behind_the_errors_of_encoders() {
        let picture = Plane::filled((640, 480), 7);
        for error in [
            write_whole(Path::new("/dev/full"), |out| png::write_grey8(out, &picture)).unwrap_err(),
            write_whole(Path::new("/dev/full"), |out| std::io::Write::write_all(out, b"text")).unwrap_err(),
        ] {
            let told = told(error.into()).to_string();
            assert!(told.contains("/dev/full: No space left") && told.contains("--resume"), "{told}");
        }
    }
}
