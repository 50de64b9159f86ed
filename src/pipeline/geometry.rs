//! What calibration files tell of a pair: how its rows come to correspond, and the geometry of its pictures.

use super::Way;
use crate::{
    error::Result,
    image::Size,
    io::{Calibration, calibration::Loaded},
};

/// How the rows of a pair come to correspond, and its geometry.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// How the rows come to correspond.
    pub way: Way,
    /// The geometry of the pictures if they are rectified already.
    pub calibration: Option<Calibration>,
    /// What was assumed, and doubts, one sentence each.
    pub notes: Vec<String>,
}

impl Geometry {
    /// A way without calibration files.
    pub fn new(way: Way, calibration: Option<Calibration>) -> Self {
        Self { way, calibration, notes: Vec::new() }
    }

    /// The geometry of views of these sizes, in pixels, by calibration files: of pictures as they were taken, of rectified ones, or of both,
    /// of which the pictures' rows tell which they are.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if the files are for pictures of other sizes.
    pub fn of_files(loaded: &Loaded, sizes: [Size; 2]) -> Result<Self> {
        let stereo = &loaded.stereo;
        // Files of a rectified pair alone have the same cameras as `stereo`.
        if stereo.rectified().is_some() {
            return Self::of_rectified(loaded, sizes, Way::AsNeeded);
        }
        match (loaded.for_rectified(sizes[0]), stereo.check_sizes(sizes)) {
            (Ok(_), Ok(())) => Self::of_rectified(loaded, sizes, Way::Either(*stereo)),
            (Ok(_), Err(_)) => Self::of_rectified(loaded, sizes, Way::AsNeeded),
            (Err(_), Ok(())) => Self::of_taken(loaded, sizes),
            (Err(_), Err(error)) => Err(error),
        }
    }

    /// The geometry of a pair that is rectified by its calibration.
    ///
    /// # Errors
    /// As [`Self::of_files`].
    pub fn of_taken(loaded: &Loaded, sizes: [Size; 2]) -> Result<Self> {
        loaded.stereo.check_sizes(sizes)?;
        Ok(Self { way: Way::Calibrated(loaded.stereo), calibration: None, notes: loaded.notes.clone() })
    }

    /// The geometry of pictures that may be rectified already.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if the files describe only pictures that are not rectified, or are for pictures of other sizes.
    pub fn of_rectified(loaded: &Loaded, sizes: [Size; 2], way: Way) -> Result<Self> {
        let calibration = loaded.for_rectified(sizes[0])?;
        let notes = loaded.notes.iter().cloned().chain(calibration.doubt(sizes[0])).collect();
        Ok(Self { way, calibration: Some(calibration), notes })
    }
}
