//! The distortion of a lens.

use glam::DVec2;

/// Radial distortion of a view: `x_d = x_u (1 + k1 r^2)` with coordinates from the centre of the view, `r` in units of the mean of its
/// width and height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lens {
    pub k1: f64,
}

impl Lens {
    /// Where the lens shows an undistorted place, `unit` being the mean side of the view; `None` beyond the circle up to which the
    /// lens shows places further out further out.
    pub fn distorted(&self, place: DVec2, unit: f64) -> Option<DVec2> {
        let square = place.length_squared() / (unit * unit);
        (1.0 + 3.0 * self.k1 * square > 0.0).then(|| place * (1.0 + self.k1 * square))
    }

    /// The place without distortion, by Newton's method, which approaches it from one side; for a place beyond what the lens can show,
    /// the closest.
    pub fn undistorted(&self, place: DVec2, unit: f64) -> DVec2 {
        const STEPS: usize = 12;
        /// Each step squares the error.
        const SETTLED: f64 = 1e-8;
        let distorted = place.length() / unit;
        if self.k1 == 0.0 || distorted == 0.0 {
            return place;
        }
        // Up to here the lens shows places further out further out, at two thirds of the radius.
        let end = if self.k1 < 0.0 { (-1.0 / (3.0 * self.k1)).sqrt() } else { f64::INFINITY };
        let mut radius = distorted;
        if distorted >= 2.0 / 3.0 * end {
            radius = end;
        } else {
            for _ in 0..STEPS {
                let slope = 1.0 + 3.0 * self.k1 * radius * radius;
                let step = (radius * (1.0 + self.k1 * radius * radius) - distorted) / slope;
                radius -= step;
                if step.abs() <= SETTLED * radius {
                    break;
                }
            }
        }
        place * (radius / distorted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_go_there_and_back_up_to_the_end_of_the_lens() {
        for k1 in [-0.4, -0.1, 0.2] {
            let lens = Lens { k1 };
            for radius in [0.0, 0.1, 0.5, 0.9] {
                let place = DVec2::new(0.6, -0.8) * radius;
                let back = lens.undistorted(lens.distorted(place, 1.0).unwrap(), 1.0);
                assert!((back - place).length() < 1e-6, "{k1}, {radius}: {back}");
            }
        }
        // The radius r (1 - 0.4 r^2) is largest at 1 / sqrt 1.2, and is 0.609 there.
        let lens = Lens { k1: -0.4 };
        assert_eq!(lens.distorted(DVec2::X, 1.0), None);
        for beyond in [0.61, 0.8, 3.0] {
            let closest = lens.undistorted(DVec2::Y * beyond, 1.0);
            assert!((closest - DVec2::Y / 1.2_f64.sqrt()).length() < 1e-9, "{beyond}: {closest}");
        }
    }
}
