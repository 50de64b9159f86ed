//! The change of brightness that matches the right view to the left one.

use crate::{
    error::{Result, check_range},
    gpu::shader_struct,
};

shader_struct! {
    /// A linear change of brightness: luma v becomes (gain v + offset + 128) >> 8, clamped to 0..255.
    #[derive(PartialEq, Eq)]
    pub struct Brightness {
        /// Gain, -2^20 to 2^20 in 1/256; 256 by default.
        pub gain: i32,
        /// Offset in grey levels, -2^20 to 2^20 in 1/256; 0 by default.
        pub offset: i32,
    }
}

impl Brightness {
    /// No change.
    pub const SAME: Self = Self { gain: 256, offset: 0 };

    /// Checks that gain and offset lie in their ranges, so that a changed luma fits in 32 bits.
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
