//! Exact nearest-neighbour search: for every feature of one view the nearest descriptor of the other, by brute force.
//!
//! Both lists are first sorted by contrast and row, so that the candidates of a feature are one range of the other
//! list. Candidates are stored in blocks of [`LANES`] with their values interleaved, and [`QUERIES`] features are
//! compared with a block at a time: the inner loop is then plain multiply-and-add over whole registers without any
//! horizontal sum. The registers are glam's, because the compiler's own vectorisation of plain arrays reached a quarter
//! of the speed. The order of the additions is fixed, so that results do not depend on the machine or the number of
//! threads.

use std::ops::Range;

use glam::Vec4;
use rayon::prelude::*;

use super::MatchConfig;
use crate::features::{DESCRIPTOR_LENGTH, Feature};

/// Number of candidates per register.
const WIDTH: usize = 4;
/// Number of candidates per block.
const LANES: usize = 2 * WIDTH;
/// Number of features that are compared with a block at a time: 4 x 8 sums just fit the registers of SSE2 and NEON.
const QUERIES: usize = 4;

/// One value per candidate of a block.
type Lanes = [Vec4; LANES / WIDTH];

/// Radius around the nearest feature, in units of its scale, within which other detections show the same structure and
/// are no rivals.
const RIVAL_RADIUS: f32 = 3.0;

/// The nearest descriptor and its rival.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    /// Index of the feature in the other view.
    pub index: usize,
    /// Euclidean distance of the descriptors.
    pub distance: f32,
    /// Distance to the nearest descriptor of another structure; infinite if there is none.
    pub rival: f32,
}

/// For every query its nearest candidate that satisfies `config`, which takes the queries as the left view; `None` if
/// there is no such candidate.
pub(super) fn nearest(queries: &[Feature], candidates: &[Feature], config: &MatchConfig) -> Vec<Option<Nearest>> {
    let order = sorted(queries, config.same_contrast);
    let candidates = Candidates::new(candidates, config);
    let found: Vec<[Option<Nearest>; QUERIES]> = order
        .par_chunks(QUERIES)
        .map_init(Scratch::default, |scratch, group| candidates.meet(queries, group, scratch))
        .collect();
    let mut result = vec![None; queries.len()];
    for (group, found) in order.chunks(QUERIES).zip(found) {
        for (&query, nearest) in group.iter().zip(found) {
            result[query] = nearest;
        }
    }
    result
}

/// Indices of the features with a finite position and a usable descriptor, sorted by contrast (if it matters) and row.
fn sorted(features: &[Feature], same_contrast: bool) -> Vec<usize> {
    let numbers =
        |f: &Feature| f.x.is_finite() && f.y.is_finite() && f.descriptor.iter().all(|value| value.is_finite());
    let usable = |f: &Feature| numbers(f) && f.descriptor.iter().any(|&value| value != 0.0);
    let mut order: Vec<usize> = (0..features.len()).filter(|&i| usable(&features[i])).collect();
    let key = |i: usize| same_contrast && features[i].dark;
    order.sort_by(|&a, &b| key(a).cmp(&key(b)).then(features[a].y.total_cmp(&features[b].y)).then(a.cmp(&b)));
    order
}

/// Distances of one group of queries to all blocks of their candidate range.
#[derive(Default)]
struct Scratch {
    /// Squared distances by query, then candidate of the range.
    squared: [Vec<Lanes>; QUERIES],
    /// Smallest squared distance by query, then block.
    least: [Vec<f32>; QUERIES],
}

struct Candidates<'a> {
    features: &'a [Feature],
    config: &'a MatchConfig,
    order: Vec<usize>,
    blocks: Vec<[Lanes; DESCRIPTOR_LENGTH]>,
}

impl<'a> Candidates<'a> {
    fn new(features: &'a [Feature], config: &'a MatchConfig) -> Self {
        let order = sorted(features, config.same_contrast);
        let blocks = order
            .chunks(LANES)
            .map(|members| {
                let mut block = [[Vec4::INFINITY; LANES / WIDTH]; DESCRIPTOR_LENGTH];
                for (lane, &member) in members.iter().enumerate() {
                    for (values, &value) in block.iter_mut().zip(&features[member].descriptor) {
                        values[lane / WIDTH][lane % WIDTH] = value;
                    }
                }
                block
            })
            .collect();
        Self { features, config, order, blocks }
    }

