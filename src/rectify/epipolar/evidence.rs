//! What corresponding points tell of two views, before any rectification.

use glam::DVec2;

use super::{
    flat,
    frame::{AGREEMENT, Frame},
    fundamental::Fundamental,
    homography,
    relation::Relation,
    similarity::Similarity,
};
use crate::{image::Size, rectify::Correspondence};

/// Smallest number of inliers, and smallest share of all points, of views of one scene.
pub(super) const RELATED: (usize, f64) = (20, 0.6);
/// Distance from the best homography from which a point shows depth, in pixels of the left view, and the smallest share of such points.
const DEPTH: (f64, f64) = (4.0, 0.04);
/// The same distance of points whose rows correspond already: a turn on the spot of a scene leaves a pixel.
const FLAT: f64 = 2.0;
/// The distance of points that even an obliquely seen plane does not show, over the one above.
const OBLIQUE: f64 = 3.0;
/// Smallest and largest scale of the right view that counts: beyond them matches are less precise than depth.
const SCALES: (f64, f64) = (0.4, 2.5);
/// Median displacement up to which the views were taken from one place in one direction, in pixels.
const STILL: f64 = 0.5;
/// Smallest share of the inliers whose rows agree as they are, for a scene without depth to count as rectified.
const LEVEL: f64 = 0.9;

/// [`Relation::Plane`], [`Relation::Turned`] or [`Relation::Flat`] if points of views of `sizes`, in pixels, detected in the views reduced
/// by `factor`, show no depth. Where a camera turns by little, rows correspond after a small warp, and a search along them finds
/// disparities all the same.
pub fn without_depth(points: &[Correspondence], sizes: [Size; 2], factor: u32) -> Option<Relation> {
    let frame = Frame::new(sizes, factor);
    let points: Vec<Correspondence> = points.iter().map(|point| frame.point(point)).collect();
    flat(&points, &frame)
}

/// [`without_depth`] of points in units of `frame`.
pub(super) fn flat(points: &[Correspondence], frame: &Frame) -> Option<Relation> {
    if points.len() < RELATED.0 {
        return None;
    }
    let plane = homography::consensus(points, DEPTH.0 / frame.unit)?;
    let off = points.iter().filter(|point| homography::distance(&plane, point) > FLAT / frame.unit).count();
    ((off as f64) < DEPTH.1 * points.len() as f64).then(|| flat::relation(points, frame))
}

/// The points of views of `sizes`, in pixels, that agree on how the cameras stand; none if too few do.
pub(crate) fn agreeing(points: &[Correspondence], sizes: [Size; 2]) -> Vec<Correspondence> {
    let frame = Frame::new(sizes, 1);
    let places: Vec<Correspondence> = points.iter().map(|point| frame.point(point)).collect();
    let Some(found) = Fundamental::consensus(&places, frame.unit) else { return Vec::new() };
    let inliers = found.inliers(&places, AGREEMENT / frame.unit);
    let is_related = inliers.len() as f64 >= RELATED.1 * points.len() as f64;
    if is_related { inliers } else { Vec::new() }
}

/// The figures that tell how the cameras stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// The verdict from the figures below.
    pub relation: Relation,
    /// Number of points that agree with the fundamental matrix.
    pub inliers: usize,
    /// Number of all points from which the matrix was found.
    pub points: usize,
    /// Share of the inliers that lie over 4 px off the best homography, 0 to 1.
    pub off_plane: f64,
    /// The same share over 12 px off: a plane seen obliquely, whose points move with the obliqueness, has hardly any.
    pub far_off_plane: f64,
    /// Distances of the epipoles from the centres of the left and the right view; 1 on the edge of the picture.
    pub epipoles: [f64; 2],
}

impl Evidence {
    /// The evidence of points that determine no fundamental matrix: they are too few, or lie exactly as those of a plane do, which
    /// any number of matrices explain.
    pub(super) fn without_matrix(points: &[Correspondence], frame: &Frame) -> Self {
        let plane = homography::consensus(points, AGREEMENT / frame.unit);
        let on_plane = |point: &&Correspondence| {
            plane.is_some_and(|plane| homography::distance(&plane, point) <= AGREEMENT / frame.unit)
        };
        let explained: Vec<Correspondence> = points.iter().filter(on_plane).copied().collect();
        let nothing = Self {
            relation: Relation::Unrelated,
            inliers: explained.len(),
            points: points.len(),
            off_plane: 0.0,
            far_off_plane: 0.0,
            epipoles: [0.0; 2],
        };
        // Rows that correspond already leave no matrix either, but a plane is all that was seen.
        let relation = match nothing.judged(&explained, frame) {
            Relation::Parallax => flat::relation(&explained, frame),
            relation => relation,
        };
        Self { relation, ..nothing }
    }

    pub(super) fn new(
        points: &[Correspondence],
        inliers: &[Correspondence],
        found: &Fundamental,
        frame: &Frame,
    ) -> Self {
        // Distances are measured in the right view, where depth shows in proportion to the scale.
        let unit = frame.unit / Similarity::between(inliers).scale.clamp(SCALES.0, SCALES.1);
        let plane = homography::consensus(inliers, DEPTH.0 / unit);
        let off = |pixels: f64| {
            let is_off =
                |point: &&Correspondence| plane.is_none_or(|plane| homography::distance(&plane, point) > pixels / unit);
            inliers.iter().filter(is_off).count() as f64 / inliers.len().max(1) as f64
        };
        let (off_plane, far_off_plane) = (off(DEPTH.0), off(OBLIQUE * DEPTH.0));
        let mut epipoles = [0.0; 2];
        for ((distance, epipole), view) in epipoles.iter_mut().zip(found.epipoles()).zip(0..) {
            let place = epipole.truncate() / frame.half(view).max(DVec2::splat(1e-9));
            *distance = place.abs().max_element() / epipole.z.abs().max(1e-12);
        }
        let (inliers_count, points) = (inliers.len(), points.len());
        let mut evidence =
            Self { relation: Relation::Parallax, inliers: inliers_count, points, off_plane, far_off_plane, epipoles };
        evidence.relation = evidence.judged(inliers, frame);
        evidence
    }

    /// The evidence of a pair whose rows correspond nowhere: a plane seen obliquely, if no point is far off one.
    pub(super) fn without_rows(self) -> Option<Self> {
        (self.far_off_plane < DEPTH.1).then_some(Self { relation: Relation::Plane, ..self })
    }

    fn judged(&self, inliers: &[Correspondence], frame: &Frame) -> Relation {
        let share = |holds: &dyn Fn(&Correspondence) -> bool| {
            inliers.iter().filter(|point| holds(point)).count() as f64 / inliers.len().max(1) as f64
        };
        let moved = |point: &Correspondence| (point.left - point.right).length() * frame.unit;
        let row = |point: &Correspondence| (point.left.y - point.right.y).abs() * frame.unit;
        if self.inliers < RELATED.0 || (self.inliers as f64) < RELATED.1 * self.points as f64 {
            Relation::Unrelated
        } else if share(&|point| moved(point) <= STILL) > 0.5 {
            Relation::Still
        } else if self.off_plane < DEPTH.1 && share(&|point| row(point) <= AGREEMENT) < LEVEL {
            flat::relation(inliers, frame)
        } else if self.off_plane >= DEPTH.1 && self.epipoles.iter().any(|&distance| distance < 1.0) {
            Relation::Forward
        } else {
            Relation::Parallax
        }
    }
}
