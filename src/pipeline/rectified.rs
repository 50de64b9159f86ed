//! A pair whose rows were brought to correspond, and rectification by a calibration.

use super::{
    back::WayBack,
    reduction::geometry_reduction,
    taken::{Seen, TakenView},
};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    backend::Backend,
    calibration::StereoCalibration,
    dense::View,
    error::{Error, Result},
    features::FeatureConfig,
    filter::repetition,
    image::{self, Luma, Plane, Size},
    io::Picture,
    mask,
    rectify::{CalibratedRectification, Correspondence, Residual, RowModel, StereoRectification},
    wide_baseline::{WideBaselineConfig, match_upright},
};

/// Largest number of interest points of a view that are matched, the strongest, spread over the view: the time to match points grows
/// with the square of their number, and rows become no more precise with 8000 points.
const MOST_POINTS: u32 = 4000;
/// Largest row difference of a right match, smallest magnitude of the disparity of a point behind the cameras, in pixels of the detection,
/// and smallest number of such points that tell.
const MOST_OFF: f64 = 3.0;
const BEYOND: f64 = 1.0;
const LEAST_BEHIND: usize = 20;
/// Precision of the rows of a match, in pixels of the detection: the width of the Cauchy loss.
const PRECISION: f64 = 0.3;

/// A pair whose rows were brought to correspond.
#[derive(Clone, Debug)]
pub struct RectifiedPair {
    /// What was done to the views.
    pub rectification: StereoRectification,
    /// The rectified pictures, of one size: colours, and alpha 0 where a picture shows nothing of its view.
    pub pictures: [Picture; 2],
    /// Matched points, in pixels of the views as they were taken; without a calibration those that the rectification was found from.
    pub points: Vec<Correspondence>,
    /// Row errors of the points that no fit used: a fifth of them, or all with a calibration.
    pub residual: Residual,
    /// Luma of the rectified pictures, which goes on where they show nothing.
    pub(super) luma: [Luma; 2],
    /// The right view, which is resampled anew if its rows are still slightly off.
    pub(super) right: TakenView,
    /// Whether the views are raw mosaics, and the factor by which both were enlarged without interpolation, as they were taken.
    pub(super) mosaics: [bool; 2],
    pub(super) repetition: u32,
}

impl RectifiedPair {
    /// The pair of `views`, which `rectification` resampled to pictures and luma.
    pub(super) fn new(
        views: [TakenView; 2],
        rectification: StereoRectification,
        (pictures, luma): ([Picture; 2], [Luma; 2]),
        points: Vec<Correspondence>,
        residual: Residual,
    ) -> Self {
        let mosaics = views.each_ref().map(|view| view.is_mosaic);
        let [left, right] = views;
        let repetition = repetition(&left.seen.luma).min(repetition(&right.seen.luma));
        Self { rectification, pictures, points, residual, luma, right, mosaics, repetition }
    }

    /// Which pixels of the left and of the right picture show the scene: 255, otherwise 0.
    pub fn masks(&self) -> [Plane<u8>; 2] {
        self.pictures.each_ref().map(|picture| picture.map(|&[.., alpha]| alpha))
    }

    /// Whether rows of the matched points correspond better than in the views as they were taken.
    pub fn is_better_than_taken(&self) -> bool {
        let cost = |rows: &dyn Fn(&Correspondence) -> Option<f64>| -> f64 {
            let deviations =
                self.points.iter().map(|point| rows(point).map_or(f64::INFINITY, |error| error / PRECISION));
            // A match that is wrong in both weighs next to nothing, however far off it is.
            deviations.map(|deviation| libm::log1p((deviation * deviation).min(1e6))).sum()
        };
        cost(&|point| row_error(&self.rectification, point)) < cost(&|point| Some(point.left.y - point.right.y))
    }

    /// The way of a map of the `reference` picture back to its view as it was taken; `rows` are those of the outcome that has the
    /// map, [`crate::seeding::Rectification::rows`].
    ///
    /// # Errors
    /// See [`crate::rectify::WarpMap::new`].
    pub fn way_back(&self, reference: View, rows: &RowModel) -> Result<WayBack> {
        Ok(WayBack::new(match reference {
            View::Left => self.rectification.map_back(0)?,
            View::Right => self.rectification.right_map_back_along(rows)?,
        }))
    }
}

/// Rectifies a pair by a calibration of its cameras.
///
/// # Errors
/// See [`CalibratedRectification::new`]; [`crate::Error::Parameter`] for sides beyond [`crate::luma::MAX_SIDE`]; the errors of
/// [`crate::features::detect`].
#[cfg(not(target_arch = "wasm32"))]
pub fn rectify_by(backend: &Backend, views: (&Picture, &Picture), stereo: &StereoCalibration) -> Result<RectifiedPair> {
    block_on(rectify_by_async(backend, views, stereo))
}

