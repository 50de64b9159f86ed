//! The geometry of a rectified pair, and depth from disparity.

use crate::{
    disparity::{self, DisparityMap},
    error::{Error, Result},
    image::{Plane, Size},
};

/// The geometry of a rectified pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Focal length of both cameras, in pixels.
    pub focal: f64,
    /// Distance between the cameras, in metres.
    pub baseline: f64,
    /// Difference of the principal points' columns, right minus left (cx1 - cx0), in pixels: `disparity + doffs` is 0
    /// at infinity.
    pub doffs: f64,
    /// Column of the principal point, in pixels: of the left camera, as in files, or of the right camera after
    /// [`Self::seen_from_right`].
    pub cx: f64,
    /// Row of both principal points, in pixels.
    pub cy: f64,
    /// Width and height of the calibrated pictures, in pixels; `None` if unknown.
    pub size: Option<Size>,
}

impl Calibration {
    /// A calibration for pictures of `size` (width and height in pixels) with the principal point at their centre.
    /// `focal` and `doffs` are in pixels, `baseline` in metres.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn centred(focal: f64, baseline: f64, doffs: f64, size: impl Into<Size>) -> Result<Self> {
        let size = size.into();
        let middle = |side: u32| (f64::from(side) - 1.0) / 2.0;
        let calibration =
            Self { focal, baseline, doffs, cx: middle(size.width), cy: middle(size.height), size: Some(size) };
        calibration.validate()?;
        Ok(calibration)
    }

    /// Checks that all values are plausible for a pair of cameras.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the accepted range, for a value outside it.
    pub fn validate(&self) -> Result<()> {
        let check = |name, value: f64, ok: bool, rule: &str| {
            if ok { Ok(()) } else { Err(Error::Parameter { name, value: value.to_string(), expected: rule.into() }) }
        };
        // A value above a thousand kilometres or a million pixels is a mistake; its depths would all be 0 or infinite.
        let positive = |value: f64| (1e-6..=1e6).contains(&value);
        let within = |value: f64| value.abs() <= 1e6;
        check("the focal length", self.focal, positive(self.focal), "it must be 10^-6 to 10^6 pixels")?;
        check("the baseline", self.baseline, positive(self.baseline), "it must be 10^-6 to 10^6 metres")?;
        check("doffs", self.doffs, within(self.doffs), "it must be -10^6 to 10^6 pixels")?;
        check("cx", self.cx, within(self.cx), "it must be -10^6 to 10^6 pixels")?;
        check("cy", self.cy, within(self.cy), "it must be -10^6 to 10^6 pixels")
    }

    /// Checks that the calibration is for pictures of this size (width and height in pixels): scaled pictures have
    /// another focal length.
    ///
    /// # Errors
    /// [`Error::Parameter`] with both sizes, if they differ, or, without a size of its own, if its principal point lies outside the pictures.
    pub fn check_size(&self, size: impl Into<Size>) -> Result<()> {
        let size = size.into();
        match self.size {
            Some(own) if own != size => Err(Error::Parameter {
                name: "the calibration",
                value: format!("for pictures of {own} pixels"),
                expected: format!("these are {size}: use the calibration that belongs to the pictures"),
            }),
            None if !self.has_centre_in(size) => Err(Error::Parameter {
                name: "the principal point",
                value: format!("({:.1}, {:.1})", self.cx, self.cy),
                expected: format!(
                    "it lies outside the pictures of {size} pixels: the calibration is for other ones; scale its numbers to these \
                     pictures, or give `focal` and `baseline` alone (for parts of larger pictures, too)"
                ),
            }),
            _ => Ok(()),
        }
    }

    fn has_centre_in(&self, size: Size) -> bool {
        (0.0..f64::from(size.width)).contains(&self.cx) && (0.0..f64::from(size.height)).contains(&self.cy)
    }

    /// A doubt about a calibration without a size of its own: its principal point lies by one factor away from the centre of pictures of
    /// `size`, along both axes, as that of pictures of another size does.
    pub fn doubt(&self, size: impl Into<Size>) -> Option<String> {
        /// Least distance of the factor from 1, and largest difference of the factors of both axes, as a share.
        const LIMITS: [f64; 2] = [0.12, 0.04];
        let size = size.into();
        let factor = |centre: f64, side: u32| 2.0 * (centre + 0.5) / f64::from(side);
        let [across, down] = [factor(self.cx, size.width), factor(self.cy, size.height)];
        let is_of_another = (across - 1.0).abs() > LIMITS[0] && (across / down - 1.0).abs() < LIMITS[1];
        (self.size.is_none() && is_of_another).then(|| {
            let other = Size { width: (2.0 * self.cx + 1.0).round() as u32, height: (2.0 * self.cy + 1.0).round() as u32 };
            format!(
                "the principal point ({:.1}, {:.1}) is the centre of pictures of about {other} pixels, and these are {size}: if the \
                 calibration is of pictures of that size, depths are off by a factor of {across:.2}; scale its numbers to these pictures",
                self.cx, self.cy
            )
        })
    }

    /// The calibration in the coordinates of the right camera, whose principal point lies `doffs` pixels further to the
    /// right.
    pub fn seen_from_right(self) -> Self {
        Self { cx: self.cx + self.doffs, ..self }
    }

    /// Depth along the optical axis, in metres, for a disparity in pixels: `baseline * focal / (disparity + doffs)`;
    /// `None` at infinity and beyond.
    pub fn depth(&self, disparity: f64) -> Option<f64> {
        let denominator = disparity + self.doffs;
        (denominator > 0.0).then(|| self.baseline * self.focal / denominator)
    }
}

