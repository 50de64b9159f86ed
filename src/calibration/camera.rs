//! One camera: from rays to pixels and back.

use glam::{DVec2, DVec3};

use super::{DoubleSphere, ExtendedUnified, KannalaBrandt, RadialTangential, Unified};
use crate::error::{Result, check};

/// How a lens maps directions to a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Pinhole, with distortion in the plane at depth 1.
    Pinhole(RadialTangential),
    /// Equidistant fisheye with a polynomial.
    KannalaBrandt(KannalaBrandt),
    /// A sphere seen from beside its centre, with distortion.
    Unified(Unified),
    /// An ellipsoid seen from beside its centre.
    ExtendedUnified(ExtendedUnified),
    /// Two spheres.
    DoubleSphere(DoubleSphere),
}

/// A camera: a lens, focal lengths and a principal point.
///
/// Rays are in the camera's coordinates, x to the right, y down, z forward. Pixel centres lie at whole numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraModel {
    focal: DVec2,
    centre: DVec2,
    lens: Lens,
}

impl CameraModel {
    /// A camera with focal lengths along x and y and a principal point, all in pixels.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for focal lengths outside 10^-6 to 10^6 and coordinates of more than 10^6.
    pub fn new(focal: DVec2, centre: DVec2, lens: Lens) -> Result<Self> {
        for length in focal.to_array() {
            check((1e-6..=1e6).contains(&length), "the focal length", length, "it must be 10^-6 to 10^6 pixels")?;
        }
        for (name, coordinate) in ["cx", "cy"].into_iter().zip(centre.to_array()) {
            check(coordinate.abs() <= 1e6, name, coordinate, "it must be -10^6 to 10^6 pixels")?;
        }
        Ok(Self { focal, centre, lens })
    }

