//! Rows per thread: a thread walks down several rows of a few columns, and already holds all but one row of its next
//! pixels' window.

use crate::gpu::Gpu;

/// Rows per thread on lavapipe.
pub const ROWS_SOFTWARE: u32 = 16;
/// Rows per thread on other devices: GPUs prefer many threads.
pub const ROWS_HARDWARE: u32 = 1;

/// Rows per thread on the device of `gpu`.
pub(super) fn rows_per_thread(gpu: &Gpu) -> u32 {
    if gpu.is_lavapipe() { ROWS_SOFTWARE } else { ROWS_HARDWARE }
}
