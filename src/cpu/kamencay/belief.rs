//! Belief propagation, from the definition.

use rayon::prelude::*;

use crate::{
    image::Size,
    kamencay::{Links, Smoothness, kernels::Turn},
};

/// The neighbours in the order of a node's messages: above, below, left, right.
const NEIGHBOURS: [(i64, i64); 4] = [(0, -1), (0, 1), (-1, 0), (1, 0)];

/// A grid of nodes.
#[derive(Clone, Copy)]
pub struct Grid<'g> {
    /// Nodes per row, and rows.
    pub size: Size,
    /// Data costs, all disparities of a node one after the other.
    pub costs: &'g [u16],
    /// Weights of the grid's links.
    pub links: &'g Links,
}

impl Grid<'_> {
    /// Number of disparities per node.
    fn count(&self) -> usize {
        self.costs.len() / (self.size.width as usize * self.size.height as usize)
    }

    /// The neighbour in `direction`, an index into [`NEIGHBOURS`]; `None` outside the grid.
    fn neighbour(&self, (x, y): (u32, u32), direction: usize) -> Option<(u32, u32)> {
        let (dx, dy) = NEIGHBOURS[direction];
        let (x, y) = (i64::from(x) + dx, i64::from(y) + dy);
        let inside = (0..self.size.width.into()).contains(&x) && (0..self.size.height.into()).contains(&y);
        inside.then_some((x as u32, y as u32))
    }

    /// The message that the neighbour in `direction` sends to a node.
    fn received<'m>(
        &self,
        messages: &'m [u8],
        at: (u32, u32),
        direction: usize,
        from_parents: bool,
    ) -> Option<&'m [u8]> {
        let (x, y) = self.neighbour(at, direction)?;
        let (width, x, y) =
            if from_parents { (self.size.width.div_ceil(2), x / 2, y / 2) } else { (self.size.width, x, y) };
        // Directions come in pairs of opposites.
        let place = 4 * (y as usize * width as usize + x as usize) + (direction ^ 1);
        Some(&messages[place * self.count()..][..self.count()])
    }

    /// The data costs of a node plus all messages to it, except the one from direction `but`.
    pub(super) fn belief(&self, messages: &[u8], at: (u32, u32), but: Option<usize>, from_parents: bool) -> Vec<u32> {
        let count = self.count();
        let node = (at.1 * self.size.width + at.0) as usize;
        let mut sum: Vec<u32> = self.costs[node * count..][..count].iter().map(|&cost| cost.into()).collect();
        for direction in (0..4).filter(|&direction| Some(direction) != but) {
            if let Some(message) = self.received(messages, at, direction, from_parents) {
                sum.iter_mut().zip(message).for_each(|(sum, &part)| *sum += u32::from(part));
            }
        }
        sum
    }

    fn weight(&self, (x, y): (u32, u32), direction: usize) -> u32 {
        match direction {
            0 => self.links.below(x, y - 1),
            1 => self.links.below(x, y),
            2 => self.links.right(x - 1, y),
            _ => self.links.right(x, y),
        }
    }
}

/// The message to a neighbour: for each of its disparities, the least sum of the cost `h` of a disparity of this node
/// and the smoothness cost of the difference, minus the least of all.
fn message(h: &[u32], slope: u32, limit: u32) -> impl Iterator<Item = u8> {
    let least = h.iter().copied().min().unwrap_or(0);
    // Differences beyond the reach cost at least the limit; with slope 0 the reach is unlimited.
    let reach = limit.checked_div(slope).map_or(h.len(), |reach| reach as usize);
    (0..h.len()).map(move |d| {
        let near = d.saturating_sub(reach)..=(d + reach).min(h.len() - 1);
        let cheapest = near.map(|e| h[e] + slope * e.abs_diff(d) as u32).min();
        (cheapest.map_or(limit, |cheapest| cheapest - least)).min(limit) as u8
    })
}

/// One turn: half of the nodes of `grid` send a message to each of their neighbours. A node has four messages: up,
/// down, left and right, 0 where there is no neighbour. `parents` are the messages of the grid of half the size.
pub fn belief(grid: Grid<'_>, messages: &mut [u8], parents: &[u8], smoothness: &Smoothness, turn: Turn) {
    let (width, count) = (grid.size.width as usize, grid.count());
    let before = messages.to_vec();
    let received = if turn.from_parents { parents } else { &before };
    messages.par_chunks_mut(4 * count).enumerate().for_each(|(node, sent)| {
        let at = ((node % width) as u32, (node / width) as u32);
        if (at.0 + at.1) % 2 != turn.parity {
            return;
        }
        for (direction, sent) in sent.chunks_mut(count).enumerate() {
            if grid.neighbour(at, direction).is_none() {
                sent.fill(0);
                continue;
            }
            let h = grid.belief(received, at, Some(direction), turn.from_parents);
            let weight = grid.weight(at, direction);
            let part = |cost: u32| cost * weight / 16;
            let values = message(&h, part(smoothness.slope), part(smoothness.limit));
            sent.iter_mut().zip(values).for_each(|(sent, value)| *sent = value);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_by_hand() {
        let messages = |slope, limit| message(&[9, 5, 30], slope, limit).collect::<Vec<_>>();
        // Costs less the least, 5: 4 or a step from 5; 0; the limit.
        assert_eq!(messages(3, 20), [3, 0, 3]);
        assert_eq!(messages(100, 20), [4, 0, 20]);
        // With free differences the message is 0 everywhere.
        assert_eq!(messages(0, 20), [0, 0, 0]);
    }
}
