//! How good a disparity map is, and how good matches of interest points are, also where the second view was changed.
//!
//! A [`Truth`] tells where the second view has the points of the first, whatever [`conditions`] changed it. [`Judged`] holds
//! matches against it, [`OfPoints`] relates them to all points that were found, and [`curves`] are read off them.

pub mod conditions;
pub mod curves;
mod matches;
mod metrics;
mod overlap;
mod repeatability;
#[cfg(feature = "cli")]
pub mod scene;
mod truth;

pub use matches::{Judged, OfPoints, PointMatch};
pub use metrics::{Bad, OUTLIER_PIXELS, OUTLIER_SHARE, Outliers, Score, score, score_pixels};
pub use overlap::{NORMAL_RADIUS, Region, overlap_error};
pub use repeatability::{MAX_OVERLAP_ERROR, Point, Repeatability};
pub use truth::Truth;