/// The asynchronous [`rectify_by`]. Work on the host blocks.
///
/// # Errors
/// See [`rectify_by`].
pub async fn rectify_by_async(
    backend: &Backend,
    (left, right): (&Picture, &Picture),
    stereo: &StereoCalibration,
) -> Result<RectifiedPair> {
    let views = TakenView::both(left, right)?;
    let found = CalibratedRectification::new(stereo, [left.size(), right.size()])?;
    let rectification = StereoRectification::Calibrated(found.into());
    let (pictures, luma) = warped(backend, &views, &rectification).await?;

    // Points in any row: how far their rows differ tells whether the calibration is that of the pictures.
    let factor = geometry_reduction(rectification.size());
    let small = [0, 1].map(|view: usize| Seen {
        luma: image::reduced(&luma[view], factor),
        mask: Some(mask::reduced(&pictures[view].map(|&[.., alpha]| alpha), factor)),
    });
    let config = config();
    let mut matches = match_upright(backend, [&small[0].luma, &small[1].luma], &config, None).await?;
    matches.retain(|point| small[0].shows(point.left) && small[1].shows(point.right));
    let level: Vec<Correspondence> = matches.iter().map(|point| enlarged(point, factor)).collect();
    check_in_front(&level, factor)?;
    let errors = level.iter().map(|point| point.left.y - point.right.y);
    let residual = Residual::new(level.len(), errors, factor.into());
    let taken = |Correspondence { left, right }: &Correspondence| {
        Some(Correspondence { left: rectification.source_of(0, *left)?, right: rectification.source_of(1, *right)? })
    };
    let points = level.iter().filter_map(taken).collect();
    Ok(RectifiedPair::new(views, rectification, (pictures, luma), points, residual))
}

/// Refuses a pair of whose matched points, in a pair rectified by a calibration and reduced by `factor`, most lie behind the cameras.
fn check_in_front(points: &[Correspondence], factor: u32) -> Result<()> {
    let limit = |pixels: f64| pixels * f64::from(factor);
    let in_rows = |point: &&Correspondence| (point.left.y - point.right.y).abs() <= limit(MOST_OFF);
    let disparities: Vec<f64> = points.iter().filter(in_rows).map(|point| point.left.x - point.right.x).collect();
    let behind = disparities.iter().filter(|&&disparity| disparity < -limit(BEYOND)).count();
    if behind < LEAST_BEHIND || 4 * behind < 3 * disparities.len() {
        return Ok(());
    }
    Err(Error::NotRectifiable {
        reason: format!(
            "by the calibration {behind} of {} matched points lie behind the cameras, at negative disparities: the translation has the \
             wrong sign, or left and right are mixed up; exchange the pictures, or change the sign of the translation",
            disparities.len()
        ),
    })
}

/// The rectified pictures and their luma; a left view that stays is not resampled.
pub(super) async fn warped(
    backend: &Backend,
    [left, right]: &[TakenView; 2],
    by: &StereoRectification,
) -> Result<([Picture; 2], [Luma; 2])> {
    let (left, left_luma) = match by.keeps_left() {
        true => (left.picture.clone(), left.seen.luma.clone()),
        false => left.warped(backend, &by.map(0)?).await?,
    };
    let (right, right_luma) = right.warped(backend, &by.map(1)?).await?;
    Ok(([left, right], [left_luma, right_luma]))
}

/// Row of the left point minus row of the right point in the rectified pictures.
fn row_error(rectification: &StereoRectification, point: &Correspondence) -> Option<f64> {
    Some(rectification.rectified_of(0, point.left)?.y - rectification.rectified_of(1, point.right)?.y)
}

pub(super) fn larger([left, right]: [Size; 2]) -> Size {
    if left.pixels() >= right.pixels() { left } else { right }
}

/// A point of views reduced by `factor`, in pixels of the views.
pub(super) fn enlarged(point: &Correspondence, factor: u32) -> Correspondence {
    let factor = f64::from(factor);
    let [left, right] = [point.left, point.right].map(|place| place * factor + (factor - 1.0) / 2.0);
    Correspondence { left, right }
}

/// Parameters of matching.
pub(super) fn config() -> WideBaselineConfig {
    let config = WideBaselineConfig::default();
    WideBaselineConfig { features: FeatureConfig { max_features: MOST_POINTS, ..config.features }, ..config }
}
