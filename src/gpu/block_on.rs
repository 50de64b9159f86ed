//! Blocking on a future.

/// Runs a future of this library to completion on this thread.
///
/// Any executor works, since a future that waits for a device polls it itself; this function is for callers without an
/// executor. In a browser nothing can block, and the function does not exist.
pub fn block_on<F: Future>(future: F) -> F::Output {
    pollster::block_on(future)
}
