//! What views without depth show: a plane, or what a camera sees that turns on the spot.

use glam::{DMat3, DVec3};

use super::{
    frame::{Frame, PRECISION},
    homography::{self, distance, projected},
    linear::rotation,
    minimise::{Errors, minimise},
    relation::Relation,
    similarity::Similarity,
};
use crate::rectify::Correspondence;

/// Largest distance of the points that take part from the best homography, in pixels.
const WITHIN: f64 = 4.0;
/// Focal length of a usual camera, in units of the mean of width and height, and the standard deviation of its base 3 logarithm.
const FOCAL: (f64, f64) = (1.0, 0.35);
/// The standard deviation of the natural logarithm of the ratio of both focal lengths: a zoom.
const ZOOM: f64 = 0.35;
/// Share of the cost by which a simpler model may cost more, for lenses that are distorted a little.
const SLACK: f64 = 0.1;

/// Whether points without depth are those of a plane or of a turn on the spot; [`Relation::Flat`] if both explain them.
///
/// Three homographies are compared, each by its robust cost plus `k ln n` (Schwarz, Annals of Statistics 6, 1978): any (8
/// parameters), a turn and a zoom of usual cameras, `K' R K^-1` (5; Hartley and Zisserman 2003, section 8.4), and a similarity (4),
/// as a plane moved sideways and a camera turned by little both give.
pub(super) fn relation(points: &[Correspondence], frame: &Frame) -> Relation {
    let Some(plane) = homography::consensus(points, WITHIN / frame.unit) else { return Relation::Flat };
    let near: Vec<_> = points.iter().filter(|point| distance(&plane, point) <= WITHIN / frame.unit).copied().collect();
    let count = libm::log(near.len().max(1) as f64);
    let add = |map: &DMat3, errors: &mut Errors| {
        let width = PRECISION / frame.unit;
        errors
            .robust
            .extend(near.iter().flat_map(|point| ((projected(map, point.left) - point.right) / width).to_array()));
    };
    let scaled = plane * (1.0 / plane.z_axis.z);
    let any = minimise([0.0; 8], |&[a, b, c, d, e, f, g, h], errors| {
        add(&(DMat3::from_cols_array(&[a, b, c, d, e, f, g, h, 0.0]) + scaled), errors);
    });
    let Similarity { turn, scale } = Similarity::between(&near);
    let start = rotation(DVec3::Z * turn);
    let turned = minimise([0.0; 5], |&[x, y, z, focal, zoom], errors| {
        let left = FOCAL.0 * frame.mean_side(0) * libm::pow(3.0, focal);
        let right = left * scale * libm::exp(zoom);
        let camera = |focal: f64| DMat3::from_diagonal(DVec3::new(focal, focal, 1.0));
        add(&(camera(right) * rotation(DVec3::new(x, y, z)) * start * camera(1.0 / left)), errors);
        errors.plain.extend([focal / FOCAL.1, (libm::log(scale) + zoom) / ZOOM]);
    });
    let (sin, cos) = libm::sincos(turn);
    let similar = minimise([scale * cos, scale * sin, 0.0, 0.0], |&[cos, sin, x, y], errors| {
        add(&DMat3::from_cols(DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), DVec3::new(x, y, 1.0)), errors);
    });
    let explains = |cost: f64, parameters: f64| cost + parameters * count <= any.cost * (1.0 + SLACK) + 8.0 * count;
    match (explains(turned.cost, 5.0), explains(similar.cost, 4.0)) {
        (true, true) => Relation::Flat,
        (true, false) => Relation::Turned,
        (false, _) => Relation::Plane,
    }
}
