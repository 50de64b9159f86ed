//! Rectification without calibration, from matched points alone.
//!
//! ```text
//! points -> fundamental -> evidence -> lenses -> rows or rotations -> layout -> maps
//! ```
//!
//! All arithmetic is in double precision on the host, and random samples come in a fixed sequence: the same points give the same
//! result.

mod evidence;
mod flat;
mod frame;
mod fundamental;
mod homography;
mod layout;
mod lens;
mod lenses;
mod linear;
mod minimise;
mod refusal;
mod relation;
mod rotations;
mod rows;
mod sample;
mod shape;
mod similarity;
#[cfg(test)]
mod tests;

use glam::{DMat3, DVec2, DVec3};

pub(crate) use evidence::agreeing;
pub use evidence::{Evidence, without_depth};
pub use refusal::Refusal;
pub use relation::Relation;
pub use shape::Distortion;
pub(crate) use similarity::Similarity;

use frame::{AGREEMENT, Frame};
use fundamental::Fundamental;
use layout::Layout;
use lens::Lens;
use lenses::Lenses;
use rotations::Cameras;

use super::{Correspondence, Residual, RowKind, Slant, WarpMap, map::TOLERANCE};
use crate::{error::Result, image::Size};

/// Largest ratio of areas around the matches that were one.
const LARGEST_AREA: f64 = 16.0;
/// Largest mean of the inliers' row errors after the rectification, in pixels of the detection in the view that is enlarged most: good pairs
/// have up to 0.45, a plane seen obliquely 0.7.
const LARGEST_ERROR: f64 = 0.6;
/// Every so many points one is left out of the fit, to measure the residual.
const LEFT_OUT: usize = 5;

/// What is done to the views.
///
/// With one view resampled and the other left alone, edges stay sharp in one of them, and disparities belong to the left picture as
/// it was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// The left view stays as it is, but for the distortion of its lens, and the right view follows its rows.
    Right(RowKind),
    /// Both views are turned.
    Both,
}

impl Model {
    /// The name of the model.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Right(kind) => kind.name(),
            Self::Both => "both views",
        }
    }

    /// Number of parameters that points determine.
    const fn parameters(self) -> usize {
        match self {
            Self::Right(kind) => kind.parameters(),
            Self::Both => 7,
        }
    }
}

/// Rectification of two views without calibration: homographies and the distortion of the lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncalibrated {
    /// What the points tell of the cameras.
    pub evidence: Evidence,
    /// What is done to the views.
    pub model: Model,
    /// Radial distortions of the left and the right view: a place `x` from the centre of a picture appears at `x (1 + k1 r^2)`, `r` in
    /// units of the mean of width and height; 0 unless the points show a distortion, and the same unless they show two lenses.
    pub k1: [f64; 2],
    /// Maps from pixels of the left and the right view, without their distortion, to pixels of the rectified pictures.
    pub homographies: [DMat3; 2],
    /// Width and height of both rectified pictures, in pixels.
    pub size: Size,
    /// How far the columns of the right picture were moved to the right, in pixels, so that disparities are not far from 0.
    pub shift: f64,
    /// Whether columns of both pictures, but for [`Self::shift`], are those of the views, without the distortion of the lens:
    /// disparities are then those of the views as they were taken, less the shift. Otherwise they are known but for a constant, since
    /// matches do not tell the columns of one view against those of the other.
    pub keeps_columns: bool,
    /// How shapes change around the matched points.
    pub distortion: Distortion,
    /// Row errors of matched points that the fit did not use.
    pub residual: Residual,
    frame: Frame,
}

