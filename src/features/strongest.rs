//! The strongest interest points, spread over the picture.

use std::cmp::Ordering;

use crate::image::Size;

/// Points that a cell is to keep on average: fewer keep a point's neighbours apart, more leave the choice to the strength.
const PER_CELL: f64 = 8.0;

/// What decides whether an interest point is kept.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ranked {
    /// Column in pixels.
    pub x: u32,
    /// Row in pixels.
    pub y: u32,
    /// Determinant of the Hessian.
    pub response: f32,
}

/// The indices of at most `most` of the `points` of a picture of `size`, in ascending order: all points if there are no
/// more.
///
/// The picture is divided into square cells, and the cells take turns, each with its strongest point that is not kept yet
/// (bucketing: Kitt, Geiger, Lategahn, 'Visual Odometry based on Stereo Image Sequences with RANSAC-based Outlier Rejection
/// Scheme', IV 2010). In the last turn the strongest points go first. Of equal points the first one is the stronger.
pub(crate) fn strongest(points: &[Ranked], size: Size, most: usize) -> Vec<usize> {
    if points.len() <= most {
        return (0..points.len()).collect();
    }
    let side = (PER_CELL * size.pixels() as f64 / most as f64).sqrt().ceil().max(1.0) as u32;
    let cell = |index: usize| (points[index].y / side, points[index].x / side);
    let by_strength =
        |a: usize, b: usize| -> Ordering { points[b].response.total_cmp(&points[a].response).then(a.cmp(&b)) };
    let mut by_cell: Vec<usize> = (0..points.len()).collect();
    by_cell.sort_unstable_by(|&a, &b| cell(a).cmp(&cell(b)).then(by_strength(a, b)));
    let in_turns = by_cell.chunk_by(|&a, &b| cell(a) == cell(b)).flat_map(|cell| (0..).zip(cell.iter().copied()));
    let mut in_turns: Vec<(usize, usize)> = in_turns.collect();
    in_turns.sort_unstable_by(|&(turn, a), &(other_turn, b)| turn.cmp(&other_turn).then(by_strength(a, b)));
    let mut kept: Vec<usize> = in_turns.into_iter().take(most).map(|(_, index)| index).collect();
    kept.sort_unstable();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: u32, y: u32, response: f32) -> Ranked {
        Ranked { x, y, response }
    }

    #[test]
    fn the_strongest_of_each_cell_go_first() {
        // 8 * 400 * 100 / 4 = 80,000: two cells of 283 px.
        let size = Size::new(400, 100);
        let points = [
            point(10, 10, 9.0),
            point(20, 10, 8.0),
            point(30, 10, 7.0),
            point(40, 10, 6.0),
            point(350, 10, 1.0),
            point(360, 10, 2.0),
        ];
        assert_eq!(strongest(&points, size, 4), [0, 1, 4, 5]);
        assert_eq!(strongest(&points, size, 3), [0, 1, 5], "in the last turn the strongest first");
        assert_eq!(strongest(&points, size, 6), [0, 1, 2, 3, 4, 5]);
        assert_eq!(strongest(&points, size, 1), [0]);
        assert_eq!(strongest(&[], size, 1), [0; 0]);
    }

    #[test]
    fn of_equal_points_the_first_is_kept() {
        let points: Vec<Ranked> = (0..9).map(|i| point(i, i, 3.0)).collect();
        assert_eq!(strongest(&points, Size::new(9, 9), 4), [0, 1, 2, 3]);
    }

    #[test]
    fn a_rich_half_leaves_room_for_a_poor_one() {
        // A hundred strong points on the left, ten weak ones on the right.
        let points: Vec<Ranked> = (0..110)
            .map(|i| if i < 100 { point(i, i % 64, 5.0) } else { point(400 + 10 * (i - 100), 20, 0.1) })
            .collect();
        let kept = strongest(&points, Size::new(512, 64), 40);
        assert_eq!((kept.len(), kept.iter().filter(|&&index| index >= 100).count()), (40, 10));
    }
}
