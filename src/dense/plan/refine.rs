//! Refinement: what makes a whole map of one with holes and speckles.
//!
//! residuals and support -> weighted medians of what is left -> filling -> a weighted median of what was filled ->
//! weighted medians of all -> a plain median.

use super::{BandLimits, CopyTarget, Plan, Whole, WordCopy, match_words};
use crate::{
    dense::{
        config::{Median, Refinement, View},
        kernels::{Fill, Residual, SUPPORT_RADIUS, Support, Views, WeightedMedian},
    },
    disparity::DisparityRange,
    error::{Error, Result},
    gpu::{BUFFER_LIMITS, Gpu, in_rows, most_words},
};

/// Refines the `whole` map of a view, and hands the result out.
///
/// Where the map does not fit in buffers that the `limits` allow, that is done in
/// windows of rows, each with so many more around it that what is handed out is the same.
#[expect(clippy::too_many_arguments, reason = "what is refined, how, and within which limits")]
pub(super) fn plan_refinement(
    gpu: &Gpu,
    plan: &mut Plan,
    (width, height): (u32, u32),
    refinement: &Refinement,
    range: DisparityRange,
    views: Views<'_>,
    whole: &Whole,
    limits: BandLimits,
) -> Result<()> {
    let around =
        SUPPORT_RADIUS + refinement.before().chain(refinement.after()).map(|median| median.radius).sum::<u32>();
    // A map with holes is a texture as well.
    let fitting = (limits.bytes / (4 * match_words(width, 1).0)).min(most_words(gpu) / u64::from(width));
    let fitting = u32::try_from(fitting).unwrap_or(u32::MAX);
    let rows = if fitting >= height { height } else { fitting.saturating_sub(2 * around) }.min(limits.rows);
    if rows == 0 {
        return Err(Error::TooLarge {
            what: format!("the refinement of rows {width} px wide"),
            needed: 4 * match_words(width, 2 * around + 1).0,
            limit: limits.bytes,
            way_out: format!("refine less, scale the pictures down, or use a device with more of {BUFFER_LIMITS}"),
        });
    }
    let window_rows = (rows + 2 * around).min(height);
    let (words, _) = match_words(width, window_rows);
    let pixels = u64::from(width) * u64::from(window_rows);
    let words = words.max(in_rows(pixels));
    let given = plan.buffer("disparities to refine", words)?;
    let supported = plan.buffer("supported disparities", words)?;
    let with_holes = match refinement.fill {
        true => Some(plan.word_texture("disparities with holes", pixels)?),
        false => None,
    };
    let filtered = plan.buffer("filtered disparities", pixels)?;
    let residuals = plan.buffer("residuals", u64::from(width.div_ceil(4)) * u64::from(window_rows))?;
    let (residual, support, fill) = (Residual::new(gpu), Support::new(gpu, refinement.support), Fill::new(gpu));
    let [left, right] = views.luma;
    let luma = if views.reference == View::Left { left } else { right };
    // Most filters are alike: each kernel is compiled once, and a filter is its place here.
    let mut kernels: Vec<(Median, WeightedMedian)> = Vec::new();
    let mut place = |median: Median| {
        kernels.iter().position(|(known, _)| *known == median).unwrap_or_else(|| {
            kernels.push((median, WeightedMedian::new(gpu, median)));
            kernels.len() - 1
        })
    };
    let before: Vec<usize> = refinement.before().map(&mut place).collect();
    let after: Vec<usize> = refinement.after().map(&mut place).collect();

    for first_row in (0..height).step_by(rows as usize) {
        let kept = rows.min(height - first_row);
        let top = first_row.saturating_sub(around);
        let size = (width, (first_row + kept + around).min(height) - top);
        let (_, confidence_offset) = match_words(width, size.1);
        for (from, row, to_word) in
            [(&whole.disparities, width, 0), (&whole.confidences, width.div_ceil(4), confidence_offset)]
        {
            let row = u64::from(row);
            let (from_word, words) = (row * u64::from(top), row * u64::from(size.1));
            let to = CopyTarget::Buffer(given.clone());
            plan.copy(WordCopy { from: from.clone(), from_word, to, to_word: to_word.into(), words });
        }
        plan.run(residual.prepare(size, top, views, &given, &residuals));
        plan.run(support.prepare(size, confidence_offset, [&given, &residuals], &supported));

        // The map that a filter reads, and two others. The confidences stand behind the supported disparities and
        // stay there.
        let mut maps = [&supported, &given, &filtered];
        let filter = |place: usize, [disparities, before, to]: [&wgpu::Buffer; 3]| {
            kernels[place].1.prepare(size, (luma, top), [disparities, before], to)
        };
        for &place in &before {
            plan.run(filter(place, [maps[0], maps[0], maps[1]]));
            maps.swap(0, 1);
        }
        if let Some(with_holes) = &with_holes {
            plan.fill_texture(maps[0], with_holes);
            plan.run(fill.prepare(size, range, with_holes, maps[1]));
            // Those with holes stay until they are filtered by.
            maps.swap(0, 1);
        }
        for &place in &after {
            plan.run(filter(place, maps));
            maps.swap(0, 2);
        }
        let (skipped, cw) = (u64::from(first_row - top), width.div_ceil(4));
        for (from, start, row, to) in
            [(maps[0], 0, width, CopyTarget::Disparities), (&supported, confidence_offset, cw, CopyTarget::Confidences)]
        {
            let row = u64::from(row);
            let from_word = u64::from(start) + row * skipped;
            let (to_word, words) = (row * u64::from(first_row), row * u64::from(kept));
            plan.copy(WordCopy { from: from.clone(), from_word, to, to_word, words });
        }
    }
    Ok(())
}
