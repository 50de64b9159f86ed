//! Refinement: the plan from a map with holes and speckles to a complete one.
//!
//! residuals and support -> weighted medians of the supported disparities -> filling -> a weighted median of the filled
//! pixels -> weighted medians of all pixels -> a plain median.

use super::{BandLimits, Plan, WholeMap};
use crate::{
    dense::{
        config::{Filters, Median, View},
        kernels::{ComparedViews, Fill, MapBuffer, MapLayout, Residual, SUPPORT_RADIUS, Support, WeightedMedian},
        word_copy::{CopyTarget, WordCopy},
    },
    disparity::DisparityRange,
    error::{Error, Result},
    gpu::{BUFFER_LIMITS, Gpu, in_rows, most_words},
    image::Size,
};

/// A map to be refined.
pub(super) struct Unrefined<'a> {
    /// The map of all bands.
    pub(super) map: &'a WholeMap,
    /// Width and height of the map.
    pub(super) size: Size,
    /// The searched disparities; filled pixels stay within them.
    pub(super) range: DisparityRange,
    /// Both views, and the reference view, to which the map belongs.
    pub(super) views: ComparedViews<'a>,
}

/// The weighted-median kernels of a refinement. Most filters share their parameters, and each kernel is compiled once.
struct Medians(Vec<(Median, WeightedMedian)>);

impl Medians {
    fn new(gpu: &Gpu, filters: &Filters) -> Self {
        let mut kernels: Vec<(Median, WeightedMedian)> = Vec::new();
        for &median in filters.before.iter().chain(&filters.after) {
            if kernels.iter().all(|(known, _)| *known != median) {
                kernels.push((median, WeightedMedian::new(gpu, median)));
            }
        }
        Self(kernels)
    }

    fn get(&self, median: Median) -> &WeightedMedian {
        let kernel = self.0.iter().find(|(known, _)| *known == median);
        &kernel.expect("a kernel for each filter of the refinement").1
    }
}

/// Plans the refinement of a map of all bands, and its copies to the caller's outputs.
///
/// A map that exceeds `limits` is refined in windows of rows, with a halo of as many rows as the filters reach; the
/// result does not depend on where windows are cut.
pub(super) fn plan_refinement(
    gpu: &Gpu,
    plan: &mut Plan,
    filters: &Filters,
    Unrefined { map, size: Size { width, height }, range, views }: Unrefined<'_>,
    limits: BandLimits,
) -> Result<()> {
    let halo = SUPPORT_RADIUS + filters.before.iter().chain(&filters.after).map(|median| median.radius).sum::<u32>();
    let rows = window_rows(gpu, Size { width, height }, halo, limits)?;
    let largest = MapLayout { width, rows: (rows + 2 * halo).min(height) };
    let pixels = u64::from(largest.pixels());
    let words = largest.words().max(in_rows(pixels));
    let unrefined = plan.buffer("disparities to refine", words)?;
    let supported = plan.buffer("supported disparities", words)?;
    let with_holes = match filters.fill {
        true => Some(plan.word_texture("disparities with holes", pixels)?),
        false => None,
    };
    let filtered = plan.buffer("filtered disparities", pixels)?;
    let residuals = plan.buffer("residuals", u64::from(width.div_ceil(4)) * u64::from(largest.rows))?;
    let (residual, support, fill) = (Residual::new(gpu), Support::new(gpu, filters.support), Fill::new(gpu));
    let medians = Medians::new(gpu, filters);
    let [left, right] = views.luma;
    let luma = if views.reference == View::Left { left } else { right };

    for first_row in (0..height).step_by(rows as usize) {
        let result_rows = rows.min(height - first_row);
        let top = first_row.saturating_sub(halo);
        let layout = MapLayout { width, rows: (first_row + result_rows + halo).min(height) - top };
        let (size, confidence_offset) = (Size::new(width, layout.rows), u64::from(layout.confidence_offset()));
        let parts = [(&map.disparities, width, 0), (&map.confidences, width.div_ceil(4), confidence_offset)];
        for (from, row_words, to_word) in parts {
            let row_words = u64::from(row_words);
            let (from_word, words) = (row_words * u64::from(top), row_words * u64::from(layout.rows));
            let to = CopyTarget::Buffer(unrefined.clone());
            plan.copy(WordCopy { from: from.clone(), from_word, to, to_word, words });
        }
        plan.run(residual.prepare(size, top, views, &unrefined, &residuals));
        plan.run(support.prepare(MapBuffer { buffer: &unrefined, layout }, &residuals, &supported));

        // The map that the next filter reads, and two more. Confidences stay behind the supported disparities.
        let mut maps = [&supported, &unrefined, &filtered];
        let filter = |median: Median, [disparities, before, to]: [&wgpu::Buffer; 3]| {
            medians.get(median).prepare(size, (luma, top), [disparities, before], to)
        };
        for &median in &filters.before {
            plan.run(filter(median, [maps[0], maps[0], maps[1]]));
            maps.swap(0, 1);
        }
        if let Some(with_holes) = &with_holes {
            plan.fill_texture(maps[0], with_holes);
            plan.run(fill.prepare(size, range, with_holes, maps[1]));
            // Later filters read the map with holes to recognise filled pixels.
            maps.swap(0, 1);
        }
        for &median in &filters.after {
            plan.run(filter(median, maps));
            maps.swap(0, 2);
        }
        let skipped = u64::from(first_row - top);
        for (from, start, row_words, to) in [
            (maps[0], 0, width, CopyTarget::Disparities),
            (&supported, confidence_offset, width.div_ceil(4), CopyTarget::Confidences),
        ] {
            let row_words = u64::from(row_words);
            let from_word = start + row_words * skipped;
            let (to_word, words) = (row_words * u64::from(first_row), row_words * u64::from(result_rows));
            plan.copy(WordCopy { from: from.clone(), from_word, to, to_word, words });
        }
        plan.checkpoint();
    }
    Ok(())
}

/// The most rows of the result per window, with `halo` rows on either side.
fn window_rows(gpu: &Gpu, Size { width, height }: Size, halo: u32, limits: BandLimits) -> Result<u32> {
    let row_bytes = |rows: u32| 4 * MapLayout { width, rows }.words();
    // The map with holes is also copied to a texture.
    let fitting = (limits.bytes / row_bytes(1)).min(most_words(gpu) / u64::from(width));
    let fitting = u32::try_from(fitting).unwrap_or(u32::MAX);
    let rows = if fitting >= height { height } else { fitting.saturating_sub(2 * halo) }.min(limits.rows);
    if rows > 0 {
        return Ok(rows);
    }
    Err(Error::TooLarge {
        what: format!("the refinement of rows {width} px wide"),
        needed: row_bytes(2 * halo + 1),
        limit: limits.bytes,
        way_out: format!("refine less, scale the pictures down, or use a device with more of {BUFFER_LIMITS}"),
    })
}
