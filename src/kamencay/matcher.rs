//! Kamencay's method on a device.

use super::{
    KamencayConfig, Links, MAX_MESSAGE_BYTES, Problem, Solver, Strip,
    kernels::{Belief, BeliefCost, BeliefReduce, BeliefSelect, GridBuffers, MeanShift, Turn, Winner},
    solve,
};
use crate::{
    dense::Dense,
    error::Result,
    gpu::{Dispatch, Gpu, Readback, guarded, storage_buffer},
    image::{Plane, Size},
    io::Picture,
};

/// Matches a pair on `gpu` by Kamencay's method.
///
/// # Errors
/// [`crate::Error::SizesDiffer`]; [`crate::Error::Parameter`] if `config` is out of range; [`crate::Error::TooLarge`]
/// if a strip cannot hold enough rows of this width, or the device cannot bind the picture;
/// [`crate::Error::OutOfMemory`], [`crate::Error::Unsupported`], [`crate::Error::DeviceLost`].
pub async fn compute(gpu: &Gpu, left: &Picture, right: &Picture, config: &KamencayConfig) -> Result<Dense> {
    compute_within(gpu, left, right, config, MAX_MESSAGE_BYTES).await
}

/// [`compute`] in strips whose messages take at most `message_bytes`, or [`MAX_MESSAGE_BYTES`] if that is less. Smaller
/// strips need less memory and more work, and change the result slightly.
///
/// # Errors
/// See [`compute`].
pub async fn compute_within(
    gpu: &Gpu,
    left: &Picture,
    right: &Picture,
    config: &KamencayConfig,
    message_bytes: u64,
) -> Result<Dense> {
    solve(left, right, config, message_bytes, &mut OnDevice { gpu, prepared: None }).await
}

/// The solver on a device, with kernels and views from their first use on.
struct OnDevice<'g> {
    gpu: &'g Gpu,
    prepared: Option<Prepared>,
}

struct Prepared {
    views: [wgpu::Buffer; 2],
    cost: BeliefCost,
    reduce: BeliefReduce,
    belief: Belief,
    select: BeliefSelect,
}

impl Prepared {
    async fn new(gpu: &Gpu, problem: &Problem) -> Result<Self> {
        let parameters = &problem.parameters;
        guarded(gpu, "belief propagation", || {
            Ok(Self {
                views: [upload(gpu, "left view", &problem.left)?, upload(gpu, "right view", &problem.right)?],
                cost: BeliefCost::new(gpu, &parameters.cost),
                reduce: BeliefReduce::new(gpu),
                belief: Belief::new(gpu, &parameters.smoothness, problem.range.count.div_ceil(4)),
                select: BeliefSelect::new(gpu),
            })
        })
        .await
    }
}

fn upload(gpu: &Gpu, label: &'static str, plane: &Plane<u32>) -> Result<wgpu::Buffer> {
    let buffer = storage_buffer(gpu, label, 4 * plane.data().len() as u64)?;
    gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(plane.data()));
    Ok(buffer)
}

impl Solver for OnDevice<'_> {
    async fn modes(&mut self, problem: &Problem) -> Result<Plane<u32>> {
        let (gpu, size) = (self.gpu, problem.left.size());
        let pixels = problem.left.data().len();
        let readback = guarded(gpu, "mean shift", || {
            let view = upload(gpu, "left view", &problem.left)?;
            let modes = storage_buffer(gpu, "modes", 4 * pixels as u64)?;
            let kernel = MeanShift::new(gpu, &problem.parameters.mean_shift);
            let dispatch = kernel.prepare(size, &view, &modes);
            let readback = Readback::new(gpu, "modes", 4 * pixels as u64);
            submit(gpu, &[dispatch], &modes, &readback);
            Ok(readback)
        })
        .await?;
        Plane::new(size, readback.read(pixels).await?)
    }

    async fn winners(&mut self, problem: &Problem, strip: Strip, grids: &[(Size, Links)]) -> Result<Vec<Winner>> {
        let gpu = self.gpu;
        let prepared = match &mut self.prepared {
            Some(prepared) => prepared,
            none => none.insert(Prepared::new(gpu, problem).await?),
        };
        let (count, fours) = (problem.range.count, problem.range.count.div_ceil(4));
        let pixels = problem.left.width() as usize * strip.rows as usize;
        let readback = guarded(gpu, "belief propagation", || {
            let mut dispatches = Vec::new();
            let nodes = |Size { width, height }: Size| u64::from(width) * u64::from(height);
            let costs = grids
                .iter()
                .map(|&(size, _)| storage_buffer(gpu, "data costs", 8 * u64::from(fours) * nodes(size)))
                .collect::<Result<Vec<_>>>()?;
            // The messages of a grid are needed until the next finer grid has sent once.
            let messages = grids
                .iter()
                .take(2)
                .map(|&(size, _)| storage_buffer(gpu, "messages", 16 * u64::from(fours) * nodes(size)))
                .collect::<Result<Vec<_>>>()?;
            let winners = storage_buffer(gpu, "winners", size_of::<Winner>() as u64 * pixels as u64)?;

            let [left, right] = &prepared.views;
            let views = [left, right];
            dispatches.push(prepared.cost.prepare(problem.left.size(), strip, problem.range, views, &costs[0]));
            for (level, &(size, _)) in grids.iter().enumerate().take(grids.len() - 1) {
                dispatches.push(prepared.reduce.prepare(size, fours, &costs[level], &costs[level + 1]));
            }
            for (level, (size, links)) in grids.iter().enumerate().rev() {
                let links = upload(gpu, "links", links.words())?;
                let coarsest = level + 1 == grids.len();
                let buffers = GridBuffers {
                    costs: &costs[level],
                    links: &links,
                    parents: if coarsest { &costs[level] } else { &messages[(level + 1) % 2] },
                    messages: &messages[level % 2],
                };
                for turn in 0..problem.parameters.turns {
                    let turn = Turn { parity: turn % 2, from_parents: turn == 0 && !coarsest };
                    dispatches.push(prepared.belief.prepare(*size, turn, buffers));
                }
            }
            dispatches.push(prepared.select.prepare(grids[0].0, count, [&costs[0], &messages[0]], &winners));
            let readback = Readback::new(gpu, "winners", winners.size());
            submit(gpu, &dispatches, &winners, &readback);
            Ok(readback)
        })
        .await?;
        readback.read(pixels).await
    }
}

/// Submits `dispatches` and the copy of `result` to `readback`.
fn submit(gpu: &Gpu, dispatches: &[Dispatch], result: &wgpu::Buffer, readback: &Readback) {
    let mut encoder = gpu.encoder("Kamencay's method");
    for dispatch in dispatches {
        dispatch.record(&mut encoder);
    }
    readback.record(&mut encoder, result);
    gpu.queue.submit([encoder.finish()]);
}
