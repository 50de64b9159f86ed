//! The tolerances of all floats, which are defined here and nowhere else.

use std::f32::consts::PI;

use crate::verify::array::{Outliers, Tolerance};

/// Tolerance of places and scales, in pixels: three numbers per keypoint.
///
/// The division that places a maximum between its samples may be off by 2.5 units in the last place of half a sample,
/// and samples are up to 32 px apart; the place is rounded to 1/8192 px from 1024 px on.
pub(super) const PLACES: Tolerance =
    Tolerance::Within { difference: 1.0 / 4096.0, angles: false, group: 3, length: None, outliers: None };

/// Tolerance of orientations that no last digit decides, in radians.
///
/// The twin adds floats, the kernel whole numbers of 1/32768 grey level, and the `atan2` of a device may be off by 4096
/// units in the last place; on lavapipe they are at most 0.0004 apart.
pub(super) const ORIENTATIONS: Tolerance =
    Tolerance::Within { difference: 1e-3, angles: true, group: 1, length: None, outliers: None };

/// Tolerance of any orientation: where a gradient lies at the very end of a window, or the sums of two windows are
/// equally long, the last digit decides which window wins, and the two directions can be any. On lavapipe it is one of
/// 15,088.
pub(super) const ORIENTATIONS_ANYWHERE: Tolerance = Tolerance::Within {
    difference: 1e-3,
    angles: true,
    group: 1,
    length: None,
    outliers: Some(Outliers { of_thousand: 5, difference: PI }),
};

/// A tolerance of descriptors: outliers are accepted if they have the length of a descriptor.
const fn of_descriptors(difference: f32, outliers: Option<Outliers>) -> Tolerance {
    Tolerance::Within { difference, angles: false, group: 64, length: Some(1e-4), outliers }
}

/// Change of a descriptor's values where some samples are rounded to another 1/16 px: on lavapipe up to 0.011.
const ANOTHER_SIXTEENTH: f32 = 0.016;

/// Tolerance of the 64 values of a descriptor.
///
/// Upright, all samples are the same integers on device and twin, and only their cube roots and sums are floats (on
/// lavapipe 6e-7 apart). Turned, the place of each sample is a float that is rounded to 1/16 px, sometimes the other
/// way: accepted at one descriptor in 200, on lavapipe at fewer than one in 10,000.
pub(super) const fn descriptors(upright: bool) -> Tolerance {
    if upright {
        return of_descriptors(1e-5, None);
    }
    of_descriptors(1e-3, Some(Outliers { of_thousand: 5, difference: ANOTHER_SIXTEENTH }))
}

/// Tolerance of descriptors at places and orientations that themselves have tolerances; some orientations are entirely
/// different. On lavapipe, upright, none of 11,648 descriptors is off. Turned, one of 15,088 is off by 0.18, the one
/// with another orientation, and in some pictures more than one in 200 by up to 0.011, in no case that is verified by
/// default.
pub(super) const fn descriptors_anywhere(upright: bool) -> Tolerance {
    if upright {
        return of_descriptors(1e-3, None);
    }
    of_descriptors(1e-3, Some(Outliers { of_thousand: 5, difference: 0.5 }))
}
