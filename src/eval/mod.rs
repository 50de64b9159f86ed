//! How good a disparity map is.

mod metrics;
#[cfg(feature = "cli")]
pub mod scene;

pub use metrics::{Bad, OUTLIER_PIXELS, OUTLIER_SHARE, Outliers, Score, score, score_pixels};
