//! Rectification of a pair from its own matches.

use glam::DAffine2;

use super::{
    rectified::{RectifiedPair, config, enlarged, larger, warped},
    reduction::geometry_reduction,
    taken::{Seen, TakenView},
};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    backend::Backend,
    cpu,
    error::{Error, Result},
    image::Size,
    io::Picture,
    rectify::{
        Correspondence, StereoRectification, WarpMap,
        epipolar::{Refusal, Similarity, Uncalibrated},
    },
    seeding::Rectification,
    wide_baseline::{Glance, WideBaselineConfig, glance, grown, match_points, match_upright},
};

/// Number of inliers below which more points are sought, along the rows of a first rectification, and in views that are reduced less.
const FEW: usize = 200;
/// Ratio of scales of the views above which points are sought in views that are reduced less.
const ZOOMED: f64 = 1.5;
/// Number of times that points are sought along rows, the second time along better rows.
const ROUNDS: usize = 2;
/// Largest row difference of points that are sought along rows, in pixels of the detection.
const MAX_DY: f32 = 3.0;

/// A pair as it was taken, after a first look at it.
///
/// The look costs a fraction of a rectification, which begins with it, and tells whether there must be one.
#[derive(Clone, Debug)]
pub struct TakenPair {
    views: [TakenView; 2],
    /// Both views reduced by [`Self::factor`], in which points are detected.
    small: [Seen; 2],
    factor: u32,
    glance: Glance,
}

impl TakenPair {
    /// Looks at a pair of views. They may differ in size, turn and scale.
    ///
    /// # Errors
    /// [`Error::Parameter`] for sides beyond [`crate::luma::MAX_SIDE`]; the errors of [`crate::features::detect`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn new(backend: &Backend, views: (&Picture, &Picture)) -> Result<Self> {
        block_on(Self::new_async(backend, views))
    }

    /// The asynchronous [`Self::new`]. Work on the host blocks.
    ///
    /// # Errors
    /// See [`Self::new`].
    pub async fn new_async(backend: &Backend, (left, right): (&Picture, &Picture)) -> Result<Self> {
        let views = TakenView::both(left, right)?;
        let factor = geometry_reduction(larger([left.size(), right.size()]));
        let small = views.each_ref().map(|view| view.seen.reduced(factor));
        let glance = glance(backend, [&small[0].luma, &small[1].luma], &config()).await?;
        Ok(Self { views, small, factor, glance })
    }

    /// Whether both views have one size.
    pub(super) fn is_of_one_size(&self) -> bool {
        self.views[0].picture.size() == self.views[1].picture.size()
    }

    /// How the rows of the views correspond as they are, from small copies of the views; in pixels of the views. `None` unless that is
    /// certain.
    pub fn rows(&self) -> Option<Rectification> {
        self.glance.rows.map(|rows| rows.enlarged(self.factor))
    }

    /// Rectifies the pair from its own matches.
    ///
    /// # Errors
    /// See [`rectify`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn rectify(self, backend: &Backend) -> Result<RectifiedPair> {
        block_on(self.rectify_async(backend))
    }

    /// The asynchronous [`Self::rectify`]. Work on the host blocks.
    ///
    /// # Errors
    /// See [`rectify`].
    pub async fn rectify_async(self, backend: &Backend) -> Result<RectifiedPair> {
        let Self { views, small, factor, glance: Glance { map: start, .. } } = self;
        let sizes = views.each_ref().map(|view| view.picture.size());
        let mut fitted = Fitted::new(backend, &small, sizes, factor, start).await?;
        if factor > 1 && fitted.lacks_detail() {
            let finer = factor.div_ceil(2);
            let start = grown(start, f64::from(factor) / f64::from(finer));
            let small = views.each_ref().map(|view| view.seen.reduced(finer));
            fitted = fitted.better_of(Fitted::new(backend, &small, sizes, finer, start).await?);
        }
        let Fitted { found, points } = fitted;
        let found = found.map_err(|refusal| Error::NotRectifiable { reason: refusal.to_string() })?;
        let residual = found.residual;
        let rectification = StereoRectification::Uncalibrated(found.into());
        let resampled = warped(backend, &views, &rectification).await?;
        Ok(RectifiedPair::new(views, rectification, resampled, points, residual))
    }
}

/// Rectifies a pair from its own matches. The views may differ in size, turn and scale.
///
/// # Errors
/// [`Error::NotRectifiable`] if no depth follows from the pair, or no warp brings its rows to correspond;
/// [`Error::Parameter`] for sides beyond [`crate::luma::MAX_SIDE`]; the errors of [`crate::features::detect`].
#[cfg(not(target_arch = "wasm32"))]
pub fn rectify(backend: &Backend, views: (&Picture, &Picture)) -> Result<RectifiedPair> {
    block_on(rectify_async(backend, views))
}

