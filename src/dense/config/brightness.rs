//! The change that brings the views' brightness together.

use crate::{
    error::{Error, Result},
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
    /// [`Error::Parameter`] with the rule.
    pub fn validate(&self) -> Result<()> {
        for (name, value) in [("the gain", self.gain), ("the offset", self.offset)] {
            if value.unsigned_abs() > 1 << 20 {
                let expected = "it must be -2^20 to 2^20, in 1/256".into();
                return Err(Error::Parameter { name, value: value.to_string(), expected });
            }
        }
        Ok(())
    }

    /// A luma after the change.
    pub fn apply(&self, luma: u8) -> u8 {
        ((self.gain * i32::from(luma) + self.offset + 128) >> 8).clamp(0, 255) as u8
    }
}