impl Uncalibrated {
    /// The rectification of views of `sizes`, the left one first, from points in pixels of the views, the most certain first,
    /// that were detected in the views reduced by `factor`.
    ///
    /// The least sum of robust costs plus `k ln n` decides between rows as they are, a shift, affine and projective rows of
    /// the right view, and both views, for `k` parameters and `n` inliers (Schwarz, Annals of Statistics 6, 1978).
    ///
    /// # Errors
    /// Why the pair cannot be rectified.
    pub fn new(points: &[Correspondence], sizes: [Size; 2], factor: u32) -> std::result::Result<Self, Refusal> {
        let frame = Frame::new(sizes, factor);
        let points: Vec<Correspondence> = points.iter().map(|point| frame.point(point)).collect();
        let is_left_out = |index: usize| index % LEFT_OUT == LEFT_OUT - 1;
        let choose = |left_out: bool| -> Vec<Correspondence> {
            let indexed = points.iter().enumerate().filter(|&(index, _)| is_left_out(index) == left_out);
            indexed.map(|(_, point)| *point).collect()
        };
        let (used, unused) = (choose(false), choose(true));
        let Some(found) = Fundamental::consensus(&used, frame.unit) else {
            return Err(Refusal::Relation(Evidence::without_matrix(&used, &frame)));
        };
        let inliers = found.inliers(&used, AGREEMENT / frame.unit);
        let evidence = Evidence::new(&used, &inliers, &found, &frame);
        // Of lenses that differ, hardly any points agree before the distortion is undone.
        let lenses = match evidence.relation {
            Relation::Parallax | Relation::Unrelated => Lenses::shown(&used, &found, &frame),
            _ => return Err(Refusal::Relation(evidence)),
        };
        let (lenses, found, inliers, evidence) = match lenses {
            Lenses::NONE => (lenses, found, inliers, evidence),
            shown => {
                let lenses = shown.of_parallel_cameras(&found.behind(shown, &used, &frame).0, &used, &frame);
                let (found, inliers) = found.behind(lenses, &used, &frame);
                let straight = lenses.straight(&used, &frame);
                let evidence = Evidence::new(&straight, &inliers, &found, &frame);
                (lenses, found, inliers, evidence)
            }
        };
        if evidence.relation != Relation::Parallax {
            return Err(Refusal::Relation(evidence));
        }

        let chosen = Chosen::new(&found, &inliers, &frame);
        // Where a camera turned by little, most rows nearly correspond, and matrices that turn both views explain the others.
        let is_warped = !matches!(chosen.model, Model::Right(RowKind::AsIs | RowKind::Shift));
        if let Some(relation) = is_warped.then(|| evidence::flat(&inliers, &frame)).flatten() {
            return Err(Refusal::Relation(Evidence { relation, ..evidence }));
        }
        let residual = row_errors(&chosen.maps, &lenses.straight(&unused, &frame), &frame);
        Self::bounded(evidence, &chosen, lenses, &inliers, residual, frame)
    }

    /// The rectification by the chosen maps, if it leaves the views recognisable and their rows equal.
    fn bounded(
        evidence: Evidence,
        &Chosen { model, maps, keeps_columns }: &Chosen,
        lenses: Lenses,
        inliers: &[Correspondence],
        residual: Residual,
        frame: Frame,
    ) -> std::result::Result<Self, Refusal> {
        let torn = Refusal::Distorted { area: f64::INFINITY };
        let distortion = Distortion::of(&maps, inliers).ok_or(torn)?;
        if distortion.area > LARGEST_AREA {
            return Err(Refusal::Distorted { area: distortion.area });
        }
        let fit = row_errors(&maps, inliers, &frame);
        if fit.mean > LARGEST_ERROR * frame.pixels_per_detected() * shape::enlargement(&maps, inliers, &frame) {
            return Err(evidence.without_rows().map_or(Refusal::Rows(fit.mean), Refusal::Relation));
        }
        let layout = match model {
            Model::Right(_) if lenses == Lenses::NONE => Layout::of_left(&frame, &maps, inliers),
            _ => Layout::of_both(&frame, &maps, lenses, inliers).ok_or(torn)?,
        };
        let homographies = [0, 1].map(|view| {
            DMat3::from_translation(-layout.origins[view]) * maps[view] * frame.map_to_pixels(view).inverse()
        });
        let shift = layout.origins[0].x - layout.origins[1].x;
        let (k1, size) = (lenses.k1(), layout.size);
        Ok(Self { evidence, model, k1, homographies, size, shift, keeps_columns, distortion, residual, frame })
    }

    /// The pixel of a rectified picture that shows a pixel of a view, 0 for the left one; `None` beyond the horizon.
    pub fn rectified(&self, view: usize, pixel: DVec2) -> Option<DVec2> {
        let (frame, lens) = (&self.frame, Lens { k1: self.k1[view] });
        let straight = lens.undistorted(frame.place(view, pixel), frame.mean_side(view));
        frame::mapped(&self.homographies[view], frame.pixel(view, straight))
    }

    /// The pixel of a view that a pixel of its rectified picture shows, perhaps outside the view; `None` beyond the horizon.
    pub fn original(&self, view: usize, pixel: DVec2) -> Option<DVec2> {
        self.source(view, &self.homographies[view].inverse(), pixel)
    }

    fn source(&self, view: usize, inverse: &DMat3, pixel: DVec2) -> Option<DVec2> {
        let (frame, lens) = (&self.frame, Lens { k1: self.k1[view] });
        let place = frame.place(view, frame::mapped(inverse, pixel)?);
        Some(frame.pixel(view, lens.distorted(place, frame.mean_side(view))?))
    }

    /// The maps that resample the left and the right view: homography and distortion in one, to within 1/32 px.
    ///
    /// # Errors
    /// See [`WarpMap::new`].
    pub fn maps(&self) -> Result<[WarpMap; 2]> {
        let map = |view: usize| {
            let inverse = self.homographies[view].inverse();
            let source = |pixel| self.source(view, &inverse, pixel).unwrap_or(DVec2::NAN);
            WarpMap::within(TOLERANCE, self.size, self.frame.sizes[view], source)
        };
        Ok([map(0)?, map(1)?])
    }