/// The asynchronous [`rectify`]. Work on the host blocks.
///
/// # Errors
/// See [`rectify`].
pub async fn rectify_async(backend: &Backend, views: (&Picture, &Picture)) -> Result<RectifiedPair> {
    TakenPair::new_async(backend, views).await?.rectify_async(backend).await
}

/// Matched points, and the rectification that they show.
struct Fitted {
    found: std::result::Result<Uncalibrated, Refusal>,
    /// In pixels of the views.
    points: Vec<Correspondence>,
}

impl Fitted {
    /// Matches views of `sizes`, reduced by `factor`, from `start` on, a map from pixels of the second reduced view to pixels of one that
    /// is turned and scaled like the first.
    async fn new(backend: &Backend, small: &[Seen; 2], sizes: [Size; 2], factor: u32, start: DAffine2) -> Result<Self> {
        let config = config();
        let fit = |points: &[Correspondence]| {
            let points: Vec<Correspondence> = points.iter().map(|point| enlarged(point, factor)).collect();
            Self { found: Uncalibrated::new(&points, sizes, factor), points }
        };
        let mut points = points_between(backend, [&small[0], &small[1]], &config, start).await?;
        let mut fitted = fit(&points);
        if fitted.found.is_err() {
            // Matching turns and scales the second view, which leaves other points than to turn and scale the first one.
            let exchanged = points_between(backend, [&small[1], &small[0]], &config, start.inverse()).await?;
            let exchanged = exchanged.iter().map(|point| Correspondence { left: point.right, right: point.left });
            let both: Vec<Correspondence> = exchanged.chain(points.iter().copied()).collect();
            let better = fit(&both);
            if better.found.is_ok() {
                (points, fitted) = (both, better);
            }
        }
        for round in 0..ROUNDS {
            if fitted.found.is_err() || round == 0 && fitted.inliers() >= FEW {
                break;
            }
            let more = more_points(backend, small, &points, &config).await?;
            let better = fit(&more);
            if better.found.is_err() || more.len() <= points.len() {
                break;
            }
            (points, fitted) = (more, better);
        }
        Ok(fitted)
    }

    /// Whether views that are reduced less should show more: points are few, or surfaces much smaller in one of the views.
    fn lacks_detail(&self) -> bool {
        let scale = Similarity::between(&self.points).scale;
        self.inliers() < FEW || scale.max(1.0 / scale) > ZOOMED
    }

    /// Number of points that agree on how the cameras stand; 0 if no picture follows from what they agree on.
    fn inliers(&self) -> usize {
        match &self.found {
            Ok(found) => found.evidence.inliers,
            Err(Refusal::Relation(evidence)) => evidence.inliers,
            Err(Refusal::Distorted { .. } | Refusal::Rows(_)) => 0,
        }
    }

    /// The one that can be rectified, or else the one of more inliers; itself where they are equal.
    fn better_of(self, other: Self) -> Self {
        let key = |fitted: &Self| (fitted.found.is_ok(), fitted.inliers());
        if key(&other) > key(&self) { other } else { self }
    }
}

/// Matched points of two views, the second one turned and scaled like the first, from `start` on.
async fn points_between(
    backend: &Backend,
    views: [&Seen; 2],
    config: &WideBaselineConfig,
    start: DAffine2,
) -> Result<Vec<Correspondence>> {
    let mut points = match_points(backend, views.map(|view| &view.luma), config, start).await?;
    points.retain(|point| views[0].shows(point.left) && views[1].shows(point.right));
    Ok(points)
}

/// Points found along the rows of a first rectification by `points`: where views are alike, many more points match.
async fn more_points(
    backend: &Backend,
    views: &[Seen; 2],
    points: &[Correspondence],
    config: &WideBaselineConfig,
) -> Result<Vec<Correspondence>> {
    let sizes: [Size; 2] = views.each_ref().map(|view| view.luma.size());
    let Ok(first) = Uncalibrated::new(points, sizes, 1) else { return Ok(Vec::new()) };
    let maps: [WarpMap; 2] = first.maps()?;
    let level = [0, 1].map(|view: usize| cpu::rectify::warp(&views[view].luma, &maps[view]));
    let found = match_upright(backend, [&level[0], &level[1]], config, Some(MAX_DY)).await?;
    let back = |point: &Correspondence| {
        let (left, right) = (first.original(0, point.left)?, first.original(1, point.right)?);
        (views[0].shows(left) && views[1].shows(right)).then_some(Correspondence { left, right })
    };
    Ok(found.iter().filter_map(back).collect())
}
