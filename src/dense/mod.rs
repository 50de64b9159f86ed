//! The dense half (paper, step 5): a disparity for every pixel.
//!
//! Blocks: padding -> block matching (cost, winner-take-all, uniqueness, sub-pixel) of both views; coarse to fine, both
//! are matched at half the size before, the reference view to tell for each cell of the picture which disparities are
//! worth searching, the other one to confirm what is found, and only the reference view at the whole size.
//! Semi-globally: padding -> census -> cost -> mean over a window, if wanted -> paths -> selection of one view or
//! both; without paths it is block matching by those costs. Then, for either:
//! left-right consistency -> residuals and support -> medians and filling. All of it is integer arithmetic and equals
//! the CPU twins bit for bit.

pub(crate) mod config;
mod inputs;
pub(crate) mod kernels;
mod matcher;
mod outputs;
mod plan;
mod readback;

pub use config::{
    Aggregation, Brightness, Cost, CostAggregation, CrossCheck, DenseConfig, DenseParameters, Difference,
    Interpolation, Median, Paths, Penalties, Refinement, Search, SemiGlobal, View,
};
pub(crate) use config::{Direction, MAX_COST, WEIGHT_BITS};
pub use inputs::Inputs;
pub use matcher::{Dense, Matcher, compute};
pub use outputs::{Destination, Outputs};
pub use readback::MapReadback;
