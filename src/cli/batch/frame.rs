//! Pictures of a pair that were read from a video or a recording, where files have none.

use std::borrow::Cow;

use hsad::{Result, io::recording::Shot};

use super::video;

/// The pictures of a pair, as they were read.
pub enum Frame {
    /// One with both views.
    Both(video::Frame),
    /// The left and the right view.
    Each(Box<[Shot; 2]>),
}

/// The pictures as picture files.
pub enum Files<'a> {
    Both(Vec<u8>),
    Each([Cow<'a, [u8]>; 2]),
}

impl Frame {
    /// The pictures as picture files.
    ///
    /// # Errors
    /// [`hsad::Error::Format`] for a damaged message of a recording.
    pub fn to_files(&self) -> Result<Files<'_>> {
        Ok(match self {
            Self::Both(frame) => Files::Both(frame.to_pnm()),
            Self::Each(shots) => Files::Each([shots[0].to_file()?, shots[1].to_file()?]),
        })
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Both(frame) => frame.bytes(),
            Self::Each(shots) => shots.iter().map(Shot::bytes).sum(),
        }
    }

    /// A frame of as many bytes.
    #[cfg(test)]
    pub fn of_bytes(count: usize) -> Self {
        Self::Both(video::Frame::of_bytes(count))
    }
}
