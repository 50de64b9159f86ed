//! Refinement: what makes a whole map of one with holes and speckles.
//!
//! support -> weighted medians of what is left -> filling -> a weighted median of what was filled ->
//! weighted medians of all -> a plain median.

use super::{
    fill::Fill,
    plan::{Copy, Plan, Target, match_words},
    support::Support,
    weighted_median::{Median, WeightedMedian},
};
use crate::{disparity::DisparityRange, error::Result};

/// What is done with a map after its checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refinement {
    /// How many pixels of the 7x7 around one must have its disparity within a pixel, itself included, for it to
    /// stay; 0 to 49.
    pub support: u32,
    /// How often what stays is filtered by a 5x5 weighted median.
    pub medians_before: u32,
    /// Whether holes are filled.
    pub fill: bool,
    /// Whether what was filled is filtered by a 9x9 weighted median of its own.
    pub median_of_filled: bool,
    /// How often all is filtered by a 5x5 weighted median, before a plain one of 3x3.
    pub medians_after: u32,
}

impl Refinement {
    /// The filters before holes are filled.
    pub fn before(&self) -> impl Iterator<Item = Median> + use<> {
        (0..self.medians_before).map(|_| Median { radius: 2, halving_bits: 3, holes_only: false })
    }

    /// The filters after that.
    pub fn after(&self) -> impl Iterator<Item = Median> + use<> {
        let filled = Median { radius: 4, halving_bits: 3, holes_only: true };
        let all = Median { radius: 2, halving_bits: 3, holes_only: false };
        let plain = Median { radius: 1, halving_bits: 31, holes_only: false };
        let medians_after = (0..self.medians_after).map(move |_| all);
        (self.fill && self.median_of_filled).then_some(filled).into_iter().chain(medians_after).chain([plain])
    }
}

/// Maps on their way from one filter to the next: the one that a filter reads, and two others.
struct Maps([wgpu::Buffer; 3]);

/// Refines `matches`, of all rows of the reference view, whose packed `luma` is given, and hands the result out.
pub(super) fn plan_refinement(
    device: &wgpu::Device,
    plan: &mut Plan,
    size: (u32, u32),
    refinement: &Refinement,
    range: DisparityRange,
    luma: &wgpu::Buffer,
    matches: &wgpu::Buffer,
) -> Result<()> {
    let (width, height) = size;
    let (words, confidence_offset) = match_words(width, height);
    let pixels = u64::from(width) * u64::from(height);
    let supported = plan.buffer(device, "supported disparities", words)?;
    plan.run(Support::new(device, refinement.support).prepare(device, size, confidence_offset, matches, &supported));
    // What was matched is not needed any more.
    let mut maps = Maps([supported.clone(), matches.clone(), plan.buffer(device, "filtered disparities", pixels)?]);
    plan.copy(Copy {
        from: supported.clone(),
        from_word: confidence_offset.into(),
        to: Target::Confidences,
        to_word: 0,
        words: words - u64::from(confidence_offset),
    });
    for median in refinement.before() {
        let Maps([from, to, _]) = &maps;
        plan.run(WeightedMedian::new(device, median).prepare(device, size, luma, [from, from], to));
        maps.0.swap(0, 1);
    }
    if refinement.fill {
        let Maps([from, to, _]) = &maps;
        plan.run(Fill::new(device).prepare(device, size, range, from, to));
        // Those with holes stay until they are filtered by.
        maps.0.swap(0, 1);
    }
    for median in refinement.after() {
        let Maps([from, before, to]) = &maps;
        plan.run(WeightedMedian::new(device, median).prepare(device, size, luma, [from, before], to));
        maps.0.swap(0, 2);
    }
    plan.copy(Copy { from: maps.0[0].clone(), from_word: 0, to: Target::Disparities, to_word: 0, words: pixels });
    Ok(())
}
