//! What changes of disparity along a path cost.

use super::cost::MAX_COST;
use crate::error::{Error, Result};

/// What changes of the disparity along a path cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Penalties {
    /// A change by one.
    pub p1: u32,
    /// A larger one where the luma stays the same, at most 128.
    pub p2: u32,
    /// A larger one where the luma changes, at least: `p1` to `p2`.
    pub least_p2: u32,
    /// The change of luma that halves `p2`, 1 to 255.
    pub p2_scale: u32,
}

impl Penalties {
    /// With these a path leaves all costs as they are: changes cost nothing, so that the best way to a pixel takes away what
    /// it adds.
    pub const NONE: Self = Self { p1: 0, p2: 0, least_p2: 0, p2_scale: 1 };

    /// The penalty for a jump where the luma changes by `change`: `p2 scale / (scale + change)`, rounded
    /// down, or the least.
    pub fn p2_at(&self, change: u32) -> u32 {
        (self.p2 * self.p2_scale / (self.p2_scale + change)).max(self.least_p2)
    }

    /// Refuses what would not fit in the volumes' eight bits.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the rule.
    pub fn validate(&self) -> Result<()> {
        let check = |name, value: u32, range: std::ops::RangeInclusive<u32>| {
            if range.contains(&value) {
                return Ok(());
            }
            let expected = format!("it must be {} to {}", range.start(), range.end());
            Err(Error::Parameter { name, value: value.to_string(), expected })
        };
        check("P2", self.p2, 1..=255 - MAX_COST)?;
        check("the least P2", self.least_p2, 1..=self.p2)?;
        check("P1", self.p1, 0..=self.least_p2)?;
        check("the scale of P2", self.p2_scale, 1..=255)
    }
}
