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
    seeds.par_iter().map(|seed| share(seeds, seed, &[1.0], reach)).collect()
}

/// As [`agreement`], with what surrounds a seed as large in both views, or in the second view as much larger as its feature is,
/// whichever more neighbours agree with: `growths` has the ratio of the scales of each seed's features.
pub(super) fn agreement_of_scales(seeds: &[Seed], growths: &[f32], reach: f32) -> Vec<f32> {
    seeds.par_iter().zip(growths).map(|(seed, &growth)| share(seeds, seed, &[1.0, growth], reach)).collect()
}

fn share(seeds: &[Seed], seed: &Seed, growths: &[f32], reach: f32) -> f32 {
    let distance = |other: &Seed| (other.x - seed.x).hypot(other.y - seed.y);
    let mut nearest: Vec<(f32, usize)> = (0..).zip(seeds).map(|(i, other)| (distance(other), i)).collect();
    // Windows two pixels apart still show mostly the same pixels.
    nearest.retain(|&(distance, _)| distance > 2.0 && distance <= reach);
    let order = |a: &(f32, usize), b: &(f32, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    if nearest.len() > NEIGHBOURS {
        nearest.select_nth_unstable_by(NEIGHBOURS, order);
        nearest.truncate(NEIGHBOURS);
    }
    let agreeing = |growth: f32| {
        let agrees = |&&(distance, other): &&(f32, usize)| {
            let (tolerance, other) = (SLACK + GRADIENT * distance, &seeds[other]);
            let dx = other.disparity - seed.disparity - (1.0 - growth) * (other.x - seed.x);
            let dy = other.dy - seed.dy - (growth - 1.0) * (other.y - seed.y);
            dx.abs() <= tolerance && dy.abs() <= tolerance
        };
        nearest.iter().filter(agrees).count()
    };
    growths.iter().map(|&growth| agreeing(growth)).max().unwrap_or(0) as f32 / NEIGHBOURS as f32
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
    fn surfaces_of_another_scale_agree_by_their_features() {
        // A surface 1.5 times as large in the second view, and one feature of it whose scales say otherwise.
        let seeds: Vec<Seed> = (0..9)
            .map(|i| {
                let (x, y) = (10.0 * (i % 3) as f32, 10.0 * (i / 3) as f32);
                Seed { x, y, disparity: -0.5 * x, dy: 0.5 * y, confidence: 1.0 }
            })
            .collect();
        let mut growths = [1.5; 9];
        growths[4] = 1.0;
        let shares = agreement_of_scales(&seeds, &growths, 40.0);
        assert!(shares.iter().enumerate().all(|(i, &share)| (share == 1.0) == (i != 4)), "{shares:?}");
        assert_eq!(agreement(&seeds, 40.0)[4], 0.0);
    }

    #[test]
    fn eight_are_asked() {
        let seeds: Vec<Seed> =
            (0..30).map(|i| Seed { x: 3.0 * i as f32, y: 0.0, disparity: 4.0, dy: 0.0, confidence: 1.0 }).collect();
        assert!(agreement(&seeds, 40.0).iter().all(|&share| share == 1.0));
    }
}
