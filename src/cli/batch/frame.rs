//! Pictures of a pair that were read from a video or a recording, where files have none.

use std::borrow::Cow;

use hsad::{Result, io::recording::Shot};

use super::{super::view_files::InMemory, video};

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

impl Files<'_> {
    pub fn in_memory(&self) -> InMemory<'_> {
        match self {
            Self::Both(both) => InMemory::Both(both),
            Self::Each(each) => InMemory::Each(each.each_ref().map(|bytes| &**bytes)),
        }
    }
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

    /// What was read: of one picture with both views, or of the left and of the right view.
    pub fn contents(&self) -> Vec<&[u8]> {
        match self {
            Self::Both(frame) => vec![frame.samples()],
            Self::Each(shots) => shots.iter().map(Shot::message).collect(),
        }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.contents().iter().map(|content| content.len()).sum()
    }

    /// A frame of as many bytes.
    #[cfg(test)]
    pub fn of_bytes(count: usize) -> Self {
        Self::Both(video::Frame::of_bytes(count))
    }
}
