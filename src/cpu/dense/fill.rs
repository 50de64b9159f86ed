//! Filling of holes along rows, from the definition.

use crate::{
    dense::kernels::surface::{FARTHEST, RUN, SHORTEST, STEEPEST},
    disparity::{DisparityMap, DisparityRange, NONE, SCALE},
    image::{Plane, Size},
};

/// Fills the holes of each row: of the surfaces at both ends of a hole, the one further away is continued.
pub fn fill(disparities: &DisparityMap, range: DisparityRange) -> DisparityMap {
    let Size { width, height } = disparities.size();
    Plane::from_fn((width, height), |x, y| {
        let row = disparities.row(y);
        let x = x as usize;
        if row[x] != NONE {
            return row[x];
        }
        // Disparities on either side of the hole, starting at the hole.
        let left: Vec<i32> = row[..x].iter().rev().copied().skip_while(|&d| d == NONE).collect();
        let right: Vec<i32> = row[x + 1..].iter().copied().skip_while(|&d| d == NONE).collect();
        let ends = [(x - left.len().min(x), &left), (row.len() - x - 1 - right.len(), &right)];
        let ends = ends.into_iter().filter(|(_, surface)| !surface.is_empty());
        ends.map(|(gap, surface)| continued(surface, gap as i32 + 1, range)).min().unwrap_or(NONE)
    })
}

/// The disparity `distance` pixels in front of the first pixel of a surface.
fn continued(surface: &[i32], distance: i32, range: DisparityRange) -> i32 {
    let first = surface[0];
    let steady = |pair: &&[i32]| pair[1] != NONE && (pair[1] - pair[0]).abs() <= SCALE;
    let count = (1 + surface.windows(2).take_while(steady).count() as i32).min(RUN);
    if count < SHORTEST {
        return first;
    }
    let relative = || (0..count).map(|place| (place, surface[place as usize] - first));
    let sum: i32 = relative().map(|(_, d)| d).sum();
    // Twice the covariance of positions and disparities, times the count.
    let covariance: i32 = relative().map(|(place, d)| (2 * place - (count - 1)) * d).sum();
    let slope = (96 * covariance).div_euclid(count * (count * count - 1)).clamp(-16 * STEEPEST, 16 * STEEPEST);
    let change = sum.div_euclid(count) - ((slope * (2 * distance + count - 1)) >> 5);
    (first + change.clamp(-FARTHEST, FARTHEST)).clamp(range.min * SCALE, range.last() * SCALE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn background_goes_on_behind_what_hides_it() {
        let range = DisparityRange::new(0, 20).unwrap();
        let map = Plane::new((5, 1), vec![NONE, 512, NONE, 1024, NONE]).unwrap();
        assert_eq!(fill(&map, range).data(), [512, 512, 512, 1024, 1024]);
        // A slope of 16/256 px per pixel is continued.
        let slanted = Plane::from_fn((40, 1), |x, _| if x < 30 { 256 + 16 * x as i32 } else { NONE });
        let filled = fill(&slanted, range);
        assert_eq!(filled.get(35, 0), 256 + 16 * 35);
    }

    #[test]
    fn an_empty_row_stays_empty() {
        let map = Plane::filled((4, 2), NONE);
        assert_eq!(fill(&map, DisparityRange::new(0, 4).unwrap()), map);
    }
}