/// Depth of each pixel of the map's view, in metres; +inf where there is no disparity or the depth is infinite.
pub fn depth_map(map: &DisparityMap, calibration: &Calibration) -> Plane<f32> {
    let depth = |&d: &i32| calibration.depth(f64::from(disparity::pixels(d)?));
    map.map(|d| depth(d).map_or(f32::INFINITY, |z| z as f32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disparity::NONE;

    #[test]
    fn depth_by_hand() {
        let calibration = Calibration::centred(1000.0, 0.2, 30.0, (3, 2)).unwrap();
        assert_eq!((calibration.cx, calibration.cy), (1.0, 0.5));
        // 0.2 m * 1000 px / (10 px + 30 px)
        assert_eq!(calibration.depth(10.0), Some(5.0));
        assert_eq!(calibration.depth(-30.0), None);
        assert_eq!(calibration.depth(-31.0), None);
        let map = DisparityMap::new((3, 1), vec![10 * 256, -30 * 256, NONE]).unwrap();
        assert_eq!(depth_map(&map, &calibration).data(), [5.0, f32::INFINITY, f32::INFINITY]);
    }

    #[test]
    fn numbers_are_validated() {
        let error =
            |focal, baseline, doffs| Calibration::centred(focal, baseline, doffs, (9, 9)).unwrap_err().to_string();
        assert_eq!(error(0.0, 1.0, 0.0), "the focal length is 0, but it must be 10^-6 to 10^6 pixels");
        assert_eq!(error(1.0, f64::NAN, 0.0), "the baseline is NaN, but it must be 10^-6 to 10^6 metres");
        assert_eq!(error(1.0, 1.0, f64::INFINITY), "doffs is inf, but it must be -10^6 to 10^6 pixels");
    }

    #[test]
    fn a_principal_point_tells_the_size_where_nothing_else_does() {
        let unsized_at = |cx: f64, cy: f64| Calibration { focal: 500.0, baseline: 0.1, doffs: 0.0, cx, cy, size: None };
        let of_640x480 = unsized_at(319.5, 239.5);
        let doubt = of_640x480.doubt((480, 360)).unwrap();
        assert!(
            doubt.contains("about 640x480 pixels, and these are 480x360") && doubt.contains("factor of 1.33"),
            "{doubt}"
        );
        assert!(of_640x480.doubt((1280, 960)).unwrap().contains("factor of 0.50"));
        // Off the centre along one axis, by different factors, or by little; or with a size that was checked.
        for near in
            [unsized_at(400.0, 239.5), unsized_at(280.0, 239.5), unsized_at(419.5, 299.5), unsized_at(340.0, 254.0)]
        {
            assert_eq!(near.doubt((640, 480)), None);
        }
        assert_eq!(Calibration { size: Some(Size::new(640, 480)), ..of_640x480 }.doubt((480, 360)), None);
        assert!(of_640x480.check_size((640, 480)).is_ok());
        assert!(
            of_640x480.check_size((300, 480)).unwrap_err().to_string().contains("lies outside the pictures of 300x480")
        );
    }

    #[test]
    fn pictures_of_another_size_are_refused() {
        let calibration = Calibration::centred(999.421, 0.193, 32.778, (741, 497)).unwrap();
        assert!(calibration.check_size((741, 497)).is_ok());
        let error = calibration.check_size((370, 248)).unwrap_err().to_string();
        assert!(error.contains("741x497") && error.contains("370x248"), "{error}");
    }
}
