//! Dense matching (paper, step 5): a disparity for every pixel.
//!
//! Block matching: padding or soft ranks -> block matching (cost, winner-take-all, uniqueness, sub-pixel) of the
//! reference view and, for a left-right check, of the other view. Coarse to fine, the pair is matched at half the size
//! first: the reference view gives each cell of the picture the disparities worth searching, the other view confirms
//! matches; only the reference view is matched at full size.
//! Semi-global matching: padding -> census, wide census -> cost -> optional mean over a window -> paths -> selection, of one
//! view or both; without paths it is block matching by these costs. Both then go on: left-right consistency -> agreement of
//! neighbours -> removal of what does not show the scene -> residuals and support -> medians and filling. All arithmetic is integer and equals the CPU twins bit for
//! bit.

mod colours;
mod compute;
pub(crate) mod config;
mod inputs;
mod kept;
pub(crate) mod kernels;
mod levels;
mod map;
mod matcher;
mod outputs;
mod plan;
pub(crate) mod pyramid;
mod readback;
pub(crate) mod reprojection;
pub(crate) mod seen;
mod uploaded;
mod word_copy;

pub use compute::compute;
#[cfg(feature = "verify")]
pub(crate) use compute::compute_over;
pub(crate) use compute::compute_uploaded;
pub use config::{
    Aggregation, Brightness, Compared, Cost, CostAggregation, CrossCheck, DenseConfig, DenseParameters, Difference,
    FILLED, Interpolation, Median, Paths, Penalties, Refinement, Search, SemiGlobal, View,
};
pub(crate) use config::{Direction, Filters, MAX_COST, WEIGHT_BITS};
pub use inputs::Inputs;
pub use map::Dense;
pub use matcher::Matcher;
pub use outputs::{Destination, Outputs};
pub(crate) use plan::After;
pub use pyramid::Pyramid;
pub use readback::MapReadback;
pub use reprojection::{MapSources, MapTextureOutput, PointCloud, PointDraw, Reprojection};
pub(crate) use seen::Seen;
pub(crate) use uploaded::{Masks, UploadedPair};
