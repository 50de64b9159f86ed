//! Support of a match by its neighbours.

use rayon::prelude::*;

use crate::{
    matching::Seed,
    seeding::{GRADIENT, SLACK},
};

/// Number of nearest neighbours that can support a seed.
const NEIGHBOURS: usize = 8;

/// For each seed the share, 0 to 1, of its eight nearest neighbours that agree with it in disparity and row. Neighbours
/// further away than `reach` pixels do not count, nor do seeds at the same position, which are other detections of the
/// same structure.
pub(super) fn agreement(seeds: &[Seed], reach: f32) -> Vec<f32> {
    seeds.par_iter().map(|seed| share(seeds, seed, reach)).collect()
}

fn share(seeds: &[Seed], seed: &Seed, reach: f32) -> f32 {
    let distance = |other: &Seed| (other.x - seed.x).hypot(other.y - seed.y);
    let mut nearest: Vec<(f32, usize)> = (0..).zip(seeds).map(|(i, other)| (distance(other), i)).collect();
    // Windows two pixels apart still show mostly the same pixels.
    nearest.retain(|&(distance, _)| distance > 2.0 && distance <= reach);
    let order = |a: &(f32, usize), b: &(f32, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    if nearest.len() > NEIGHBOURS {
        nearest.select_nth_unstable_by(NEIGHBOURS, order);
        nearest.truncate(NEIGHBOURS);
    }
    let agrees = |&(distance, other): &(f32, usize)| {
        let tolerance = SLACK + GRADIENT * distance;
        (seeds[other].disparity - seed.disparity).abs() <= tolerance && (seeds[other].dy - seed.dy).abs() <= tolerance
    };
    nearest.iter().filter(|neighbour| agrees(neighbour)).count() as f32 / NEIGHBOURS as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let seed = |x, disparity, dy| Seed { x, y: 5.0, disparity, dy, confidence: 0.5 };
        // At a distance of 10 px a difference of 2.5 px is allowed; the third seed is a second detection of the first,
        // the fourth is too far away, the last one lies in another row.
        let seeds =
            [seed(0.0, 7.0, 0.0), seed(10.0, 9.5, 0.0), seed(1.0, 7.2, 0.0), seed(90.0, 7.0, 0.0), seed(5.0, 7.0, 3.0)];
        assert_eq!(agreement(&seeds, 40.0), [0.125, 0.25, 0.125, 0.0, 0.0]);
    }

    #[test]
    fn eight_are_asked() {
        let seeds: Vec<Seed> =
            (0..30).map(|i| Seed { x: 3.0 * i as f32, y: 0.0, disparity: 4.0, dy: 0.0, confidence: 1.0 }).collect();
        assert!(agreement(&seeds, 40.0).iter().all(|&share| share == 1.0));
    }
}