    /// A camera without distortion.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn pinhole(focal: DVec2, centre: DVec2) -> Result<Self> {
        Self::new(focal, centre, Lens::Pinhole(RadialTangential::NONE))
    }

    /// Focal lengths along x and y, in pixels.
    pub fn focal(&self) -> DVec2 {
        self.focal
    }

    /// The principal point, in pixels.
    pub fn centre(&self) -> DVec2 {
        self.centre
    }

    /// The lens.
    pub fn lens(&self) -> &Lens {
        &self.lens
    }

    /// True for a pinhole without distortion.
    pub fn is_undistorted(&self) -> bool {
        matches!(&self.lens, Lens::Pinhole(distortion) if distortion.is_none())
    }

    /// The position, in pixels, at which a point of the camera's coordinates, or a ray to it, appears; `None` where the model
    /// is not defined.
    pub fn project(&self, ray: DVec3) -> Option<DVec2> {
        let place = match &self.lens {
            Lens::Pinhole(distortion) => {
                (ray.z > 0.0).then(|| ray.truncate() / ray.z).and_then(|place| distortion.distorted(place))
            }
            Lens::KannalaBrandt(lens) => lens.project(ray),
            Lens::Unified(lens) => lens.project(ray),
            Lens::ExtendedUnified(lens) => lens.project(ray),
            Lens::DoubleSphere(lens) => lens.project(ray),
        };
        place.map(|place| self.focal * place + self.centre).filter(|pixel| pixel.is_finite())
    }

    /// The unit ray that appears at `pixel`; `None` where no ray does.
    pub fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        let place = (pixel - self.centre) / self.focal;
        let ray = match &self.lens {
            Lens::Pinhole(distortion) => distortion.undistorted(place).map(|place| place.extend(1.0)),
            Lens::KannalaBrandt(lens) => lens.unproject(place),
            Lens::Unified(lens) => lens.unproject(place),
            Lens::ExtendedUnified(lens) => lens.unproject(place),
            Lens::DoubleSphere(lens) => lens.unproject(place),
        };
        ray.and_then(DVec3::try_normalize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [DVec3; 4] = [
        DVec3::new(0.3, -0.2, 1.0),
        DVec3::new(-0.8, 0.5, 1.6),
        DVec3::new(1.2, 0.9, 1.0),
        DVec3::new(2.0, -1.0, -0.3),
    ];
    const OPENCV: [f64; 12] = [-0.28, 0.09, 0.0011, -0.0007, 0.012, 0.05, -0.02, 0.003, 0.002, -0.0015, 0.0009, 0.0004];

    fn camera(lens: Lens) -> CameraModel {
        CameraModel::new(DVec2::new(420.0, 425.0), DVec2::new(311.5, 240.25), lens).unwrap()
    }

    fn radial_tangential(coefficients: &[f64]) -> RadialTangential {
        RadialTangential::new(coefficients).unwrap()
    }

    fn lenses() -> Vec<Lens> {
        vec![
            Lens::Pinhole(RadialTangential::NONE),
            Lens::Pinhole(radial_tangential(&OPENCV[..5])),
            Lens::Pinhole(radial_tangential(&OPENCV)),
            Lens::KannalaBrandt(KannalaBrandt::new([-0.012, 0.021, -0.0063, 0.0008]).unwrap()),
            Lens::KannalaBrandt(KannalaBrandt::new([0.0; 4]).unwrap()),
            Lens::Unified(Unified::new(0.9, radial_tangential(&[-0.05, 0.01, 0.001, -0.002])).unwrap()),
            Lens::Unified(Unified::new(2.5, RadialTangential::NONE).unwrap()),
            Lens::ExtendedUnified(ExtendedUnified::new(0.6, 1.1).unwrap()),
            Lens::ExtendedUnified(ExtendedUnified::new(0.4, 0.9).unwrap()),
            Lens::DoubleSphere(DoubleSphere::new(-0.2, 0.55).unwrap()),
            Lens::DoubleSphere(DoubleSphere::new(0.3, 0.45).unwrap()),
        ]
    }

    fn assert_appear(lens: Lens, points: &[DVec3], expected: &[[f64; 2]]) {
        for (&point, &expected) in points.iter().zip(expected) {
            let pixel = camera(lens).project(point).unwrap();
            assert!((pixel - DVec2::from(expected)).length() < 1e-9, "{lens:?} {point}: {pixel}, not {expected:?}");
        }
    }

    /// `cv2.projectPoints` of OpenCV 5.0 with 5, 8 and 12 coefficients.
    #[test]
    fn pinholes_are_opencvs() {
        for (count, expected) in [
            (5, [[432.961987864, 158.34634906], [119.15836659860614, 361.9925211825222], [795.9952, 609.50115625]]),
            (
                8,
                [
                    [432.2164333675083, 158.849302490173],
                    [122.01209736186652, 360.1877063396864],
                    [774.9225022478962, 593.5084838488499],
                ],
            ),
            (
                12,
                [
                    [432.3149863675083, 158.90190049017298],
                    [122.22798374492316, 360.34123188289925],
                    [773.6231272478962, 595.22973384885],
                ],
            ),
        ] {
            assert_appear(Lens::Pinhole(radial_tangential(&OPENCV[..count])), &POINTS[..3], &expected);
        }
    }

    /// `cv2.fisheye.projectPoints` of OpenCV 5.0.
    #[test]
    fn fisheyes_are_opencvs() {
        let lens = Lens::KannalaBrandt(KannalaBrandt::new([-0.012, 0.021, -0.0063, 0.0008]).unwrap());
        let points = [POINTS[0], POINTS[1], POINTS[2], DVec3::new(4.0, -3.0, 1.0)];
        let expected = [
            [432.29130290579803, 158.76380359529497],
            [122.10596285709403, 360.0304550382961],
            [642.7160470306173, 491.619321407165],
            [782.1587336618356, -116.94636036835743],
        ];
        assert_appear(lens, &points, &expected);
    }

    /// Values of the papers' equations, computed in Python.
    #[test]
    fn spheres_are_those_of_their_papers() {
        assert_appear(
            Lens::Unified(Unified::new(0.9, radial_tangential(&[-0.05, 0.01, 0.001, -0.002])).unwrap()),
            &POINTS,
            &[
                [375.7039469485821, 196.93300343755905],
                [209.01851475657176, 305.05460490036694],
                [500.2505347599333, 383.84577476883624],
                [765.7118391537422, 10.44043852340431],
            ],
        );
        assert_appear(
            Lens::ExtendedUnified(ExtendedUnified::new(0.6, 1.1).unwrap()),
            &POINTS,
            &[
                [432.48318209777307, 158.63436128324832],
                [121.53359620043878, 360.3924428791868],
                [643.4106149596437, 492.14644885330097],
                [958.3550120559152, -87.02783348067135],
            ],
        );
        assert_appear(
            Lens::DoubleSphere(DoubleSphere::new(-0.2, 0.55).unwrap()),
            &POINTS,
            &[
                [463.1901154302622, 137.9193665748231],
                [72.31257119365466, 391.52181137306064],
                [736.9651627945734, 563.1476681923102],
                [1187.104912208722, -202.7643901056033],
            ],
        );
    }

    #[test]
    fn what_is_projected_is_found_again() {
        for lens in lenses() {
            let camera = camera(lens);
            let mut seen = 0;
            for (i, j) in (0..=90).flat_map(|i| (0..16).map(move |j| (i, j))) {
                // 2 degrees off the axis per step, around it in steps of 22.5 degrees.
                let ((sin, cos), around) =
                    ((2.0 * f64::from(i)).to_radians().sin_cos(), (22.5 * f64::from(j)).to_radians());
                let ray = DVec3::new(sin * around.cos(), sin * around.sin(), cos);
                let Some(pixel) = camera.project(ray) else { continue };
                let back = camera.unproject(pixel).unwrap_or_else(|| panic!("{lens:?}: {ray} at {pixel} is lost"));
                // Rays near the end of a model crowd together.
                let crowded = camera.project((ray + 1e-6 * DVec3::Z).normalize()).map_or(0.0, |p| (p - pixel).length());
                assert!(back.angle_between(ray) < if crowded < 1e-5 { 1e-3 } else { 1e-7 }, "{lens:?}: {ray} {back}");
                let error = (camera.project(back).unwrap() - pixel).length();
                assert!(error < 1e-9 * (1e3 + pixel.length()), "{lens:?}: {ray} {error}");
                seen += 1;
            }
            assert!(seen > 16 * 15, "{lens:?}: {seen} rays");
        }
    }

    #[test]
    fn every_pixel_has_a_ray_that_appears_there_or_none() {
        for lens in lenses() {
            let camera = camera(lens);
            for (x, y) in (-20..80).flat_map(|y| (-20..80).map(move |x| (x, y))) {
                let pixel = 20.0 * DVec2::new(x.into(), y.into());
                if let Some(ray) = camera.unproject(pixel) {
                    assert!((ray.length() - 1.0).abs() < 1e-12);
                    // The outermost ray itself can lie beyond the domain, which is open.
                    let there = camera.project(ray);
                    assert!(there.is_none_or(|there| (there - pixel).length() < 1e-6), "{lens:?}: {pixel} {there:?}");
                }
            }
        }
    }

    #[test]
    fn models_end_where_they_are_not_defined() {
        let behind = DVec3::new(0.1, 0.0, -1.0);
        for lens in lenses() {
            // An equidistant lens sees all but the point straight behind it.
            let sees_all = matches!(lens, Lens::KannalaBrandt(_));
            assert_eq!(camera(lens).project(behind).is_some(), sees_all, "{lens:?}");
            assert_eq!(camera(lens).project(-DVec3::Z), None);
            assert_eq!(camera(lens).project(DVec3::NAN), None);
            assert_eq!(camera(lens).project(DVec3::Z), Some(camera(lens).centre()));
        }
        assert_eq!(camera(Lens::Pinhole(RadialTangential::NONE)).project(DVec3::X), None);
        // Beyond the outline of the sphere: r^2 = 1 / (xi^2 - 1) for the unified model.
        let unified = camera(Lens::Unified(Unified::new(2.5, RadialTangential::NONE).unwrap()));
        let outline = 420.0 / (2.5_f64 * 2.5 - 1.0).sqrt();
        assert!(unified.unproject(DVec2::new(311.5 + 0.999 * outline, 240.25)).is_some());
        assert_eq!(unified.unproject(DVec2::new(311.5 + 1.001 * outline, 240.25)), None);
    }

    #[test]
    fn parameters_are_checked() {
        let error = |result: Result<CameraModel>| result.unwrap_err().to_string();
        let centre = DVec2::new(1.0, 1.0);
        assert!(error(CameraModel::pinhole(DVec2::new(0.0, 1.0), centre)).contains("the focal length is 0"));
        assert!(error(CameraModel::pinhole(DVec2::new(1.0, f64::NAN), centre)).contains("the focal length is NaN"));
        assert!(error(CameraModel::pinhole(centre, DVec2::new(0.0, 1e7))).contains("cy is 10000000"));
        assert!(Unified::new(-0.1, RadialTangential::NONE).is_err());
        assert!(ExtendedUnified::new(1.1, 1.0).is_err() && ExtendedUnified::new(0.5, 0.0).is_err());
        assert!(DoubleSphere::new(-1.0, 0.5).is_err() && DoubleSphere::new(0.0, f64::NAN).is_err());
        assert!(KannalaBrandt::new([0.0, f64::INFINITY, 0.0, 0.0]).is_err());
    }
}
