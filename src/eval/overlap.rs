//! How far two regions differ (Mikolajczyk, Tuytelaars, Schmid, Zisserman, Matas, Schaffalitzky, Kadir, Van Gool: 'A
//! comparison of affine region detectors', IJCV 65, 2005, section 4.1).

use std::f64::consts::PI;

use glam::{DMat2, DVec2};

/// The radius, in pixels, that regions are given before they are compared: with their own, large ones would overlap
/// whatever their distance.
pub const NORMAL_RADIUS: f64 = 30.0;

/// Strips in which a common area is measured. At this number the error of a share is below 1e-4.
const STRIPS: usize = 256;

/// An ellipse: all `centre + shape * u` with `u` of length 1 at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Its centre in pixels.
    pub centre: DVec2,
    /// What takes the unit circle to it; not singular.
    pub shape: DMat2,
}

impl Region {
    /// A circle.
    pub fn circle(centre: DVec2, radius: f64) -> Self {
        Self { centre, shape: DMat2::from_diagonal(DVec2::splat(radius)) }
    }

    /// Both regions larger by one factor, each about its own centre, so that the area of `self` is that of a circle of
    /// [`NORMAL_RADIUS`]. Their distance stays.
    fn normalised(self, other: Self) -> (Self, Self) {
        let factor = NORMAL_RADIUS / self.shape.determinant().abs().sqrt();
        let scaled = |region: Self| Self { shape: region.shape * factor, ..region };
        (scaled(self), scaled(other))
    }
}

/// One minus the regions' common area by the area of both together, after normalisation to the size of `reference`: 0
/// for the same region, 1 for those that have nothing in common.
pub fn overlap_error(reference: Region, other: Region) -> f64 {
    let (reference, other) = reference.normalised(other);
    error(reference, other)
}

/// The same of the regions as they are.
fn error(a: Region, b: Region) -> f64 {
    // In coordinates in which `a` is the unit circle, shares of areas are the same.
    let inverse = a.shape.inverse();
    let (centre, shape) = (inverse * (b.centre - a.centre), inverse * b.shape);
    let common = common_with_unit_circle(centre, shape);
    let union = PI + PI * shape.determinant().abs() - common;
    (1.0 - common / union).clamp(0.0, 1.0)
}

/// The area that an ellipse has in common with the unit circle, by upright strips.
fn common_with_unit_circle(centre: DVec2, shape: DMat2) -> f64 {
    // The ellipse is a dx^2 + 2 b dx dy + c dy^2 <= 1.
    let quadratic = (shape * shape.transpose()).inverse();
    let (a, b, c) = (quadratic.x_axis.x, quadratic.x_axis.y, quadratic.y_axis.y);
    let strip = PI / STRIPS as f64;
    (0..STRIPS)
        .map(|i| {
            // x = -cos(t): strips get narrow where the circle gets steep.
            let (sin, cos) = ((i as f64 + 0.5) * strip).sin_cos();
            let dx = -cos - centre.x;
            let discriminant = b * b * dx * dx - c * (a * dx * dx - 1.0);
            if discriminant <= 0.0 {
                return 0.0;
            }
            let (middle, half) = (centre.y - b * dx / c, discriminant.sqrt() / c);
            let height = (middle + half).min(sin) - (middle - half).max(-sin);
            height.max(0.0) * sin * strip
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One minus the share of common points on a fine grid.
    fn counted(a: Region, b: Region) -> f64 {
        let inside = |region: &Region, p: DVec2| (region.shape.inverse() * (p - region.centre)).length() <= 1.0;
        let (mut common, mut union) = (0, 0);
        for y in -600..600 {
            for x in -600..600 {
                let p = DVec2::new(f64::from(x), f64::from(y)) * 0.1;
                let (a, b) = (inside(&a, p), inside(&b, p));
                common += u32::from(a && b);
                union += u32::from(a || b);
            }
        }
        1.0 - f64::from(common) / f64::from(union)
    }

    #[test]
    fn agrees_with_counting() {
        let ellipse = |x, y, columns| Region { centre: DVec2::new(x, y), shape: DMat2::from_cols_array(&columns) };
        let cases = [
            (Region::circle(DVec2::ZERO, 20.0), Region::circle(DVec2::new(9.0, -4.0), 20.0)),
            (Region::circle(DVec2::ZERO, 20.0), Region::circle(DVec2::new(3.0, 2.0), 33.0)),
            (Region::circle(DVec2::ZERO, 20.0), ellipse(5.0, 3.0, [25.0, 8.0, -4.0, 12.0])),
            (ellipse(-8.0, 6.0, [3.0, 30.0, 14.0, -2.0]), ellipse(5.0, 3.0, [25.0, 8.0, -4.0, 12.0])),
            (ellipse(-20.0, 6.0, [3.0, 9.0, 14.0, -2.0]), ellipse(25.0, 3.0, [9.0, 8.0, -4.0, 12.0])),
        ];
        for (a, b) in cases {
            assert!((error(a, b) - counted(a, b)).abs() < 1e-3, "{} {}", error(a, b), counted(a, b));
            assert!((error(b, a) - error(a, b)).abs() < 1e-3);
        }
    }

    #[test]
    fn by_hand() {
        let circle = |x, radius| Region::circle(DVec2::new(x, 5.0), radius);
        assert!(error(circle(0.0, 7.0), circle(0.0, 7.0)) < 1e-9);
        assert_eq!(error(circle(0.0, 7.0), circle(15.0, 7.0)), 1.0);
        // Concentric: 1 - (3 / 4)^2.
        assert!((error(circle(0.0, 3.0), circle(0.0, 4.0)) - 7.0 / 16.0).abs() < 1e-4);
        // A lens of two unit circles 1 apart: 2 pi / 3 - sqrt(3) / 2.
        let lens = 2.0 * PI / 3.0 - 3.0f64.sqrt() / 2.0;
        assert!((error(circle(0.0, 1.0), circle(1.0, 1.0)) - (1.0 - lens / (2.0 * PI - lens))).abs() < 1e-4);
    }

    #[test]
    fn normalisation_keeps_the_distance_and_the_ratio_of_sizes() {
        let at = |x| DVec2::new(x, 0.0);
        let small = overlap_error(Region::circle(at(0.0), 2.0), Region::circle(at(6.0), 2.5));
        let large = overlap_error(Region::circle(at(0.0), 50.0), Region::circle(at(6.0), 62.5));
        let expected = error(Region::circle(at(0.0), 30.0), Region::circle(at(6.0), 37.5));
        assert!((small - expected).abs() < 1e-9 && (large - expected).abs() < 1e-9);
    }
}
