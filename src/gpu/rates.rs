//! What a device can do at most: the rates of its memory and of its integers, measured.

use std::time::Duration;

use super::{Binding, Dispatch, Gpu, Kernel, Stage, Stopwatch, guarded, storage_buffer};
use crate::error::Result;

/// Threads per workgroup.
const WORKGROUP: u32 = 256;

/// Bytes that are copied: more than caches hold.
const COPIED_BYTES: u64 = 1 << 27;

/// Threads that calculate, and their rounds.
const THREADS: u32 = 1 << 18;
const ROUNDS: u32 = 256;

/// Additions and minima of a round: four chains of four lanes, with one addition and one minimum each, and one addition more.
const OPERATIONS: u32 = 4 * (4 * 2 + 1);

/// Runs of each kernel, of which the fastest counts.
const RUNS: usize = 5;

/// The measured rates of a device, with which those of a kernel are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// Bytes per second that a kernel reads and writes when it copies.
    pub copied: f64,
    /// Additions and minima of 32-bit integers per second.
    pub operations: f64,
}

impl Rates {
    /// Measures the rates of the device of `gpu`.
    ///
    /// # Errors
    /// [`crate::Error::Unsupported`] without [`wgpu::Features::TIMESTAMP_QUERY`]; [`crate::Error::OutOfMemory`],
    /// [`crate::Error::DeviceLost`].
    pub async fn measure(gpu: &Gpu) -> Result<Self> {
        let bytes = COPIED_BYTES.min(super::buffer_limit(gpu)) / 4096 * 4096;
        let (copy, calculation) = guarded(gpu, "rates", || {
            let source = storage_buffer(gpu, "copied from", bytes)?;
            let target = storage_buffer(gpu, "copied to", bytes)?;
            let results = storage_buffer(gpu, "results", 16 * u64::from(THREADS))?;
            let copy = copying(gpu, &source, &target);
            let calculation = Kernel::new(gpu, &integers()).dispatch(&(), &[&results], [THREADS / WORKGROUP, 1, 1]);
            Ok((copy, calculation))
        })
        .await?;
        let operations = u64::from(THREADS) * u64::from(ROUNDS) * u64::from(OPERATIONS);
        Ok(Self {
            copied: 2.0 * bytes as f64 / least_time(gpu, &copy).await?.as_secs_f64(),
            operations: operations as f64 / least_time(gpu, &calculation).await?.as_secs_f64(),
        })
    }
}

/// The copy of `source`, a multiple of 4096 bytes, to `target`.
fn copying(gpu: &Gpu, source: &wgpu::Buffer, target: &wgpu::Buffer) -> Dispatch {
    let groups = (source.size() / 16) as u32 / WORKGROUP;
    Kernel::new(gpu, &copy()).dispatch(&(), &[source, target], [groups, 1, 1])
}

fn copy() -> Stage {
    Stage {
        name: "copy",
        source: include_str!("../../shaders/rates/copy.wgsl"),
        bindings: &[Binding::Read, Binding::Write],
        constants: vec![("WORKGROUP", WORKGROUP.into())],
    }
}

fn integers() -> Stage {
    Stage {
        name: "integers",
        source: include_str!("../../shaders/rates/integers.wgsl"),
        bindings: &[Binding::Write],
        constants: vec![("WORKGROUP", WORKGROUP.into()), ("ROUNDS", ROUNDS.into())],
    }
}

/// The least time of several runs; the first one compiles.
async fn least_time(gpu: &Gpu, dispatch: &Dispatch) -> Result<Duration> {
    let stopwatch = Stopwatch::new(gpu, 1)?;
    let mut least = Duration::MAX;
    for _ in 0..RUNS {
        guarded(gpu, "rates", || {
            let mut encoder = gpu.encoder("rates");
            super::record_run(&mut encoder, [dispatch], stopwatch.writes(0));
            stopwatch.resolve(&mut encoder);
            gpu.queue.submit([encoder.finish()]);
            Ok(())
        })
        .await?;
        least = least.min(stopwatch.read(&gpu.queue).await?[0]);
    }
    // A clock too coarse for the work gives no rate of infinity.
    Ok(least.max(Duration::from_nanos(1)))
}

#[cfg(all(test, feature = "verify"))]
mod tests {
    use super::*;
    use crate::{gpu::DeviceChoice, verify::Bench};

    #[test]
    fn all_that_is_counted_is_copied() {
        let gpu = Gpu::open(&DeviceChoice::Best).expect("this test needs a device; lavapipe is one");
        let bench = Bench::new(&gpu);
        let words: Vec<u32> = (0..3 * 1024).map(|index| u32::wrapping_mul(index, 2_654_435_761)).collect();
        let (source, target) = (bench.upload(&words).unwrap(), bench.output(words.len() as u32).unwrap());
        let dispatch = copying(&gpu, &source, &target);
        bench.run(|encoder| dispatch.record(encoder));
        assert!(bench.download::<u32>(&target).unwrap() == words);
    }
}
