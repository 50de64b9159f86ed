//! What changes of disparity along a path cost.

use super::cost::MAX_COST;
use crate::error::{Result, check_range};

/// The penalties for changes of disparity along a path, in units of the matching cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Penalties {
    /// For a change by one pixel, 0 to `least_p2`.
    pub p1: u32,
    /// For a larger change where the luma stays the same, 1 to 128.
    pub p2: u32,
    /// For a larger change, at least, however much the luma changes: 1 to `p2`.
    pub least_p2: u32,
    /// The change of luma that halves `p2`, 1 to 255.
    pub p2_scale: u32,
}

impl Penalties {
    /// Penalties with which a path leaves all costs as they are: changes cost nothing, so that the best way to a pixel takes
    /// away what it adds.
    pub const NONE: Self = Self { p1: 0, p2: 0, least_p2: 0, p2_scale: 1 };

    /// The penalty for a jump where the luma changes by `change`: `p2 scale / (scale + change)`, rounded
    /// down, or the least.
    pub fn p2_at(&self, change: u32) -> u32 {
        (self.p2 * self.p2_scale / (self.p2_scale + change)).max(self.least_p2)
    }

    /// Refuses what would not fit in the volumes' eight bits.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] with the rule.
    pub fn validate(&self) -> Result<()> {
        check_range("P2", self.p2, 1..=255 - MAX_COST)?;
        check_range("the least P2", self.least_p2, 1..=self.p2)?;
        check_range("P1", self.p1, 0..=self.least_p2)?;
        check_range("the scale of P2", self.p2_scale, 1..=255)
    }
}
