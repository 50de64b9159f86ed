//! Support of seeds by their neighbours.

use rayon::prelude::*;

use crate::matching::Seed;

/// Number of nearest neighbours that are compared with a seed.
const NEIGHBOURS: usize = 6;
/// Number of neighbours that have to agree.
const AGREEING: usize = 2;
/// Disparity gradient limit: largest change of disparity per pixel of distance between neighbours on one surface. It is
/// far below the limit of human vision, 1 (Pollard, Mayhew, Frisby: 'PMF', Perception 14, 1985), as are most surfaces.
pub(crate) const GRADIENT: f32 = 0.15;
/// Tolerance of disparity and row at distance 0, in pixels.
pub(crate) const SLACK: f32 = 1.0;

/// Seeds per cell of a [`Grid`], on average.
const PER_CELL: f32 = 2.0;

/// The seeds that agree with at least two of their six nearest neighbours, in their order.
///
/// A wrong match lands anywhere in its row, so neighbours rarely support it by chance; the surface of a right match is
/// mostly large enough to bear others. On nine scenes 2 % of the seeds are dropped; on the largest scene 65 of the 84
/// dropped seeds, and 15 of the 3,119 kept ones, are wrong by more than 3 px.
pub(super) fn supported(seeds: &[Seed]) -> Vec<Seed> {
    let grid = Grid::new(seeds);
    let supported = seeds.par_iter().enumerate().filter(|&(index, seed)| {
        let agrees = |&(distance, other): &(f32, usize)| {
            let tolerance = SLACK + GRADIENT * distance;
            let other = &seeds[other];
            (other.disparity - seed.disparity).abs() <= tolerance && (other.dy - seed.dy).abs() <= tolerance
        };
        grid.nearest(seeds, index).iter().filter(|neighbour| agrees(neighbour)).count() >= AGREEING
    });
    supported.map(|(_, seed)| *seed).collect()
}

/// Seeds by the square cells that hold them, so that the nearest ones are found without a look at all.
struct Grid {
    /// Smallest column and row of a seed.
    origin: [f32; 2],
    /// Side of a cell in pixels.
    side: f32,
    columns: usize,
    rows: usize,
    /// Indices of the seeds of each cell, row by row.
    cells: Vec<Vec<usize>>,
}

impl Grid {
    fn new(seeds: &[Seed]) -> Self {
        let extent = |of: fn(&Seed) -> f32| {
            seeds.iter().map(of).fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
        };
        let ([left, right], [top, bottom]) = (extent(|seed| seed.x), extent(|seed| seed.y));
        let (width, height) = ((right - left).max(1.0), (bottom - top).max(1.0));
        // Seeds in one row or column are as sparse as a square cell of that length holds them.
        let count = seeds.len().max(1) as f32;
        let side = (PER_CELL * width * height / count).sqrt().max(PER_CELL * width.max(height) / count).max(1.0);
        let cells = |length: f32| (length / side) as usize + 1;
        let mut grid = Self {
            origin: [left, top],
            side,
            columns: cells(width),
            rows: cells(height),
            cells: vec![Vec::new(); cells(width) * cells(height)],
        };
        for (index, seed) in seeds.iter().enumerate() {
            let [column, row] = grid.place(seed);
            grid.cells[row * grid.columns + column].push(index);
        }
        grid
    }

    /// Column and row of the cell that holds a seed.
    fn place(&self, seed: &Seed) -> [usize; 2] {
        let cell = |at: f32, origin: f32, cells: usize| (((at - origin) / self.side) as usize).min(cells - 1);
        [cell(seed.x, self.origin[0], self.columns), cell(seed.y, self.origin[1], self.rows)]
    }

    /// Distances and indices of the nearest seeds to one of them, up to [`NEIGHBOURS`]; of equally near ones the first.
    fn nearest(&self, seeds: &[Seed], index: usize) -> Vec<(f32, usize)> {
        let seed = &seeds[index];
        let [column, row] = self.place(seed);
        let mut nearest: Vec<(f32, usize)> = Vec::new();
        for ring in 0..self.columns.max(self.rows) {
            for (column, row) in self.ring(column, row, ring) {
                let others = self.cells[row * self.columns + column].iter().filter(|&&other| other != index);
                nearest.extend(others.map(|&other| ((seeds[other].x - seed.x).hypot(seeds[other].y - seed.y), other)));
            }
            if nearest.len() > NEIGHBOURS {
                nearest.select_nth_unstable_by(NEIGHBOURS, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                nearest.truncate(NEIGHBOURS);
            }
            // Beyond the ring seeds are at least so far, but for rounding.
            let beyond = 0.999 * ring as f32 * self.side;
            if nearest.len() == NEIGHBOURS && nearest.iter().all(|&(distance, _)| distance < beyond) {
                break;
            }
        }
        nearest
    }

    /// The cells around a cell whose column or row differs by `distance`, and the other one by no more.
    fn ring(&self, column: usize, row: usize, distance: usize) -> impl Iterator<Item = (usize, usize)> {
        let (columns, rows) = (self.columns, self.rows);
        let around = move |at: usize, end: usize| at.saturating_sub(distance)..(at + distance + 1).min(end);
        let cells = around(row, rows).flat_map(move |r| around(column, columns).map(move |c| (c, r)));
        cells.filter(move |&(c, r)| c.abs_diff(column).max(r.abs_diff(row)) == distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seed(x: f32, disparity: f32, dy: f32) -> Seed {
        Seed { x, y: 5.0, disparity, dy, confidence: 0.5 }
    }

    #[test]
    fn two_of_six_neighbours_must_agree() {
        // At a distance of 10 px a difference of 2.5 px is allowed, at 20 px one of 4 px.
        let seeds = [seed(0.0, 7.0, 0.0), seed(10.0, 9.5, 0.0), seed(20.0, 11.0, 0.0)];
        assert_eq!(supported(&seeds).len(), 3);
        assert_eq!(supported(&seeds[..2]).len(), 0, "one neighbour is not enough");
        let odd = [seeds[0], seeds[1], seed(20.0, 11.1, 0.0)];
        assert_eq!(supported(&odd), [odd[1]], "the ends differ by more than 4 px");
        let rows = [seeds[0], seeds[1], seed(20.0, 11.0, 4.1)];
        assert_eq!(supported(&rows), []);
    }

    #[test]
    fn the_nearest_seeds_are_those_of_a_look_at_all() {
        let mut state = 1_u32;
        let mut draw = |most: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((state >> 16) % most) as f32
        };
        for (count, width, height) in
            [(1, 9, 9), (6, 9, 9), (7, 40, 30), (300, 2000, 1), (400, 1, 900), (900, 300, 200)]
        {
            let mut seeds: Vec<Seed> =
                (0..count).map(|_| Seed { y: draw(height), ..seed(draw(width), 0.0, 0.0) }).collect();
            // A seed far from all, and many in one place.
            seeds.push(Seed { y: 3000.0, ..seed(5000.0, 0.0, 0.0) });
            seeds.extend([seed(7.0, 0.0, 0.0); 9]);
            let grid = Grid::new(&seeds);
            for (index, own) in seeds.iter().enumerate() {
                let others = seeds.iter().enumerate().filter(|&(other, _)| other != index);
                let mut all: Vec<(f32, usize)> =
                    others.map(|(other, seed)| ((seed.x - own.x).hypot(seed.y - own.y), other)).collect();
                all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                all.truncate(NEIGHBOURS);
                let mut nearest = grid.nearest(&seeds, index);
                nearest.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                assert_eq!(nearest, all, "{count} seeds, {index}");
            }
        }
    }
}
