//! The weights of links between neighbours, on the host.

use super::{Segments, Strip};
use crate::image::{Plane, Size};

/// The weight of a link, 0 to 16: `16 halving / (halving + change)`, rounded down, where `change` is the mean
/// difference of the three channels, in grey levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkWeights {
    /// The change that halves the weight, 1 to 255 grey levels; 8 by default.
    pub halving: u32,
    /// Lower bound of the weight, 0 to 16; 2 by default.
    pub least: u32,
    /// Lower bound of the weight inside a segment, 0 to 16; 8 by default.
    pub inside: u32,
    /// Upper bound of the weight across the outline of a segment, 0 to 16; 4 by default.
    pub across: u32,
}

/// The weights of a grid's links: to the right in the lowest byte, downwards in the next. Links that lead outside weigh
/// 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Links(Plane<u32>);

impl Links {
    /// The links of a strip of a view from [`super::described`].
    pub fn new(view: &Plane<u32>, segments: &Segments, strip: Strip, weights: LinkWeights) -> Self {
        let labels = segments.labels();
        let weight = |a: (u32, u32), b: (u32, u32)| {
            let channels = |(x, y)| view.get(x, y).to_le_bytes();
            let (own, other) = (channels(a), channels(b));
            let change = (0..3).map(|c| u32::from(own[c].abs_diff(other[c]))).sum::<u32>() / 3;
            let weight = (16 * weights.halving / (weights.halving + change)).max(weights.least);
            if labels.get(a.0, a.1) == labels.get(b.0, b.1) {
                weight.max(weights.inside)
            } else {
                weight.min(weights.across)
            }
        };
        let link = |x: u32, y: u32| {
            let row = strip.first_row + y;
            let right = if x + 1 < view.width() { weight((x, row), (x + 1, row)) } else { 0 };
            let below = if y + 1 < strip.rows { weight((x, row), (x, row + 1)) } else { 0 };
            right | below << 8
        };
        Self(Plane::from_fn((view.width(), strip.rows), link))
    }

    /// The links of the grid of half the size: the rounded mean of the links between two blocks of 2x2 nodes.
    #[must_use]
    pub fn reduced(&self) -> Self {
        let Size { width, height } = self.0.size();
        let mean = |nodes: &mut dyn Iterator<Item = (u32, u32)>, shift: u32| {
            let (mut sum, mut count) = (0, 0);
            for (x, y) in nodes {
                sum += self.0.get(x, y) >> shift & 255;
                count += 1;
            }
            (sum + count / 2) / count
        };
        let link = |x: u32, y: u32| {
            let (columns, rows) = (2 * x..(2 * x + 2).min(width), 2 * y..(2 * y + 2).min(height));
            let right = if columns.end < width { mean(&mut rows.map(|y| (2 * x + 1, y)), 0) } else { 0 };
            let below = if 2 * y + 2 < height { mean(&mut columns.map(|x| (x, 2 * y + 1)), 8) } else { 0 };
            right | below << 8
        };
        Self(Plane::from_fn((width.div_ceil(2), height.div_ceil(2)), link))
    }

    /// The packed weights, one `u32` per node.
    pub fn words(&self) -> &Plane<u32> {
        &self.0
    }

    /// The weight of the link to the right, 0 to 16.
    pub fn right(&self, x: u32, y: u32) -> u32 {
        self.0.get(x, y) & 255
    }

    /// The weight of the link downwards, 0 to 16.
    pub fn below(&self, x: u32, y: u32) -> u32 {
        self.0.get(x, y) >> 8 & 255
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kamencay::Segmentation;

    #[test]
    fn by_hand() {
        let grey = |level: u32| level | level << 8 | level << 16;
        let view = Plane::new((3, 3), [0, 4, 4, 0, 8, 60, 0, 0, 4].map(grey).to_vec()).unwrap();
        // The segments are the three columns: only the colours of the segmentation say so.
        let columns = Plane::from_fn((3, 3), |x, _| grey(100 * x));
        let segments = Segments::new(&columns, Segmentation { join: 0, least: 0 });
        let weights = LinkWeights { halving: 4, least: 2, inside: 6, across: 10 };
        let whole = Strip { first_row: 0, rows: 3 };
        let links = Links::new(&view, &segments, whole, weights);
        // Changes of 4 and 0, 8 and 52, 0 and 4: 8 and 16, 5 and 1, 16 and 8, of which none is above 10 or below 2.
        let right: Vec<u32> = (0..9).map(|i| links.right(i % 3, i / 3)).collect();
        assert_eq!(right, [8, 10, 0, 5, 2, 0, 10, 8, 0]);
        // Changes of 0, 4 and 56, 0, 8 and 56: 16, 8 and 1, 16, 5 and 1, of which none is below 6.
        let below: Vec<u32> = (0..9).map(|i| links.below(i % 3, i / 3)).collect();
        assert_eq!(below, [16, 8, 6, 16, 6, 6, 0, 0, 0]);
        let strip = Links::new(&view, &segments, Strip { first_row: 1, rows: 2 }, weights);
        assert_eq!((strip.right(0, 0), strip.below(1, 0), strip.below(1, 1)), (5, 6, 0));

        // From the block of the first two columns to the third: 10 and 2; downwards: 16 and 6.
        let reduced = links.reduced();
        assert_eq!(reduced.words().size(), (2, 2));
        assert_eq!([reduced.right(0, 0), reduced.right(0, 1), reduced.right(1, 0)], [6, 8, 0]);
        assert_eq!([reduced.below(0, 0), reduced.below(1, 0), reduced.below(0, 1)], [11, 6, 0]);
    }
}
