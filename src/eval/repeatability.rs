//! Repeatability: correspondences between the interest points of two views (Mikolajczyk et al., IJCV 65, 2005,
//! section 4.1).

use glam::{DMat2, DVec2};
use rayon::prelude::*;

use super::{
    overlap::{NORMAL_RADIUS, Region, overlap_error},
    truth::Truth,
};
use crate::features::Feature;

/// Largest overlap error of corresponding regions.
pub const MAX_OVERLAP_ERROR: f64 = 0.4;

/// An interest point as a detector reports it: a circular region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Position, in pixels.
    pub at: DVec2,
    /// Size, above 0, in any unit that is the same for all points of both views.
    pub scale: f64,
}

impl From<&Feature> for Point {
    fn from(feature: &Feature) -> Self {
        Self { at: DVec2::new(feature.x.into(), feature.y.into()), scale: feature.scale.into() }
    }
}

/// Correspondences between two lists of interest points.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeatability {
    /// For each point of the first view the index of its corresponding point of the second. Each point corresponds to
    /// one other at most; candidate pairs are taken in order of overlap error, the smallest first.
    pub partner: Vec<Option<usize>>,
    /// Number of points of each view in the area that both views show.
    pub shared: [usize; 2],
}

impl Repeatability {
    /// Finds the correspondences between the points of two views. Only points in the area that both views show count.
    pub fn new(first: &[Point], second: &[Point], truth: &Truth) -> Self {
        let shown: Vec<usize> = (0..first.len()).filter(|&i| truth.shows(first[i].at)).collect();
        let mut shared: Vec<usize> = (0..second.len()).filter(|&j| truth.is_shared(second[j].at)).collect();
        shared.sort_by(|&a, &b| second[a].at.y.total_cmp(&second[b].at.y));
        let mut pairs: Vec<(f64, usize, usize)> = shown
            .par_iter()
            .flat_map_iter(|&i| {
                let reach = reach(truth.linear(first[i].at));
                let y = truth.locate(first[i].at).map_or(f64::NAN, |place| place.y);
                let start = shared.partition_point(|&j| second[j].at.y < y - reach);
                let near = shared[start..].iter().take_while(move |&&j| second[j].at.y <= y + reach);
                near.filter_map(move |&j| Some((corresponding(first[i], second[j], truth)?, i, j)))
            })
            .collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut partner = vec![None; first.len()];
        let mut taken = vec![false; second.len()];
        for (_, i, j) in pairs {
            if partner[i].is_none() && !taken[j] {
                partner[i] = Some(j);
                taken[j] = true;
            }
        }
        Self { partner, shared: [shown.len(), shared.len()] }
    }

    /// Number of correspondences.
    pub fn correspondences(&self) -> usize {
        self.partner.iter().flatten().count()
    }

    /// Repeatability: correspondences divided by [`Self::fewer`], 0 to 1; NaN without points.
    pub fn share(&self) -> f64 {
        self.correspondences() as f64 / self.fewer() as f64
    }

    /// Number of points in the area that both views show, of the view with fewer points.
    pub fn fewer(&self) -> usize {
        self.shared[0].min(self.shared[1])
    }
}

/// Largest distance of a corresponding point from the true position, in pixels of the second view.
///
/// The centre of an ellipse with more than half of its area inside a circle lies inside the circle: a line through the
/// centre halves the ellipse.
fn reach(linear: DMat2) -> f64 {
    NORMAL_RADIUS * (linear.x_axis.length_squared() + linear.y_axis.length_squared()).sqrt()
}

/// Overlap error of two points in the first view; `None` if it is above [`MAX_OVERLAP_ERROR`]. The second point's
/// circle is mapped to the first view by the inverse of the local linear map at the first point.
pub(super) fn corresponding(first: Point, second: Point, truth: &Truth) -> Option<f64> {
    let back = truth.linear(first.at).inverse();
    let displacement = back * (second.at - truth.locate(first.at)?);
    if displacement.length() > NORMAL_RADIUS {
        return None;
    }
    let reference = Region::circle(DVec2::ZERO, first.scale);
    let other = Region { centre: displacement, shape: back * second.scale };
    let ratio = (other.shape.determinant() / reference.shape.determinant()).abs();
    if ratio.min(1.0 / ratio) < 1.0 - MAX_OVERLAP_ERROR {
        return None;
    }
    Some(overlap_error(reference, other)).filter(|&error| error <= MAX_OVERLAP_ERROR)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{eval::conditions::Condition, image::Plane, io::Picture};

    fn point(x: f64, y: f64, scale: f64) -> Point {
        Point { at: DVec2::new(x, y), scale }
    }

    fn shift(disparity: f32) -> Truth {
        Truth::stereo(Plane::filled((100, 80), disparity), None).unwrap()
    }

    #[test]
    fn by_hand() {
        let first = [
            point(50.0, 40.0, 2.0),
            point(51.0, 40.0, 2.0),
            point(80.0, 10.0, 3.0),
            point(3.0, 60.0, 2.0),
            point(20.0, 70.0, 2.0),
        ];
        let second = [
            point(41.5, 40.0, 2.0), // nearer to point 1 than to point 0, which still finds the next one:
            point(39.0, 40.0, 2.0),
            point(70.0, 10.0, 4.0), // (3 / 4)^2 = 0.5625 is less than 0.6
            point(95.0, 60.0, 2.0), // outside the area that the left view shows
        ];
        let found = Repeatability::new(&first, &second, &shift(10.0));
        assert_eq!(found.partner, [Some(1), Some(0), None, None, None]);
        // Point 3 lies at -7 in the second view.
        assert_eq!((found.shared, found.correspondences()), ([4, 3], 2));
        assert!((found.share() - 2.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn the_same_points_correspond_and_none_where_all_is_hidden() {
        let points: Vec<Point> = (0..40).map(|i| point(f64::from(i * 7 % 80), f64::from(i * 13 % 70), 2.0)).collect();
        let found = Repeatability::new(&points, &points, &shift(0.0));
        assert_eq!(found.partner, (0..40).map(Some).collect::<Vec<_>>());
        assert_eq!(found.share(), 1.0);
        assert!(Repeatability::new(&points, &[], &shift(0.0)).share().is_nan());
    }

    #[test]
    fn sizes_and_distances_are_those_of_the_first_view() {
        let larger = "scale=2".parse::<Condition>().unwrap().apply(&Picture::filled((100, 80), [0; 4]), 1);
        let truth = shift(0.0).changed(&larger);
        let first = [point(50.0, 40.0, 2.0)];
        let place = truth.locate(first[0].at).unwrap();
        let second = |dx, scale| [Point { at: place + DVec2::new(dx, 0.0), scale }];
        let error = |dx, scale| corresponding(first[0], second(dx, scale)[0], &truth);
        assert!(error(0.0, 4.0).unwrap() < 1e-6);
        assert_eq!(error(0.0, 2.0), None);
        let expected = overlap_error(Region::circle(DVec2::ZERO, 1.0), Region::circle(DVec2::new(4.0, 0.0), 1.0));
        assert!((error(8.0, 4.0).unwrap() - expected).abs() < 1e-9);
        assert_eq!(Repeatability::new(&first, &second(8.0, 4.0), &truth).correspondences(), 1);
        assert_eq!(Repeatability::new(&first, &second(30.0, 4.0), &truth).correspondences(), 0);
    }
}
