//! Two cameras and the pose of one to the other.

use glam::{DMat3, DVec2, DVec3};

use super::{Calibration, CameraModel};
use crate::{
    error::{Error, Result, check},
    image::Size,
};

/// Largest deviation of a rotation matrix from a rotation, per element: files have six digits at least.
const ROTATION_TOLERANCE: f64 = 1e-3;
/// Largest difference of focal lengths of a rectified pair, relative.
const FOCAL_TOLERANCE: f64 = 1e-3;
/// Largest error of rows of a rectified pair, in pixels.
const ROW_TOLERANCE: f64 = 0.25;
/// Largest share of the baseline of a rectified pair across its rows.
const OFF_AXIS: f64 = 1e-3;

/// The cameras of a pair as it was taken, left and right.
///
/// A point `p` of the left camera's coordinates is `rotation * p + translation` in the right camera's, as in OpenCV's
/// `stereoCalibrate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StereoCalibration {
    cameras: [CameraModel; 2],
    sizes: [Option<Size>; 2],
    rotation: DMat3,
    translation: DVec3,
}

impl StereoCalibration {
    /// A pair of cameras; `translation` is in metres, `sizes` are those of the calibrated pictures in pixels, if known.
    ///
    /// `rotation` is made exactly a rotation.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `rotation` is none to within 0.001 per element, or the baseline is outside 10^-6 to 10^6
    /// metres.
    pub fn new(
        cameras: [CameraModel; 2],
        sizes: [Option<Size>; 2],
        rotation: DMat3,
        translation: DVec3,
    ) -> Result<Self> {
        let rotation = nearest_rotation(&rotation).ok_or_else(|| Error::Parameter {
            name: "the rotation",
            value: format!("{:?}", rotation.transpose().to_cols_array()),
            expected: "it must be a rotation matrix, row by row".into(),
        })?;
        let baseline = translation.length();
        check((1e-6..=1e6).contains(&baseline), "the baseline", baseline, "it must be 10^-6 to 10^6 metres")?;
        Ok(Self { cameras, sizes, rotation, translation })
    }

    /// The rectified pair that `calibration` describes.
    ///
    /// # Errors
    /// As [`Calibration::validate`].
    pub fn from_rectified(calibration: &Calibration) -> Result<Self> {
        calibration.validate()?;
        let Calibration { focal, baseline, doffs, cx, cy, size } = *calibration;
        let camera = |cx: f64| CameraModel::pinhole(DVec2::splat(focal), DVec2::new(cx, cy));
        Self::new([camera(cx)?, camera(cx + doffs)?], [size; 2], DMat3::IDENTITY, DVec3::new(-baseline, 0.0, 0.0))
    }

    /// The left and the right camera.
    pub fn cameras(&self) -> &[CameraModel; 2] {
        &self.cameras
    }

    /// Sizes of the calibrated pictures, in pixels.
    pub fn sizes(&self) -> [Option<Size>; 2] {
        self.sizes
    }

    /// The rotation from the left camera's coordinates to the right camera's.
    pub fn rotation(&self) -> DMat3 {
        self.rotation
    }

    /// The left camera's centre in the right camera's coordinates, in metres.
    pub fn translation(&self) -> DVec3 {
        self.translation
    }

    /// The distance between the cameras, in metres.
    pub fn baseline(&self) -> f64 {
        self.translation.length()
    }

    /// The right camera's centre in the left camera's coordinates, in metres.
    pub fn right_centre(&self) -> DVec3 {
        -(self.rotation.transpose() * self.translation)
    }

    /// Checks that the calibration is for pictures of these sizes, left and right, in pixels: scaled or cropped pictures have
    /// other camera matrices.
    ///
    /// # Errors
    /// [`Error::Parameter`] with both sizes, if they differ.
    pub fn check_sizes(&self, sizes: [Size; 2]) -> Result<()> {
        for ((name, own), size) in ["the left view", "the right view"].into_iter().zip(self.sizes).zip(sizes) {
            if let Some(own) = own.filter(|&own| own != size) {
                return Err(Error::Parameter {
                    name: "the calibration",
                    value: format!("for pictures of {own} pixels"),
                    expected: format!("{name} is {size}: use the calibration that belongs to the pictures"),
                });
            }
        }
        Ok(())
    }

