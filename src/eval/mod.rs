//! Quality of disparity maps ([`score`]) and of matches of interest points, also under synthetic changes of the second
//! view.
//!
//! A [`Truth`] maps points of the first view to the second, under any [`conditions`]. [`Judged`] compares matches with
//! it, [`PointScores`] relates them to all detected points, and [`curves`] are computed from the judged matches.

pub mod conditions;
pub mod curves;
mod matches;
mod metrics;
mod other_form;
mod overlap;
mod repeatability;
#[cfg(feature = "files")]
pub mod scene;
mod truth;
mod unit;

pub use matches::{Judged, PointMatch, PointScores};
pub use metrics::{Bad, OUTLIER_PIXELS, OUTLIER_SHARE, Outliers, Score, score, score_pixels};
pub use other_form::{Form, OtherForm};
pub use overlap::{NORMAL_RADIUS, Region, overlap_error};
pub use repeatability::{MAX_OVERLAP_ERROR, Point, Repeatability};
pub use truth::Truth;
pub use unit::OtherUnit;
