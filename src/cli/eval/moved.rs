//! Dense matching where the second view was turned or scaled: the pair is rectified from its own matches, and the map taken back.

use glam::{DAffine2, DVec2};
use hsad::{
    Backend, Result,
    config::Config,
    dense::{Dense, View},
    disparity::pixels,
    gpu::block_on,
    image::Plane,
    io::Picture,
    pipeline::{self, Outcome, RectifiedPair, Step},
};

/// Largest row error of a disparity that counts, in pixels.
const LARGEST_ROW_ERROR: f64 = 1.0;

/// The map of a first view, and where its disparities lead.
pub struct Moved {
    pub pair: RectifiedPair,
    /// The outcome of the rectified pair.
    pub outcome: Outcome,
    /// Disparities of the rectified pair, in pixels, and confidences, for the pixels of the first view as it was taken.
    pub dense: Dense,
}

impl Moved {
    /// Matches two views of which nothing is known.
    ///
    /// # Errors
    /// As [`pipeline::rectify`] and [`pipeline::run`].
    pub fn new(
        backend: &Backend,
        views: (&Picture, &Picture),
        config: &Config,
        begin: impl FnMut(Step),
    ) -> Result<Self> {
        let pair = pipeline::rectify(backend, views)?;
        let outcome = block_on(pipeline::run_rectified(backend, &pair, config, begin, |_| ()))?;
        let dense = pair.way_back(View::Left, &outcome.seeding.rectification.rows)?.dense(&outcome.dense);
        Ok(Self { pair, outcome, dense })
    }

    /// The place in the second view that corresponds to a place of the first with a disparity of the rectified pair, all in pixels.
    pub fn partner(&self, first: DVec2, disparity: f64) -> Option<DVec2> {
        let there = self.pair.rectification.rectified_of(0, first)?;
        let column = there.x - disparity;
        let row = self.outcome.seeding.rectification.rows.right_row(column, there.y);
        self.pair.rectification.source_of(1, DVec2::new(column, row))
    }

    /// The disparities of the pair before its second view was moved by `map`, in pixels: +inf where there is none, and where the partner
    /// lies in another row, by more than 1 px.
    pub fn before(&self, map: DAffine2) -> Plane<f32> {
        let back = map.inverse();
        let found = &self.dense.disparity;
        Plane::from_fn(found.size(), |x, y| {
            let first = DVec2::new(x.into(), y.into());
            let partner = pixels(found.get(x, y)).and_then(|disparity| self.partner(first, disparity.into()));
            let off = partner.map(|partner| first - back.transform_point2(partner));
            off.filter(|off| off.y.abs() <= LARGEST_ROW_ERROR).map_or(f32::INFINITY, |off| off.x as f32)
        })
    }
}