    /// Mean side of a view, in pixels: the unit of `r` in [`Self::k1`].
    pub fn mean_side(&self, view: usize) -> f64 {
        let Size { width, height } = self.frame.sizes[view];
        f64::from(width + height) / 2.0
    }

    /// Width and height of the left and the right view as they were taken, in pixels.
    pub fn sources(&self) -> [Size; 2] {
        self.frame.sizes
    }
}

/// The row errors of `points` in units, by `maps` from units to pixels of the rectified plane.
fn row_errors(maps: &[DMat3; 2], points: &[Correspondence], frame: &Frame) -> Residual {
    let row = |view: usize, place: DVec2| frame::mapped(&maps[view], place).map(|place| place.y);
    let errors = points.iter().filter_map(|point| Some(row(0, point.left)? - row(1, point.right)?));
    Residual::new(points.len(), errors, frame.pixels_per_detected())
}

/// The change of the right columns, from units to units, that takes from surfaces the slant that most of them share: rows tell nothing
/// of a shear and a stretch of the columns.
fn columns(maps: &[DMat3; 2], inliers: &[Correspondence], frame: &Frame) -> DMat3 {
    let mapped = |view: usize, place: DVec2| frame::mapped(&maps[view], place);
    let level: Vec<Correspondence> = inliers
        .iter()
        .filter_map(|point| Some(Correspondence { left: mapped(0, point.left)?, right: mapped(1, point.right)? }))
        .collect();
    match Slant::of(&level, frame.unit) {
        Some(slant @ Slant { along: [across, down], .. }) if slant.is_clear() => {
            DMat3::from_cols(DVec3::X * (1.0 + across), DVec3::new(down, 1.0, 0.0), DVec3::Z)
        }
        _ => DMat3::IDENTITY,
    }
}

/// What is done to the views, and how.
struct Chosen {
    model: Model,
    /// Maps from units of both views to pixels of the rectified plane.
    maps: [DMat3; 2],
    keeps_columns: bool,
}

impl Chosen {
    fn new(found: &Fundamental, inliers: &[Correspondence], frame: &Frame) -> Self {
        let (model, maps) = cheapest(found, inliers, frame);
        let right = columns(&maps, inliers, frame) * maps[1];
        let stays = [DVec3::new(1.0, 0.0, frame.offset().x), DVec3::Z];
        let keeps_columns = model != Model::Both && [right.row(0), right.row(2)] == stays;
        let in_pixels = frame.map_to_pixels(0);
        let maps = [in_pixels * maps[0], in_pixels * right];
        Self { model, maps: if keeps_columns { maps } else { on_pixels(model, maps, frame) }, keeps_columns }
    }
}

/// The maps, from units to pixels, with what nothing tells chosen so that resampling loses least: the middle pixel of the right view lies
/// on a column, and where both views are turned that of the left view on a column and a row. Of a view that is turned by a right angle all
/// pixels lie so; halfway between pixels most of the detail is lost.
fn on_pixels(model: Model, maps: [DMat3; 2], frame: &Frame) -> [DMat3; 2] {
    let to_pixel = |view: usize| {
        let there = frame::mapped(&maps[view], frame.middle(view)).unwrap_or_default();
        there.round() - there
    };
    let (left, right) = match model {
        Model::Right(_) => (DVec2::ZERO, to_pixel(1).with_y(0.0)),
        Model::Both => (to_pixel(0), to_pixel(1).with_y(to_pixel(0).y)),
    };
    [DMat3::from_translation(left) * maps[0], DMat3::from_translation(right) * maps[1]]
}

/// The model of least cost, and homographies of both views from units to units.
fn cheapest(found: &Fundamental, inliers: &[Correspondence], frame: &Frame) -> (Model, [DMat3; 2]) {
    let criterion = |found: &Fundamental, model: Model| {
        found.cost(inliers, frame.unit) + model.parameters() as f64 * libm::log(inliers.len() as f64)
    };
    let as_is = (RowKind::AsIs, rows::as_is(frame));
    let best = std::iter::once(as_is)
        .chain(rows::fits(inliers, frame.unit))
        .map(|(kind, fit)| (criterion(&rows::fundamental(fit), Model::Right(kind)), kind, fit))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((cost, kind, fit)) if cost <= criterion(found, Model::Both) => {
            (Model::Right(kind), [DMat3::IDENTITY, rows::homography(kind, fit, frame)])
        }
        _ => (Model::Both, Cameras::fitted(inliers, frame).homographies(inliers, frame)),
    }
}
