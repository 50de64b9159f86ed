//! The penalties for changes of disparity along a path.

use super::cost::MAX_COST;
use crate::error::{Result, check_range};

/// The penalties for changes of disparity along a path (P1 and P2 of Hirschmueller, PAMI 2008, eq. 13), in units of the
/// matching cost. The presets balanced and quality have `p1` 16, `p2` 80, `least_p2` 16 and `p2_scale` 16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Penalties {
    /// P1: penalty for a change of 1 px, 0 to `least_p2`.
    pub p1: u32,
    /// P2: penalty for a larger change where luma is constant, 1 to 128.
    pub p2: u32,
    /// Lower bound of P2 at edges of luma, 1 to `p2`.
    pub least_p2: u32,
    /// The change of luma that halves `p2`, 1 to 255 grey levels.
    pub p2_scale: u32,
}

impl Penalties {
    /// No penalties: changes are free, so that the minimum which a path subtracts equals what it adds, and all costs
    /// stay as they are.
    pub const NONE: Self = Self { p1: 0, p2: 0, least_p2: 0, p2_scale: 1 };

    /// P2 where luma changes by `change` grey levels: `p2 scale / (scale + change)`, rounded down, or `least_p2` if
    /// that is more.
    pub fn p2_at(&self, change: u32) -> u32 {
        (self.p2 * self.p2_scale / (self.p2_scale + change)).max(self.least_p2)
    }

    /// Checks that sums of costs and penalties fit in the 8 bits of the volumes.
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