    /// The geometry of the pair if its pictures are rectified already: no distortion, one focal length to within 0.1 %, rows
    /// that correspond to within 0.25 px, and the right camera to the right of the left one.
    pub fn rectified(&self) -> Option<Calibration> {
        let [left, right] = self.cameras;
        let focal = left.focal().x;
        let is_same = |length: f64| (length - focal).abs() <= FOCAL_TOLERANCE * focal;
        let lengths = [left.focal().y, right.focal().x, right.focal().y];
        let turn = (self.rotation - DMat3::IDENTITY).to_cols_array().into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let across = self.translation.with_x(0.0).length();
        let is_rectified = self.cameras.iter().all(CameraModel::is_undistorted)
            && lengths.into_iter().all(is_same)
            && (right.centre().y - left.centre().y).abs() <= ROW_TOLERANCE
            && turn * focal <= ROW_TOLERANCE
            && across <= OFF_AXIS * self.baseline()
            && self.translation.x < 0.0;
        is_rectified.then(|| Calibration {
            focal,
            baseline: self.baseline(),
            doffs: right.centre().x - left.centre().x,
            cx: left.centre().x,
            cy: left.centre().y,
            size: self.sizes[0].or(self.sizes[1]),
        })
    }
}

/// The rotation nearest to a matrix, if it is near enough: the orthogonal factor of its polar decomposition (Higham, 'Computing the
/// polar decomposition', SIAM J. Sci. Stat. Comput. 7(4), 1986).
fn nearest_rotation(matrix: &DMat3) -> Option<DMat3> {
    let near = |a: &DMat3, b: &DMat3| a.abs_diff_eq(*b, ROTATION_TOLERANCE);
    if !(matrix.is_finite() && near(&(*matrix * matrix.transpose()), &DMat3::IDENTITY) && matrix.determinant() > 0.0) {
        return None;
    }
    let step = |rotation: DMat3| (rotation + rotation.inverse().transpose()) * 0.5;
    // Convergence is quadratic, from 10^-3 on.
    Some((0..4).fold(*matrix, |rotation, _| step(rotation)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> CameraModel {
        CameraModel::pinhole(DVec2::splat(400.0), DVec2::new(170.0, 127.0)).unwrap()
    }

    fn pair(rotation: DMat3, translation: DVec3) -> Result<StereoCalibration> {
        StereoCalibration::new([camera(); 2], [Some(Size::new(340, 255)); 2], rotation, translation)
    }

    #[test]
    fn a_rectified_pair_is_told_from_others() {
        let shift = DVec3::new(-0.1, 0.0, 0.0);
        let calibration = Calibration { focal: 400.0, baseline: 0.1, doffs: 12.0, cx: 170.0, cy: 127.0, size: None };
        let there = StereoCalibration::from_rectified(&calibration).unwrap();
        assert_eq!(there.rectified(), Some(calibration));
        assert!(pair(DMat3::IDENTITY, shift).unwrap().rectified().is_some());
        for other in [
            pair(DMat3::from_rotation_x(0.001), shift),
            pair(DMat3::IDENTITY, DVec3::new(0.1, 0.0, 0.0)),
            pair(DMat3::IDENTITY, DVec3::new(-0.1, 0.001, 0.0)),
            StereoCalibration::new(
                [camera(), CameraModel::pinhole(DVec2::splat(402.0), DVec2::new(170.0, 127.0)).unwrap()],
                [None; 2],
                DMat3::IDENTITY,
                shift,
            ),
        ] {
            assert_eq!(other.unwrap().rectified(), None);
        }
    }

    #[test]
    fn a_rotation_is_made_exact_or_refused() {
        let exact = DMat3::from_rotation_y(0.3) * DMat3::from_rotation_x(-0.1);
        let rounded = DMat3::from_cols_array(&exact.to_cols_array().map(|x| (1e4 * x).round() / 1e4));
        let kept = pair(rounded, DVec3::X).unwrap().rotation();
        assert!((kept * kept.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-15) && kept.abs_diff_eq(exact, 1e-4));
        for wrong in [DMat3::ZERO, -DMat3::IDENTITY, 1.01 * DMat3::IDENTITY, DMat3::NAN] {
            let error = pair(wrong, DVec3::X).unwrap_err().to_string();
            assert!(error.starts_with("the rotation is [") && error.contains("row by row"), "{error}");
        }
        assert!(pair(exact, DVec3::ZERO).unwrap_err().to_string().starts_with("the baseline is 0, but"));
        assert!(pair(exact, DVec3::NAN).is_err());
    }

    #[test]
    fn centres_are_inverse_to_each_other() {
        let pair = pair(DMat3::from_rotation_y(0.3), DVec3::new(-0.2, 0.03, 0.01)).unwrap();
        assert!((pair.rotation() * pair.right_centre() + pair.translation()).length() < 1e-15);
        assert!((pair.right_centre().length() - pair.baseline()).abs() < 1e-15);
    }

    #[test]
    fn pictures_of_another_size_are_refused() {
        let pair = pair(DMat3::IDENTITY, DVec3::new(-0.1, 0.0, 0.0)).unwrap();
        assert!(pair.check_sizes([Size::new(340, 255); 2]).is_ok());
        let error = pair.check_sizes([Size::new(340, 255), Size::new(341, 255)]).unwrap_err().to_string();
        let expected =
            "for pictures of 340x255 pixels, but the right view is 341x255: use the calibration that belongs";
        assert!(error.contains(expected), "{error}");
    }
}
