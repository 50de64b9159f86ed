//! Points of a rectified pair in metres.

use glam::DVec2;

use super::{back::WayBack, rectified::RectifiedPair};
use crate::{
    dense::View,
    disparity::{DisparityMap, pixels},
    image::Plane,
};

impl RectifiedPair {
    /// The point that each pixel of a map shows: x right, y down and z forward, in metres, in the coordinates of the reference view's
    /// camera as it stood; NaN where there is none. `None` without a calibration.
    ///
    /// `map` is that of the rectified reference picture, or one taken back to the view by `back`.
    pub fn points_in_metres(
        &self,
        map: &DisparityMap,
        reference: View,
        back: Option<&WayBack>,
    ) -> Option<Plane<[f32; 3]>> {
        self.rectification.calibration()?;
        let view = if reference == View::Left { 0 } else { 1 };
        let point = |x: u32, y: u32| {
            let disparity = pixels(map.get(x, y))?;
            let place = match back {
                Some(back) => back.place(x, y)?,
                None => DVec2::new(x.into(), y.into()),
            };
            self.rectification.point(view, place, disparity.into())
        };
        Some(Plane::from_fn(map.size(), |x, y| point(x, y).map_or([f32::NAN; 3], |point| point.as_vec3().to_array())))
    }
}
