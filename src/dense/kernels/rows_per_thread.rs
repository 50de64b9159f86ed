//! Threads that walk down: each has several rows of a few columns, and of the window of its next pixels it has all but
//! one row.

use crate::gpu::Gpu;

/// How many rows a thread has on lavapipe.
pub const ROWS_SOFTWARE: u32 = 16;
/// And elsewhere: GPUs would rather run many threads.
pub const ROWS_HARDWARE: u32 = 1;

/// How many rows a thread has on a device.
pub(super) fn rows_per_thread(gpu: &Gpu) -> u32 {
    if gpu.is_lavapipe() { ROWS_SOFTWARE } else { ROWS_HARDWARE }
}
