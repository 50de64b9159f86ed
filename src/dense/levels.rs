//! Matching over a pyramid on a device, level by level: what a level searches, and the memory that it takes, depends on the
//! map of the level above, which is read back.

use super::{
    config::DenseConfig,
    kernels::{Halve, Loss},
    map::Dense,
    outputs::{Disparities, Outputs},
    plan::{BandLimits, LevelKernels, LevelTask},
    pyramid::{CellTable, Level, Pyramid, filters},
    readback::MapReadback,
    uploaded::{Masks, UploadedPair},
};
use crate::{
    error::Result,
    gpu::{Gpu, Readback, buffer_limit, guarded, storage_buffer},
    image::Size,
    luma::packed_bytes,
};

/// Most bytes of the volumes of a band: more take no less time.
const MOST_BYTES: u64 = 1 << 27;

/// The matching's part of the work on a level that is refined.
const MATCHING: f32 = 0.7;

/// Matches a `pair` over `pyramid`, in bands of at most `band_rows` rows, and calls `progress` with the share of the
/// work that is done, 0 to 1. Holes are filled by the colours of the reference view.
pub(super) async fn compute(
    gpu: &Gpu,
    pair: UploadedPair,
    config: &DenseConfig,
    pyramid: &Pyramid,
    band_rows: u32,
    mut progress: impl FnMut(f32),
) -> Result<Dense> {
    let pairs = halved(gpu, pair, pyramid.levels()).await?;
    let kernels = guarded(gpu, "dense matching", || Ok(LevelKernels::new(gpu, config))).await?;
    let limits = BandLimits { bytes: buffer_limit(gpu).min(MOST_BYTES), rows: band_rows };
    let (coarse_filters, refinement) = (filters(), config.parameters.refinement.as_ref().map(Into::into));
    // A level has four times the pixels of the level above.
    let work: f32 = (0..pyramid.levels().len()).map(|level| 0.25_f32.powi(level as i32)).sum();
    let mut done = 0.0;
    let mut map = None;
    for (number, (level, pair)) in pyramid.levels().iter().zip(&pairs).enumerate().rev() {
        let table = match &map {
            None => CellTable::whole(level.size, level.range),
            Some(Dense { disparity, .. }) => CellTable::below(disparity, level.size, level.range),
        };
        drop(map);
        log::debug!("{:?}: {:.1} % of the disparities", level.size, 100.0 * table.share());
        let filters = if number > 0 { Some(&coarse_filters) } else { refinement.as_ref() };
        let config = if number > 0 { level.coarse(config) } else { level.finest(config) };
        let task = LevelTask { config: &config, table: &table, filters, pair };
        let part = 0.25_f32.powi(number as i32) / work;
        map = Some(matched(gpu, &kernels, task, limits, |share| progress(done + part * share)).await?);
        done += part;
    }
    Ok(map.expect("a pyramid has a level"))
}

/// The pairs of all levels, the finest first, which alone has colours. On the others, a disparity whose partner is hidden is none.
async fn halved(gpu: &Gpu, pair: UploadedPair, levels: &[Level]) -> Result<Vec<UploadedPair>> {
    gpu.with_room("the pyramid", || {
        let halve = Halve::new(gpu);
        let mut pairs = vec![pair.clone()];
        let mut encoder = gpu.encoder("pyramid");
        for sizes in levels.windows(2) {
            let mut half = |picture: &wgpu::Buffer| -> Result<wgpu::Buffer> {
                let half = storage_buffer(gpu, "half the picture", packed_bytes(sizes[1].size))?;
                halve.prepare(sizes[0].size, picture, &half).record(&mut encoder);
                Ok(half)
            };
            let UploadedPair { luma: [left, right], masks, .. } = &pairs[pairs.len() - 1];
            let luma = [half(left)?, half(right)?];
            let masks = match masks {
                Some(Masks { own, other, .. }) => {
                    Some(Masks { own: half(own)?, other: half(other)?, loss: Loss::Disparity })
                }
                None => None,
            };
            pairs.push(UploadedPair { luma, colours: None, masks });
        }
        gpu.queue.submit([encoder.finish()]);
        Ok(pairs)
    })
    .await
}

/// The map of a level.
async fn matched(
    gpu: &Gpu,
    kernels: &LevelKernels,
    task: LevelTask<'_>,
    limits: BandLimits,
    mut progress: impl FnMut(f32),
) -> Result<Dense> {
    let size = task.table.size;
    let (matching, mut readback) = gpu
        .with_room("dense matching", || {
            let plan = kernels.plan(gpu, task, limits)?;
            Ok((plan, readback(gpu, size, &task.pair.luma[0])))
        })
        .await?;
    let part = if task.goes_on() { MATCHING } else { 1.0 };
    matching.run_by_parts(readback.outputs(), |share| progress(part * share)).await?;
    // The volumes are free before the map is refined, and read.
    if let Some(map) = matching.into_map() {
        let refinement = gpu.with_room("dense matching", || task.plan_refinement(gpu, map.clone(), limits)).await?;
        let after = |share| progress(part + (1.0 - part) * share);
        refinement.run_by_parts(readback.outputs(), after).await?;
    }
    readback.read().await
}

fn readback(gpu: &Gpu, size: Size, luma: &wgpu::Buffer) -> MapReadback {
    let disparities = Readback::new(gpu, "disparities", 4 * size.pixels());
    let confidences = Readback::new(gpu, "confidences", packed_bytes(size));
    let outputs = Outputs {
        disparities: Disparities::Buffer(disparities.buffer().clone()),
        confidences: Some(confidences.buffer().clone()),
        matcher: luma.clone(),
        back: None,
    };
    MapReadback { size, outputs, disparities, confidences }
}
