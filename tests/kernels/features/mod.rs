//! The kernels of interest points.

mod descriptor;
mod detector;
mod hessian;
mod integral_columns;
mod integral_rows;
mod nonmax;
mod orientation;
mod turned;
mod workgroups;
