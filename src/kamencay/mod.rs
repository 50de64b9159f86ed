//! Kamencay's method, the hybrid method that the project's paper compares with: a disparity for each segment of the
//! picture.
//!
//! Kamencay, Breznan, Jarina, Lukac and Zachariasova: 'Improved Depth Map Estimation from Stereo Images Based on
//! Hybrid Method', Radioengineering 21(1), 2012. The reference view is segmented by its colours with mean shift;
//! the segments go into the matching, in which sums of absolute differences in local windows are refined by belief
//! propagation; the segments' disparities make the final map.
//!
//! colours and gradients -> mean shift -> segments and links -> data cost -> belief propagation from
//! coarse to fine -> selection -> a disparity for each segment. The steps on pictures and volumes are kernels with CPU
//! twins; segments and their disparities are computed on the host, by the same code for both. All arithmetic is
//! integer, and the result is the same on every device and on the CPU.
//!
//! # What the paper leaves open
//!
//! The paper gives no usable parameters, and describes the interplay of its parts in words. The choices made here each
//! gave the least error on Art, Cones and Teddy of Middlebury:
//!
//! - The filter is mean shift with the uniform kernel in RGB (Comaniciu and Meer, PAMI 2002). Segments are the
//!   regions of pixels whose filtered colours are near their neighbours'; small ones join the most similar one.
//! - The 'modified SAD' adds the differences of the gradients to those of the colours, as Klaus, Sormann and Karner
//!   do ('Segment-based stereo matching using belief propagation and a self-adapting dissimilarity measure', ICPR
//!   2006), and truncates both. Without gradients half as many pixels again are wrong.
//! - Belief propagation is min-sum on a truncated linear model (Felzenszwalb and Huttenlocher, IJCV 2006). The
//!   segments weaken the links that cross their outlines.
//! - The disparities of a segment are a plane through its confirmed pixels. A pixel is confirmed by the claims of the
//!   reference view's winners on the other view: of all claims to a partner the best holds. Few surfaces face the
//!   cameras, and with one disparity per segment twice as many pixels are wrong. A pixel keeps its own disparity
//!   where that is near the plane.
//! - Unconfirmed pixels take the smaller of the nearest confirmed disparities of their row, or the segment's
//!   disparity where that is far from it.
//! - The paper has no confidences. Here a confidence has three equal parts: the share of the segment's pixels that agree
//!   with its plane, the margin of the belief, and the normalised cross-correlation of the views in a window of 9x9.
//!   Without the cross-correlation the most confident pixels of a whole segment can be wrong.
//! - Pictures whose messages do not fit in 128 MiB are solved in strips of rows that overlap by 16 rows.
//!   Strips show in the result, but depend on nothing but the size and the range.

mod alikeness;
mod config;
pub(crate) mod grid;
pub(crate) mod kernels;
pub(crate) mod links;
pub(crate) mod matcher;
pub(crate) mod method;
pub(crate) mod segment_disparity;
pub(crate) mod segments;
mod surface;

pub use config::{KamencayConfig, KamencayParameters};
pub(crate) use grid::{FAR, MAX_MESSAGE_BYTES, OVERLAP, Strip};
pub use kernels::{ModeSeeking, Smoothness, WindowCost};
pub use links::LinkWeights;
pub(crate) use links::Links;
pub use matcher::compute;
pub(crate) use matcher::compute_within;
pub(crate) use method::{Problem, Solver, described, solve};
pub use segment_disparity::Conclusion;
pub use segments::Segmentation;
pub(crate) use segments::Segments;
