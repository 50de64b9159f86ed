//! Which part of the rectified plane is worth a picture, and at which resolution.

use glam::{DMat2, DMat3, DVec2};

use crate::{calibration::CameraModel, image::Size};

/// Largest factor by which the source is drawn out anywhere in the rectified picture.
const MOST_DRAWN_OUT: f64 = 4.0;
/// Points along each side of a picture at which it is looked at.
const GRID: u32 = 129;
/// Step for derivatives, in units of the rectified focal length.
const STEP: f64 = 1e-4;
/// Shares of a pixel that are rounding.
const ROUNDING: f64 = 1e-3;

/// A part of the rectified plane, in pixels from the principal point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    least: DVec2,
    most: DVec2,
    /// Where the pixel in the middle of the source appears.
    middle: DVec2,
}

impl Window {
    /// The part that shows pixels of the source without drawing them out too much, for a rectified camera of focal length
    /// `focal`, in pixels.
    pub fn of(camera: &CameraModel, size: Size, rotation: &DMat3, focal: f64) -> Option<Self> {
        let last = DVec2::new(size.width.into(), size.height.into()) - 1.0;
        let at = |i: u32, j: u32| last * DVec2::new(i.into(), j.into()) / f64::from(GRID - 1);
        let places = (0..GRID).flat_map(|j| (0..GRID).map(move |i| (i, j))).filter_map(|(i, j)| {
            let place = appears(camera, rotation, at(i, j))?;
            let jacobian = jacobian(camera, rotation, place)? * (1.0 / focal);
            (least_stretch(&jacobian) * MOST_DRAWN_OUT >= 1.0).then_some(focal * place)
        });
        let (least, most) = places
            .map(|place| (place, place))
            .reduce(|(least, most), (place, _)| (least.min(place), most.max(place)))?;
        let middle = DVec2::new((size.width / 2).into(), (size.height / 2).into());
        let middle = appears(camera, rotation, middle).map_or(0.5 * (least + most), |place| focal * place);
        Some(Self { least, most, middle })
    }

    /// The window of a pair with this left view and that right view, with sides of at most `longest` pixels, in which the pixel in the
    /// middle of the left view is a pixel: around it a view that is hardly turned is resampled with the least loss. `None` if nothing
    /// corresponds.
    pub fn common(&self, right: &Self, longest: f64) -> Option<Self> {
        // A left column x corresponds to the right columns from x to the left.
        let least = DVec2::new(right.least.x, self.least.y.max(right.least.y));
        let most = DVec2::new(self.most.x, self.most.y.min(right.most.y));
        let middle = (0.5 * (self.middle + right.middle)).clamp(least.min(most), most.max(least));
        let half = 0.5 * (longest - 1.0);
        let least = self.middle + (least.max(middle - half) - self.middle - ROUNDING).ceil();
        let window = Self { least, most: most.min(middle + half), middle };
        (window.least.cmplt(window.most).all()).then_some(window)
    }

    /// Width and height, in pixels.
    pub fn size(&self) -> Size {
        let [width, height] = (self.most - self.least + ROUNDING).floor().to_array().map(|side| side as u32 + 1);
        Size::new(width, height)
    }

    /// The principal point in pixels of the window.
    pub fn principal_point(&self) -> DVec2 {
        -self.least
    }
}

/// The rectified focal length, in pixels, that keeps the resolution of a picture at its centre.
pub(super) fn resolution(camera: &CameraModel, size: Size, rotation: &DMat3) -> Option<f64> {
    let jacobian = jacobian(camera, rotation, centre(camera, size, rotation)?)?;
    Some(jacobian.determinant().abs().sqrt()).filter(|focal| focal.is_normal())
}

/// Where the centre of a picture appears, in units of the focal length.
fn centre(camera: &CameraModel, size: Size, rotation: &DMat3) -> Option<DVec2> {
    appears(camera, rotation, 0.5 * (DVec2::new(size.width.into(), size.height.into()) - 1.0))
}

/// Where a pixel appears in the rectified plane, in units of the focal length.
fn appears(camera: &CameraModel, rotation: &DMat3, pixel: DVec2) -> Option<DVec2> {
    let ray = *rotation * camera.unproject(pixel)?;
    (ray.z > 0.0).then(|| ray.truncate() / ray.z).filter(|place| place.is_finite())
}

/// Derivatives of the position in the source by the place in the rectified plane.
fn jacobian(camera: &CameraModel, rotation: &DMat3, place: DVec2) -> Option<DMat2> {
    let source = |place: DVec2| camera.project(rotation.transpose() * place.extend(1.0));
    let along = |axis: DVec2| Some((source(place + STEP * axis)? - source(place - STEP * axis)?) / (2.0 * STEP));
    Some(DMat2::from_cols(along(DVec2::X)?, along(DVec2::Y)?))
}

/// The lesser singular value of a matrix.
fn least_stretch(matrix: &DMat2) -> f64 {
    let [a, b, c, d] = matrix.to_cols_array();
    let (sum, difference) = ((a + d).hypot(b - c), (a - d).hypot(b + c));
    0.5 * (sum - difference).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lesser_singular_value_by_hand() {
        assert!((least_stretch(&DMat2::from_cols_array(&[3.0, 0.0, 0.0, -0.5])) - 0.5).abs() < 1e-12);
        // A turn, times 2.
        let turned = DMat2::from_angle(0.5) * 2.0;
        assert!((least_stretch(&turned) - 2.0).abs() < 1e-12);
        assert!(least_stretch(&DMat2::from_cols_array(&[1.0, 2.0, 2.0, 4.0])) < 1e-12);
    }

    #[test]
    fn the_window_of_a_pair_by_hand() {
        let window = |least: [f64; 2], most: [f64; 2]| {
            let (least, most) = (DVec2::from(least), DVec2::from(most));
            Window { least, most, middle: 0.5 * (least + most) }
        };
        let [left, right] = [window([-40.0, -30.0], [60.0, 30.0]), window([-60.0, -28.0], [45.0, 33.0])];
        let common = left.common(&right, 1000.0).unwrap();
        assert_eq!((common.least, common.most), (DVec2::new(-60.0, -28.0), DVec2::new(60.0, 30.0)));
        assert_eq!((common.size(), common.principal_point()), (Size::new(121, 59), DVec2::new(60.0, 28.0)));
        // The middles are at 10 and -7.5 along x: from 1.25 - 25 to 1.25 + 25, of which 10 - 33 is the first whole pixel.
        let cut = left.common(&right, 51.0).unwrap();
        assert_eq!(
            (cut.least, cut.most, cut.size()),
            (DVec2::new(-23.0, -23.0), DVec2::new(26.25, 26.25), Size::new(50, 50))
        );
        // 0.3 px beside the middle of the left view nothing lies on a pixel.
        let beside = Window { middle: left.middle + 0.3, ..left };
        let least = beside.common(&right, 1000.0).unwrap().least;
        assert!(least.abs_diff_eq(DVec2::new(-59.7, -27.7), 1e-9), "{least}");
        // What the left view sees lies left of all that the right view sees.
        assert_eq!(left.common(&window([61.0, -30.0], [90.0, 30.0]), 1000.0), None);
        assert_eq!(left.common(&window([-60.0, 31.0], [60.0, 60.0]), 1000.0), None);
    }
}
