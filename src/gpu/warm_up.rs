//! Compilation before the first frame, by drivers that compile a kernel when it first runs.

use super::{Dispatch, Gpu, Readback, guarded};
use crate::error::Result;

/// Runs `dispatches` without a single workgroup, and waits until the device has done so: drivers compile whatever they
/// have left to compile, and nothing is computed.
pub(crate) async fn warm_up(gpu: &Gpu, what: &'static str, dispatches: Vec<&Dispatch>) -> Result<()> {
    let (commands, done) = guarded(gpu, what, || {
        let (mut encoder, done) = (gpu.encoder("warm-up"), Readback::new(gpu, "warm-up", 4));
        dispatches.iter().for_each(|dispatch| dispatch.record_empty(&mut encoder));
        encoder.clear_buffer(done.buffer(), 0, None);
        Ok((encoder.finish(), done))
    })
    .await?;
    submit(gpu.clone(), what, commands).await?;
    done.read::<u32>(1).await.map(drop)
}

/// Submits `commands` on a thread of its own, since lavapipe compiles before the call returns.
#[cfg(not(target_arch = "wasm32"))]
async fn submit(gpu: Gpu, what: &'static str, commands: wgpu::CommandBuffer) -> Result<()> {
    super::background::in_background(move || {
        super::block_on(guarded(&gpu, what, || {
            gpu.queue.submit([commands]);
            Ok(())
        }))
    })
    .await
}

/// Submits `commands`; a browser compiles on threads of its own.
#[cfg(target_arch = "wasm32")]
async fn submit(gpu: Gpu, what: &'static str, commands: wgpu::CommandBuffer) -> Result<()> {
    guarded(&gpu, what, || {
        gpu.queue.submit([commands]);
        Ok(())
    })
    .await
}
