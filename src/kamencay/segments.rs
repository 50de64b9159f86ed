//! The segments of a filtered picture, on the host.

use std::collections::BTreeMap;

use crate::image::{Plane, Size};

/// Parameters of segmentation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segmentation {
    /// Largest distance of the filtered RGB colours of neighbours in one segment, 0 to 441 grey levels; 4 by default.
    pub join: u32,
    /// Least size of a segment, in pixels; 10 by default. Smaller segments are merged into the neighbour of the most
    /// similar mean colour.
    pub least: u32,
}

/// The segment of each pixel: its label is the raster index of the segment's first pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segments {
    labels: Plane<u32>,
}

/// Regions that are joined: Tarjan's union-find, where the smaller label remains.
struct Regions {
    parents: Vec<u32>,
    sizes: Vec<u32>,
    /// Sums of red, green and blue of each region.
    sums: Vec<[i64; 3]>,
}

impl Regions {
    fn find(&mut self, mut label: u32) -> u32 {
        while self.parents[label as usize] != label {
            let above = self.parents[self.parents[label as usize] as usize];
            self.parents[label as usize] = above;
            label = above;
        }
        label
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        if a == b {
            return;
        }
        let (first, second) = (a.min(b) as usize, a.max(b) as usize);
        self.parents[second] = first as u32;
        self.sizes[first] += self.sizes[second];
        for channel in 0..3 {
            self.sums[first][channel] += self.sums[second][channel];
        }
    }

    /// The squared distance of the mean colours of two regions, in 1/256.
    fn distance(&self, a: u32, b: u32) -> i64 {
        let mean = |label: u32, channel: usize| {
            16 * self.sums[label as usize][channel] / i64::from(self.sizes[label as usize])
        };
        (0..3).map(|channel| (mean(a, channel) - mean(b, channel)).pow(2)).sum()
    }
}

/// All pairs of 4-connected pixels.
fn neighbours(Size { width, height }: Size) -> impl Iterator<Item = (u32, u32)> {
    (0..width * height).flat_map(move |pixel| {
        let right = (pixel % width + 1 < width).then_some((pixel, pixel + 1));
        let below = (pixel / width + 1 < height).then_some((pixel, pixel + width));
        right.into_iter().chain(below)
    })
}

impl Segments {
    /// Segments a picture filtered by mean shift: one `u32` per pixel, red in its lowest byte.
    pub fn new(modes: &Plane<u32>, segmentation: Segmentation) -> Self {
        let (size, pixels) = (modes.size(), modes.data());
        let colour = |pixel: u32| [0, 8, 16].map(|shift| i64::from(pixels[pixel as usize] >> shift & 255));
        let count = pixels.len() as u32;
        let mut regions = Regions {
            parents: (0..count).collect(),
            sizes: vec![1; pixels.len()],
            sums: (0..count).map(colour).collect(),
        };
        for (a, b) in neighbours(size) {
            let distance: i64 = colour(a).iter().zip(colour(b)).map(|(a, b)| (a - b).pow(2)).sum();
            if distance <= i64::from(segmentation.join).pow(2) {
                regions.join(a, b);
            }
        }
        while merge_small(&mut regions, size, segmentation.least) {}
        let Size { width, height } = size;
        Self { labels: Plane::from_fn((width, height), |x, y| regions.find(y * width + x)) }
    }

    /// The label of each pixel.
    pub fn labels(&self) -> &Plane<u32> {
        &self.labels
    }

    /// Number of segments.
    pub fn count(&self) -> usize {
        (0..).zip(self.labels.data()).filter(|&(pixel, &label)| pixel == label).count()
    }
}

/// Merges each region of fewer than `least` pixels, in the order of labels, into the most similar neighbour, ties to
/// the smaller label. Returns whether any region was merged.
fn merge_small(regions: &mut Regions, size: Size, least: u32) -> bool {
    let mut around: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (a, b) in neighbours(size) {
        let (a, b) = (regions.find(a), regions.find(b));
        if a != b {
            for (small, other) in [(a, b), (b, a)] {
                if regions.sizes[small as usize] < least {
                    around.entry(small).or_default().push(other);
                }
            }
        }
    }
    let mut merged = false;
    for (small, neighbours) in around {
        let small = regions.find(small);
        if regions.sizes[small as usize] >= least {
            continue;
        }
        let neighbours: Vec<u32> = neighbours.into_iter().map(|other| regions.find(other)).collect();
        let neighbours = neighbours.into_iter().filter(|&other| other != small);
        if let Some(other) = neighbours.min_by_key(|&other| (regions.distance(small, other), other)) {
            regions.join(small, other);
            merged = true;
        }
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(value: u32) -> u32 {
        value | value << 8 | value << 16
    }

    #[test]
    fn neighbours_of_like_colours_are_joined() {
        // 10 and 12 differ by 2 in each channel: 3.46 in all. 10 and 40 are another thing.
        let modes = Plane::new((4, 2), [10, 12, 40, 40, 10, 14, 40, 10].map(grey).to_vec()).unwrap();
        let segments = |join, least| Segments::new(&modes, Segmentation { join, least });
        assert_eq!(segments(4, 0).labels().data(), [0, 0, 2, 2, 0, 0, 2, 7]);
        assert_eq!(segments(4, 0).count(), 3);
        assert_eq!(segments(3, 0).labels().data(), [0, 1, 2, 2, 0, 5, 2, 7]);
    }

    #[test]
    fn small_ones_join_the_most_similar_neighbour() {
        let modes = Plane::new((5, 1), [10, 10, 30, 40, 40].map(grey).to_vec()).unwrap();
        let segments = Segments::new(&modes, Segmentation { join: 0, least: 2 });
        assert_eq!(segments.labels().data(), [0, 0, 2, 2, 2]);
        // All are too small: one is left.
        assert_eq!(Segments::new(&modes, Segmentation { join: 0, least: 9 }).labels().data(), [0; 5]);
        let alone = Segments::new(&Plane::filled((1, 1), 0), Segmentation { join: 0, least: 9 });
        assert_eq!((alone.labels().data(), alone.count()), (&[0][..], 1));
    }
}
