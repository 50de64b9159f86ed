//! The CPU twins of interest points.

pub mod descriptor;
pub mod detector;
pub mod haar;
pub mod hessian;
pub mod integral;
pub mod integral_columns;
pub mod integral_rows;
pub mod nonmax;
pub mod orientation;
pub mod workgroups;
