//! Overlap error of two regions (Mikolajczyk, Tuytelaars, Schmid, Zisserman, Matas, Schaffalitzky, Kadir, Van Gool: 'A
//! comparison of affine region detectors', IJCV 65, 2005, section 4.1).

use std::f64::consts::PI;

use glam::{DMat2, DVec2};

/// Radius to which regions are normalised before they are compared, in pixels: at their own size, large regions would
/// overlap whatever their distance.
pub const NORMAL_RADIUS: f64 = 30.0;

/// Number of strips in which a common area is measured; the error of a share is then below 1e-4.
const STRIPS: usize = 256;

/// An ellipse: all `centre + shape * u` with `u` of length 1 at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Centre of the ellipse, in pixels.
    pub centre: DVec2,
    /// Non-singular map from the unit circle to the ellipse, in pixels.
    pub shape: DMat2,
}

impl Region {
    /// A circle; centre and radius in pixels.
    pub fn circle(centre: DVec2, radius: f64) -> Self {
        Self { centre, shape: DMat2::from_diagonal(DVec2::splat(radius)) }
    }

    /// Enlarges both regions by one factor, each about its own centre, so that the area of `self` becomes that of a
    /// circle of [`NORMAL_RADIUS`]. The distance of the centres stays.
    fn normalised(self, other: Self) -> (Self, Self) {
        let factor = NORMAL_RADIUS / self.shape.determinant().abs().sqrt();
        let scaled = |region: Self| Self { shape: region.shape * factor, ..region };
        (scaled(self), scaled(other))
    }
}

/// Overlap error: one minus intersection over union, after normalisation to the size of `reference`; 0 for equal
/// regions, 1 for disjoint ones.
pub fn overlap_error(reference: Region, other: Region) -> f64 {
    let (reference, other) = reference.normalised(other);
    error(reference, other)
}

/// Overlap error of two regions without normalisation.
fn error(a: Region, b: Region) -> f64 {
    // Ratios of areas do not change in coordinates in which `a` is the unit circle.
    let inverse = a.shape.inverse();
    let (centre, shape) = (inverse * (b.centre - a.centre), inverse * b.shape);
    let common = common_with_unit_circle(centre, shape);
    let union = PI + PI * shape.determinant().abs() - common;
    (1.0 - common / union).clamp(0.0, 1.0)
}

/// Area of the intersection of an ellipse with the unit circle, integrated over vertical strips.
fn common_with_unit_circle(centre: DVec2, shape: DMat2) -> f64 {
    // The ellipse is a dx^2 + 2 b dx dy + c dy^2 <= 1.
    let quadratic = (shape * shape.transpose()).inverse();
    let (a, b, c) = (quadratic.x_axis.x, quadratic.x_axis.y, quadratic.y_axis.y);
    let strip = PI / STRIPS as f64;
    (0..STRIPS)
        .map(|i| {
            // With x = -cos(t), strips are narrow where the circle is steep.
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

    /// Overlap error, counted on a fine grid of points.
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