    fn meet(&self, queries: &[Feature], group: &[usize], scratch: &mut Scratch) -> [Option<Nearest>; QUERIES] {
        let members: [&Feature; QUERIES] = std::array::from_fn(|i| &queries[group[i.min(group.len() - 1)]]);
        let stretch = self.stretch(members[0], members[QUERIES - 1]);
        let blocks = stretch.start / LANES..stretch.end.div_ceil(LANES);
        for (squared, least) in scratch.squared.iter_mut().zip(&mut scratch.least) {
            squared.clear();
            least.clear();
        }
        for block in &self.blocks[blocks.clone()] {
            let sums = squared_distances(members.map(|member| &member.descriptor), block);
            for (query, sums) in sums.into_iter().enumerate() {
                scratch.least[query].push(sums[0].min(sums[1]).min_element());
                scratch.squared[query].push(sums);
            }
        }
        std::array::from_fn(|query| {
            let row = Row {
                candidates: self,
                first: blocks.start,
                squared: &scratch.squared[query],
                least: &scratch.least[query],
            };
            row.nearest(members[query])
        })
    }

    /// The range in `order` of the candidates for the sorted queries from `first` to `last`.
    fn stretch(&self, first: &Feature, last: &Feature) -> Range<usize> {
        let reach = self.config.max_dy.unwrap_or(f32::INFINITY);
        let before = |limit: &Feature, past: bool| {
            self.order.partition_point(|&i| {
                let candidate = &self.features[i];
                let contrast = self.config.same_contrast.then(|| candidate.dark.cmp(&limit.dark));
                let row = if past { candidate.y <= limit.y + reach } else { candidate.y < limit.y - reach };
                contrast.map_or(row, |contrast| contrast.is_lt() || contrast.is_eq() && row)
            })
        };
        before(first, false)..before(last, true).max(before(first, false))
    }

    fn accepts(&self, query: &Feature, candidate: &Feature) -> bool {
        let disparity = query.x - candidate.x;
        (!self.config.same_contrast || query.dark == candidate.dark)
            && self.config.max_dy.is_none_or(|max_dy| (query.y - candidate.y).abs() <= max_dy)
            && self
                .config
                .disparities
                .is_none_or(|range| disparity >= range.min as f32 && disparity <= range.last() as f32)
    }
}

fn squared_distances(
    queries: [&[f32; DESCRIPTOR_LENGTH]; QUERIES],
    block: &[Lanes; DESCRIPTOR_LENGTH],
) -> [Lanes; QUERIES] {
    let mut sums = [[Vec4::ZERO; LANES / WIDTH]; QUERIES];
    for (k, values) in block.iter().enumerate() {
        for (query, sums) in queries.iter().zip(&mut sums) {
            let query_value = Vec4::splat(query[k]);
            for (sum, &value) in sums.iter_mut().zip(values) {
                let difference = query_value - value;
                *sum += difference * difference;
            }
        }
    }
    sums
}

/// Distances of one query to its candidate range.
struct Row<'a> {
    candidates: &'a Candidates<'a>,
    first: usize,
    squared: &'a [Lanes],
    least: &'a [f32],
}

impl Row<'_> {
    fn nearest(&self, query: &Feature) -> Option<Nearest> {
        let all = self.candidates;
        let (index, squared) = self.smallest(|i| all.accepts(query, &all.features[i]))?;
        let best = &all.features[index];
        let radius = RIVAL_RADIUS * best.scale;
        let rival = self.smallest(|i| {
            let other = &all.features[i];
            let apart = (other.x - best.x).powi(2) + (other.y - best.y).powi(2) > radius * radius;
            apart && all.accepts(query, other)
        });
        Some(Nearest { index, distance: squared.sqrt(), rival: rival.map_or(f32::INFINITY, |(_, d)| d.sqrt()) })
    }

    /// The candidate with the smallest squared distance among those that `admit` accepts; among equals the lowest
    /// index.
    fn smallest(&self, admit: impl Fn(usize) -> bool) -> Option<(usize, f32)> {
        let mut best: Option<(usize, f32)> = None;
        for (block, (squared, &least)) in self.squared.iter().zip(self.least).enumerate() {
            if best.is_some_and(|(_, distance)| least > distance) {
                continue;
            }
            let start = (self.first + block) * LANES;
            let members = &self.candidates.order[start..(start + LANES).min(self.candidates.order.len())];
            for (&member, distance) in members.iter().zip(squared.iter().flat_map(Vec4::to_array)) {
                let closer = match best {
                    None => distance < f32::INFINITY,
                    Some((index, least)) => distance < least || distance == least && member < index,
                };
                if closer && admit(member) {
                    best = Some((member, distance));
                }
            }
        }
        best
    }
}
