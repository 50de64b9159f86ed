//! Costs along paths in bands of rows, so that no volume of a whole picture is in memory.
//!
//! The twins work on a band as on a picture. A path enters a band from a row of its own costs: the row is put before the
//! band's first, and [`path`] and [`cell_path`] leave the first row of a path as it is. Paths from above are carried on from
//! band to band. Paths from below must be known beforehand: they are followed once from bottom to top, keeping the row below
//! each part of the picture, and then again within each part, which has parts of its own where rows for all bands would be too
//! many (Griewank, 'Achieving Logarithmic Growth of Temporal and Spatial Complexity in Reverse Automatic Differentiation',
//! Optimization Methods and Software 1, 1992). The result does not depend on where bands are cut.

use std::{borrow::Cow, ops::Range};

use rayon::prelude::*;

use super::{CellVolume, Transforms, box_mean, cell_cost, cell_path, cost, cut::Cut, path};
use crate::{
    dense::{CostAggregation, DenseConfig, Direction, View, kernels::HALO_ROWS, pyramid::CellTable},
    disparity::DisparityRange,
    image::{Luma, Plane, Size},
};

/// A pair and how it is matched.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub left: &'a Luma,
    /// Before the change of brightness.
    pub right: &'a Luma,
    pub config: &'a DenseConfig,
    pub costs: &'a CostAggregation,
    /// The disparities of the cells of a level of a pyramid. Without them the whole range is searched.
    pub table: Option<&'a CellTable>,
}

/// A band of rows, and the costs of its pixels along all paths.
pub(super) struct Band {
    pub rows: Range<u32>,
    /// One volume per path; without paths, the matching costs themselves.
    pub paths: Vec<Vec<u8>>,
}

/// The bands of one view, from top to bottom.
pub(super) struct Bands<'a> {
    task: Task<'a>,
    view: View,
    cut: Cut,
    /// The last row so far of each path from above; none at the top of the picture.
    above: PathRows,
    /// The parts to come, the topmost last, each with the row of each path from below on which it stands.
    parts: Vec<(Range<u32>, PathRows)>,
}

/// The costs of one row along each path of one vertical direction; none at an edge of the picture.
type PathRows = Vec<Vec<u8>>;

/// What paths through a band read.
struct Volume {
    rows: Range<u32>,
    /// The census transform of the view, of all rows from `first_row` on that the band and paths into it need.
    census: Plane<u32>,
    first_row: u32,
    costs: Vec<u8>,
}

impl Task<'_> {
    /// Bytes of a row of a volume.
    fn row(&self, y: u32) -> usize {
        match self.table {
            None => self.left.width() as usize * DisparityRange::padded(self.config.range.count) as usize,
            Some(table) => 4 * table.row_words(y) as usize,
        }
    }
}

impl<'a> Bands<'a> {
    pub fn new(task: Task<'a>, view: View, cut: Cut) -> Self {
        let whole = 0..task.left.height();
        Self { task, view, cut, above: Vec::new(), parts: vec![(whole, Vec::new())] }
    }

    fn directions(&self, dy: i32) -> impl Iterator<Item = Direction> + use<> {
        self.task.costs.directions().iter().copied().filter(move |direction| direction.dy == dy)
    }

    /// Cuts `rows` into parts, and follows the paths from below, which come from the row `below`, through all but the
    /// topmost.
    fn split(&mut self, rows: Range<u32>, mut below: PathRows) {
        let bands = (rows.end - rows.start).div_ceil(self.cut.rows);
        let part = bands.div_ceil(self.cut.parts) * self.cut.rows;
        for first in rows.clone().step_by(part as usize).rev() {
            let part = first..(first + part).min(rows.end);
            let above = if first > rows.start { self.through(part.clone(), &below) } else { Vec::new() };
            self.parts.push((part, std::mem::replace(&mut below, above)));
        }
    }

    /// The first row of each path from below that comes through `rows` from the row `below`.
    fn through(&self, rows: Range<u32>, below: &PathRows) -> PathRows {
        if self.directions(-1).next().is_none() {
            return Vec::new();
        }
        let mut entered = below.clone();
        for first in rows.clone().step_by(self.cut.rows as usize).rev() {
            let band = self.volume(first..(first + self.cut.rows).min(rows.end));
            let row = self.task.row(first);
            let followed: Vec<_> = self.directions(-1).zip(entries(&entered)).collect();
            entered = followed
                .into_par_iter()
                .map(|(direction, entry)| self.follow(&band, direction, entry)[..row].to_vec())
                .collect();
        }
        entered
    }

