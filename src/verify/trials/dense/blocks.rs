//! Block matching.

use crate::{
    cpu::dense::{CellPlane, block_match, consistency, half_consistency, halve, pad, winners},
    dense::{
        Aggregation, Brightness, Compared, DenseConfig, DenseParameters, Search, View,
        kernels::{
            BlockMatch, CELL, ConfirmingMap, Layout, MapBuffer, MapLayout, Ranges, ResultKind, Tile, halved_config,
        },
    },
    disparity::DisparityRange,
    error::Result,
    image::{Luma, Plane, Size},
    luma::pack,
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("block_match", |size, dice| Box::new(BlockMatchTrial::draw(size, dice))),
    Subject::kernel("tile_block_match", |size, dice| {
        Box::new(BlockMatchTrial { tile: Tile::HARDWARE, ..BlockMatchTrial::draw(size, dice) })
    }),
];

/// A pair for block matching.
#[derive(Clone, Debug)]
pub struct BlockMatchTrial {
    /// The left view.
    pub left: Luma,
    /// The right view.
    pub right: Luma,
    /// The reference view.
    pub view: View,
    /// Window, range and checks.
    pub config: DenseConfig,
    /// The range of each cell, if not the whole range; then no tile may lie in two cells.
    pub ranges: Option<CellPlane>,
    /// The pixels per thread.
    pub tile: Tile,
}

impl BlockMatchTrial {
    fn matched(&self, bench: &Bench<'_>, kind: ResultKind) -> Result<Vec<u32>> {
        let (gpu, Size { width, height }) = (bench.gpu, self.left.size());
        let layout = Layout::new(self.left.size(), 0, height, &self.config, self.tile)?;
        // Planes padded by the twin, so that only one kernel is verified.
        let [left, right] = layout.padding();
        let plane = |view, params| pad(view, params, Brightness::SAME);
        let (mut planes, right_plane) = (plane(&self.left, &left), plane(&self.right, &right));
        planes.extend(&right_plane[right.offset as usize..]);
        let texture = bench.upload_words(&planes)?;
        let ranges = match &self.ranges {
            None => Ranges::whole(gpu, self.config.searched(width)?),
            Some(cells) => Ranges::of_cells(bench.upload(&cell_words(cells))?, width),
        };
        let others = match (self.config.parameters.consistency, kind) {
            (Some(limit), ResultKind::Matches) => Some((self.others()?, limit)),
            _ => None,
        };
        let words = others.as_ref().map(|(others, _)| bench.upload_words(others.data())).transpose()?;
        let others = words.as_ref().zip(others.as_ref()).map(|(words, (map, limit))| ConfirmingMap {
            words,
            width: map.width(),
            first_row: 0,
            max_difference: *limit,
        });
        let map = MapLayout { width, rows: height };
        let words = if kind == ResultKind::Matches { map.words() as u32 } else { map.pixels() };
        let matches = bench.output(words)?;
        let kernel = BlockMatch::new(gpu, &self.config.parameters, self.view, kind, self.tile);
        let dispatch = kernel.prepare(&layout, &texture, &ranges, others, MapBuffer { buffer: &matches, layout: map });
        bench.run(|encoder| dispatch.record(encoder));
        bench.download(&matches)
    }

    /// The configuration, with the range clipped to the width.
    fn searched(&self) -> Result<DenseConfig> {
        Ok(DenseConfig { range: self.config.searched(self.left.width())?, ..self.config.clone() })
    }

    /// The winners of the other view, over the whole range; coarse to fine, at half size.
    fn others(&self) -> Result<Plane<i32>> {
        let (config, view) = (self.searched()?, self.view.other());
        Ok(if config.parameters.is_coarse_to_fine() {
            let [left, right] = [&self.left, &self.right].map(halve);
            winners(&left, &right, view, &halved_config(&config, config.range), None)
        } else {
            winners(&self.left, &self.right, view, &config, None)
        })
    }

    fn arrays(disparities: Vec<i32>, confidences: Vec<u32>, winners: Vec<i32>) -> Vec<Array> {
        vec![
            Array::exact("disparities", disparities),
            Array::exact("confidences", confidences),
            Array::exact("winners", winners),
        ]
    }
}

impl BlockMatchTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        // Software drivers take seconds to compile for a window, and a minute for a wide one.
        let window = if dice.below(16) == 0 { dice.pick(&[11, 13, 15, 21]) } else { dice.pick(&[3, 3, 5, 7, 9]) };
        let (interpolation, view) = (dice.interpolation(), dice.view());
        let tile =
            dice.pick(&[Tile::HARDWARE, Tile::SMALL, Tile::LARGE, Tile { quads: 3, height: 1, across: 3, down: 5 }]);
        let uniqueness = dice.pick(&[0, 0, 1, 15, 100]);
        let range = dice.range(80);
        // Some ranges leave most pixels without any cost.
        let away = if size.width > 64 { dice.between(-40, 40) } else { 0 };
        let range = DisparityRange { min: range.min + away, ..range };
        let [left, right] = dice.pair(size);
        let consistency = dice.pick(&[None, Some(0), Some(256)]);
        let search = dice.pick(&[Search::Whole, Search::CoarseToFine]);
        let aggregation = Aggregation::Sad { side: window, search, compared: Compared::Luma };
        let parameters =
            DenseParameters { aggregation, interpolation, uniqueness, consistency, agreement: 0, refinement: None };
        let config = DenseConfig { parameters, ..DenseConfig::new(range) };
        let in_cells = dice.coin() && (tile == Tile::HARDWARE || CELL.is_multiple_of(4 * tile.quads));
        let ranges = config.searched(size.width).ok().filter(|_| in_cells).map(|range| {
            Plane::from_fn((size.width.div_ceil(CELL), size.height.div_ceil(CELL)), |_, _| {
                let first = dice.below(range.count);
                (first, dice.below(range.count - first + 1))
            })
        });
        Self { left, right, view, config, ranges, tile }
    }
}

impl Trial for BlockMatchTrial {
    fn parameters(&self) -> String {
        format!("{:?} {:?} {:?} {:?}", self.view, self.config, self.tile, self.ranges)
    }

    fn input(&self) -> Vec<Array> {
        [("left", &self.left), ("right", &self.right)]
            .map(|(name, view)| Array::exact(name, view.data().to_vec()))
            .to_vec()
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let matches = self.matched(bench, ResultKind::Matches)?;
        let (disparities, confidences) = matches.split_at(self.left.data().len());
        let winners = self.matched(bench, ResultKind::Winners)?;
        Ok(Self::arrays(signed(disparities), confidences.to_vec(), signed(&winners)))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let (config, ranges) = (self.searched()?, self.ranges.as_ref());
        let mut dense = block_match(&self.left, &self.right, self.view, &config, ranges);
        if let Some(max_difference) = config.parameters.consistency {
            let check = if config.parameters.is_coarse_to_fine() { half_consistency } else { consistency };
            check(&mut dense, self.view, &self.others()?, max_difference);
        }
        let winners = winners(&self.left, &self.right, self.view, &config, ranges).into_data();
        Ok(Self::arrays(dense.disparity.into_data(), pack(&dense.confidence), winners))
    }
}

/// Two `u32`s per cell.
pub(super) fn cell_words(cells: &CellPlane) -> Vec<u32> {
    cells.data().iter().flat_map(|&(first, count)| [first, count]).collect()
}

/// Converts words to disparities.
pub(super) fn signed(words: &[u32]) -> Vec<i32> {
    words.iter().map(|word| word.cast_signed()).collect()
}
