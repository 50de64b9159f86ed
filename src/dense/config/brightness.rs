//! The change that brings the views' brightness together.

use crate::{
    error::{Result, check_range},
    gpu::shader_struct,
};

shader_struct! {
    /// A change of brightness: a luma v becomes (gain v + offset + 128) >> 8, cut off at 0 and 255.
    #[derive(PartialEq, Eq)]
    pub struct Brightness {
        /// In 1/256, up to 2^20 either way.
        pub gain: i32,
        /// In 1/256, up to 2^20 either way.
        pub offset: i32,
    }
}

impl Brightness {
    /// No change.
    pub const SAME: Self = Self { gain: 256, offset: 0 };

    /// Refuses what 32 bits do not hold.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        check_range("the gain", self.gain, -(1 << 20)..=1 << 20)?;
        check_range("the offset", self.offset, -(1 << 20)..=1 << 20)
    }

    /// A luma after the change.
    pub fn apply(&self, luma: u8) -> u8 {
        ((self.gain * i32::from(luma) + self.offset + 128) >> 8).clamp(0, 255) as u8
    }
}
