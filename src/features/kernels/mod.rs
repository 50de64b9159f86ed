//! The kernels that find and describe interest points, one per stage.

pub mod descriptor;
pub mod hessian;
pub mod integral_columns;
pub mod integral_rows;
pub mod nonmax;
pub mod orientation;
pub mod workgroups;

use crate::gpu::Stage;

/// Every stage of sparse features.
pub fn stages() -> Vec<Stage> {
    vec![
        integral_rows::stage(),
        integral_columns::stage(),
        hessian::stage(true),
        hessian::stage(false),
        nonmax::stage(),
        workgroups::stage(),
        orientation::stage(),
        descriptor::stage(true),
        descriptor::stage(false),
    ]
}