    /// The matching costs of `rows`, averaged over their windows.
    fn volume(&self, rows: Range<u32>) -> Volume {
        let Task { left, right, config, costs: aggregation, table } = self.task;
        let size = left.size();
        // The averaging window reaches this far, and a path enters from one row more.
        let averaged = around(&rows, aggregation.radius(), size);
        let read = around(&rows, aggregation.radius() + 1, size);
        let equalised = |luma: Luma| luma.map(|&luma| config.brightness.apply(luma));
        let transforms = |luma, change: &dyn Fn(Luma) -> Luma| {
            let halo = around(&read, HALO_ROWS, size);
            let transforms = Transforms::new(&change(Luma::cut(luma, halo.clone())), &aggregation.cost);
            transforms.cut(read.start - halo.start..read.end - halo.start)
        };
        let (left, right) = (transforms(left, &|luma| luma), transforms(right, &equalised));
        let [own, other] = if self.view == View::Left { [left, right] } else { [right, left] };
        let within = averaged.start - read.start..averaged.end - read.start;
        let views = [&own.cut(within.clone()), &other.cut(within)];
        let mut costs = match table {
            None => cost(views, self.view, &aggregation.cost, config.range),
            Some(table) => cell_cost(views, self.view, &aggregation.cost, &table.cut(averaged.clone())).values,
        };
        if aggregation.window > 1 {
            costs = box_mean(&costs, views[0].census.size(), aggregation.window);
            let row = self.task.row(rows.start);
            costs.truncate((rows.end - averaged.start) as usize * row);
            costs.drain(..(rows.start - averaged.start) as usize * row);
        }
        Volume { rows, census: own.census, first_row: read.start, costs }
    }

    /// The costs along one path through a band, which comes from the row `entry`.
    fn follow(&self, band: &Volume, direction: Direction, entry: Option<&Vec<u8>>) -> Vec<u8> {
        let (own, Range { start, end }) = (&band.costs[..], band.rows.clone());
        let (rows, costs, skipped) = match entry {
            None => (start..end, Cow::Borrowed(own), 0),
            Some(entry) if direction.dy > 0 => (start - 1..end, Cow::Owned([entry, own].concat()), entry.len()),
            Some(entry) => (start..end + 1, Cow::Owned([own, entry].concat()), 0),
        };
        let reference = band.census.cut(rows.start - band.first_row..rows.end - band.first_row);
        let penalties = self.task.costs.followed_with();
        let mut followed = match self.task.table {
            None => path(&reference, &costs, &penalties, direction),
            Some(table) => {
                let costs = CellVolume { table: table.cut(rows), values: costs.into_owned() };
                cell_path(&reference, &costs, &penalties, direction).values
            }
        };
        followed.truncate(skipped + own.len());
        followed.drain(..skipped);
        followed
    }
}

impl Iterator for Bands<'_> {
    type Item = Band;

    fn next(&mut self) -> Option<Band> {
        let (rows, below) = loop {
            let (rows, below) = self.parts.pop()?;
            if rows.end - rows.start <= self.cut.rows {
                break (rows, below);
            }
            self.split(rows, below);
        };
        let volume = self.volume(rows.clone());
        let followed = self.task.costs.directions();
        if followed.is_empty() {
            return Some(Band { rows, paths: vec![volume.costs] });
        }
        let above = std::mem::take(&mut self.above);
        let (mut from_below, mut from_above) = (entries(&below), entries(&above));
        let entered = |direction: Direction| match direction.dy {
            0 => None,
            1.. => from_above.next().flatten(),
            _ => from_below.next().flatten(),
        };
        let entered: Vec<_> = followed.iter().copied().zip(followed.iter().copied().map(entered)).collect();
        let paths: Vec<Vec<u8>> =
            entered.into_par_iter().map(|(direction, entry)| self.follow(&volume, direction, entry)).collect();
        let lasting = followed.iter().zip(&paths).filter(|(direction, _)| direction.dy > 0);
        let row = self.task.row(rows.end - 1);
        self.above = lasting.map(|(_, path)| path[path.len() - row..].to_vec()).collect();
        Some(Band { rows, paths })
    }
}

/// The rows from which paths enter a band, in order; at an edge of the picture none of them has one.
fn entries(rows: &PathRows) -> impl Iterator<Item = Option<&Vec<u8>>> {
    rows.iter().map(Some).chain(std::iter::repeat(None))
}

/// `rows` of a picture with a halo of `radius` rows.
fn around(rows: &Range<u32>, radius: u32, size: Size) -> Range<u32> {
    rows.start.saturating_sub(radius)..(rows.end + radius).min(size.height)
}
