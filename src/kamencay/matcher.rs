//! The hybrid method on a device.

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

/// Matches a pair on `gpu`.
///
/// # Errors
/// [`crate::Error::SizesDiffer`]; [`crate::Error::Parameter`] for a configuration that cannot be;
/// [`crate::Error::TooLarge`] for rows too wide for a strip, or a picture that the device cannot bind; and what the
/// device says.
pub async fn compute(gpu: &Gpu, left: &Picture, right: &Picture, config: &KamencayConfig) -> Result<Dense> {
    compute_within(gpu, left, right, config, MAX_MESSAGE_BYTES).await
}

/// As [`compute`], in strips whose messages take at most `message_bytes`, of which no more than
/// [`MAX_MESSAGE_BYTES`] count: less memory for more work, and a slightly different result.
///
/// # Errors
/// As [`compute`].
pub async fn compute_within(
    gpu: &Gpu,
    left: &Picture,
    right: &Picture,
    config: &KamencayConfig,
    message_bytes: u64,
) -> Result<Dense> {
    solve(left, right, config, message_bytes, &mut OnDevice { gpu, prepared: None }).await
}

/// The kernels and the views, once they are there.
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
            // A grid's messages are needed until those of the next finer one have been sent once.
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

/// Runs `dispatches`, then reads `result`.
fn submit(gpu: &Gpu, dispatches: &[Dispatch], result: &wgpu::Buffer, readback: &Readback) {
    let mut encoder = gpu.encoder("Kamencay's method");
    for dispatch in dispatches {
        dispatch.record(&mut encoder);
    }
    readback.record(&mut encoder, result);
    gpu.queue.submit([encoder.finish()]);
}
