//! The methods, and the matches of each for given interest points.

use glam::DVec2;
use hsad::{
    Backend, Error, Result,
    config::{self, Config, Preset},
    dense::{Dense, FILLED},
    disparity::pixels,
    eval::PointMatch,
    gpu::block_on,
    image::Size,
    io::Picture,
    kamencay::KamencayParameters,
    pipeline,
    wide_baseline::{WideBaselineConfig, match_views},
};

use crate::cli::eval::moved::Moved;

/// A matching method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Matches of interest points, as in `hsad eval features`.
    Sparse,
    /// The method that the paper compares itself with: the hybrid method, with its default parameters.
    Kamencay,
    /// Dense matching of this program, with its default preset.
    Balanced,
}

/// The matches of one method.
pub struct MethodMatches {
    /// The interest points to match, in pixels of the first view.
    pub points: Vec<DVec2>,
    /// The matches of these points.
    pub at_points: Vec<PointMatch>,
    /// The matches of all positions of the first view; for a dense method one per measured pixel.
    pub everywhere: Vec<PointMatch>,
}

impl Method {
    /// All methods; the first one finds the points that the others match.
    pub const ALL: [Self; 3] = [Self::Sparse, Self::Kamencay, Self::Balanced];

    /// Name of the method in one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sparse => "sparse",
            Self::Kamencay => "kamencay",
            Self::Balanced => "balanced",
        }
    }

    /// The method of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }

    /// Whether the method searches along rows, and finds no points of its own.
    pub fn is_dense(self) -> bool {
        self != Self::Sparse
    }

    /// All parameters as a text that changes with each of them.
    pub fn described(self) -> String {
        match self.dense() {
            None => format!("{:?}", WideBaselineConfig::default()),
            Some(config) => format!("{config:?}"),
        }
    }

    /// Configuration of a dense method; `None` for matches of interest points.
    fn dense(self) -> Option<Config> {
        // Rows are known to correspond: a mistaken verdict on the rectification must not stop the method.
        let balanced = Config { force: true, ..Preset::Balanced.config() };
        match self {
            Self::Sparse => None,
            Self::Kamencay => {
                Some(Config { method: config::Method::Kamencay(KamencayParameters::default()), ..balanced })
            }
            Self::Balanced => Some(balanced),
        }
    }

    /// Matches two views. A dense method matches the given `points` and every pixel; matching of interest points
    /// ignores `points` and finds its own. Where the second view was `moved`, a dense method rectifies the pair from its own matches
    /// first, and has no answers if they do not tell how.
    ///
    /// # Errors
    /// As [`match_views`], [`pipeline::run`] and [`pipeline::rectify`].
    pub fn run(
        self,
        backend: &Backend,
        (first, second): (&Picture, &Picture),
        points: &[DVec2],
        moved: bool,
    ) -> Result<MethodMatches> {
        let Some(config) = self.dense() else {
            let found = block_on(match_views(backend, &first.luma(), &second.luma(), &WideBaselineConfig::default()))?;
            let points = found.features[0].iter().map(|point| DVec2::new(point.x.into(), point.y.into())).collect();
            let matches: Vec<_> = found.matches.iter().map(PointMatch::from).collect();
            return Ok(MethodMatches { points, at_points: matches.clone(), everywhere: matches });
        };
        let Size { width, height } = first.size();
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| DVec2::new(x.into(), y.into())));
        let answers = |found: &dyn Fn(DVec2) -> Option<PointMatch>| MethodMatches {
            points: points.to_vec(),
            at_points: points.iter().filter_map(|&at| found(at)).collect(),
            everywhere: pixels.filter_map(found).collect(),
        };
        if !moved {
            let dense = pipeline::run(backend, (first, second), &config, |_| ())?.dense;
            return Ok(answers(&|at| match_at(&dense, at, |disparity| Some(at - DVec2::new(disparity, 0.0)))));
        }
        match Moved::new(backend, (first, second), &config, |_| ()) {
            Ok(moved) => Ok(answers(&|at| match_at(&moved.dense, at, |disparity| moved.partner(at, disparity)))),
            Err(Error::NotRectifiable { .. }) => Ok(answers(&|_| None)),
            Err(error) => Err(error),
        }
    }
}

/// The match of a position of the left view, by the disparity of the pixel that it lies in, and its `partner` for that disparity;
/// `None` if that disparity was not measured or only filled in.
fn match_at(dense: &Dense, at: DVec2, partner: impl Fn(f64) -> Option<DVec2>) -> Option<PointMatch> {
    // Interest points can lie up to half a pixel beyond the centres of the border pixels.
    let pixel = |at: f64, side: u32| at.round().clamp(0.0, f64::from(side - 1)) as u32;
    let (x, y) = (pixel(at.x, dense.disparity.width()), pixel(at.y, dense.disparity.height()));
    let confidence = dense.confidence.get(x, y);
    let disparity = pixels(dense.disparity.get(x, y)).filter(|_| confidence > FILLED)?;
    Some(PointMatch { first: at, second: partner(disparity.into())?, confidence: confidence.into(), points: None })
}

#[cfg(test)]
mod tests {
    use hsad::{disparity::NONE, image::Plane};

    use super::*;

    #[test]
    fn a_map_answers_where_it_was_measured() {
        let disparity = Plane::from_fn((4, 1), |x, _| [256, 384, NONE, 512][x as usize]);
        let confidence = Plane::from_fn((4, 1), |x, _| [FILLED, 70, 0, 90][x as usize]);
        let dense = Dense { disparity, confidence };
        let answers = [0.0, 0.75, 1.25, 2.0, 3.4].map(|x| {
            let at = DVec2::new(x, 0.3);
            match_at(&dense, at, |disparity| Some(at - DVec2::new(disparity, 0.0)))
        });
        let found = answers.map(|answer| answer.map(|found| (found.second.x, found.second.y, found.confidence)));
        let second = Some((3.4 - 2.0, 0.3, 90.0));
        assert_eq!(found, [None, Some((-0.75, 0.3, 70.0)), Some((-0.25, 0.3, 70.0)), None, second]);
    }

    #[test]
    fn names_are_known_again_and_parameters_differ() {
        for method in Method::ALL {
            assert_eq!(Method::named(method.name()), Some(method));
        }
        assert_ne!(Method::Kamencay.described(), Method::Balanced.described());
        assert_eq!(Method::named("hsad"), None);
    }
}
