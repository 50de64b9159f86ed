//! Rectification of a calibrated pair.

mod view;
mod window;

pub use view::RectifiedView;

use glam::{DMat3, DVec2, DVec3};

use self::window::{Window, resolution};
use super::WarpMap;
use crate::{
    calibration::{Calibration, StereoCalibration},
    error::{Error, Result},
    image::Size,
};

/// Least angle between the baseline and a camera's axis, in degrees: nearer to it the epipole comes into the picture, and no
/// turn makes rows of its epipolar lines.
const LEAST_ANGLE: f64 = 20.0;

/// The rectifying rotations of a calibrated pair, and the cameras that see the rectified pictures.
///
/// The rectified x axis is the baseline, from the left camera to the right one; z is the mean of both cameras' axes, made
/// perpendicular to x. So both views take an equal part in the turn of one to the other. Fusiello, Trucco and Verri, 'A compact
/// algorithm for rectification of stereo pairs', Machine Vision and Applications 12(1), 2000, with the mean axis in place of the
/// old left one.
///
/// Cameras above each other give pictures turned by a quarter, see [`Self::quarter_turns`].
#[derive(Clone, Debug)]
pub struct CalibratedRectification {
    views: [RectifiedView; 2],
    calibration: Calibration,
    quarter_turns: u32,
}

impl CalibratedRectification {
    /// Rectifies pictures of the given sizes, left and right, in pixels.
    ///
    /// - The focal length keeps the resolution at the centres of both pictures: a pixel there shows no more than one pixel of
    ///   the source.
    /// - The window is the rows that both views see, and the columns from the left edge of the right view to the right edge of
    ///   the left view, beyond which nothing corresponds. It leaves out where the rectified picture would be drawn out to more
    ///   than 4 times the source, and has sides of at most twice the longest side of the sources.
    /// - Both views have the same principal point: disparity is 0 at infinity.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `sizes` are not those of the calibration; [`Error::NotRectifiable`] if a camera stands in front of the
    /// other, or if the views have no direction in common.
    pub fn new(stereo: &StereoCalibration, sizes: [Size; 2]) -> Result<Self> {
        stereo.check_sizes(sizes)?;
        let rotations = rotations(stereo)?;
        let [left, right] = *stereo.cameras();
        let sources = [(left, sizes[0], rotations[0]), (right, sizes[1], rotations[1])];
        let [first, second] = sources.map(|(camera, size, rotation)| resolution(&camera, size, &rotation));
        let focal = first.zip(second).map(|(first, second)| first.max(second)).ok_or_else(no_common_view)?;
        let [left_window, right_window] =
            sources.map(|(camera, size, rotation)| Window::of(&camera, size, &rotation, focal));
        let longest = sizes.iter().map(|size| size.width.max(size.height)).max().unwrap_or(1);
        let window = left_window
            .zip(right_window)
            .and_then(|(left, right)| left.common(&right, 2.0 * f64::from(longest)))
            .ok_or_else(no_common_view)?;
        let (size, centre) = (window.size(), window.principal_point());
        let views =
            sources.map(|(camera, source, rotation)| RectifiedView::new(camera, source, rotation, size, focal, centre));
        let calibration = Calibration {
            focal,
            baseline: stereo.baseline(),
            doffs: 0.0,
            cx: centre.x,
            cy: centre.y,
            size: Some(size),
        };
        calibration.validate()?;
        let across = rotations[0].transpose().x_axis;
        let quarter_turns =
            (libm::atan2(across.y, across.x) / std::f64::consts::FRAC_PI_2).round().rem_euclid(4.0) as u32;
        Ok(Self { views, calibration, quarter_turns })
    }

    /// The left and the right view.
    pub fn views(&self) -> &[RectifiedView; 2] {
        &self.views
    }

    /// The geometry of the rectified pair.
    pub fn calibration(&self) -> &Calibration {
        &self.calibration
    }

    /// Width and height of both rectified pictures, in pixels.
    pub fn size(&self) -> Size {
        self.views[0].size()
    }

    /// By how many quarter turns, counter-clockwise, the rectified pictures are turned to the left picture as it was taken: 0 with
    /// the right camera at the right, 1 below, 2 at the left, 3 above.
    pub fn quarter_turns(&self) -> u32 {
        self.quarter_turns
    }

    /// For each pixel of the rectified views the position in the source, to within 1/32 px.
    ///
    /// # Errors
    /// As [`WarpMap::new`].
    pub fn maps(&self) -> Result<[WarpMap; 2]> {
        let [left, right] = &self.views;
        Ok([left.map()?, right.map()?])
    }

    /// A point of the rectified left view's coordinates in those of the left camera as it stood, in metres.
    pub fn in_left_camera(&self, point: DVec3) -> DVec3 {
        self.views[0].rotation().transpose() * point
    }

    /// The point in the coordinates of a view's camera as it stood, in metres, that appears at a position of the rectified picture with
    /// a disparity in pixels; 0 is the left view, 1 the right one. `None` at infinity and beyond.
    pub fn point(&self, view: usize, position: DVec2, disparity: f64) -> Option<DVec3> {
        let Calibration { focal, doffs, cx, cy, .. } = self.calibration;
        let depth = self.calibration.depth(disparity)?;
        let centre = DVec2::new(cx + if view == 0 { 0.0 } else { doffs }, cy);
        let rectified = ((position - centre) / focal).extend(1.0) * depth;
        Some(self.views[view].rotation().transpose() * rectified)
    }

    /// OpenCV's projection matrices `P1` and `P2` of the rectified views, row by row; the last column of `P2` is in pixels times
    /// metres.
    pub fn projections(&self) -> [[f64; 12]; 2] {
        let Calibration { focal, baseline, doffs, cx, cy, .. } = self.calibration;
        let rows = |cx: f64, shift: f64| [focal, 0.0, cx, shift, 0.0, focal, cy, 0.0, 0.0, 0.0, 1.0, 0.0];
        [rows(cx, 0.0), rows(cx + doffs, -focal * baseline)]
    }

    /// OpenCV's matrix `Q`, row by row: `Q (x, y, disparity, 1)` is a point of the rectified left view in homogeneous
    /// coordinates, in metres.
    pub fn reprojection(&self) -> [f64; 16] {
        let Calibration { focal, baseline, doffs, cx, cy, .. } = self.calibration;
        let [near, far] = [1.0 / baseline, doffs / baseline];
        [1.0, 0.0, 0.0, -cx, 0.0, 1.0, 0.0, -cy, 0.0, 0.0, 0.0, focal, 0.0, 0.0, near, far]
    }
}

/// From the coordinates of the left and of the right camera to rectified coordinates.
fn rotations(stereo: &StereoCalibration) -> Result<[DMat3; 2]> {
    let back = stereo.rotation().transpose();
    let x = stereo.right_centre().normalize();
    let axes = [DVec3::Z, back * DVec3::Z];
    let least = LEAST_ANGLE.to_radians().cos();
    if axes.iter().any(|axis| axis.dot(x).abs() > least) {
        return Err(unfit(
            "by the calibration one camera stands in front of the other: depth from forward motion is not possible by rows, the \
             baseline must lie across the view",
        ));
    }
    let mean = axes[0] + axes[1];
    let z = (mean - mean.dot(x) * x).try_normalize().ok_or_else(no_common_view)?;
    let left = DMat3::from_cols(x, z.cross(x), z).transpose();
    Ok([left, left * back])
}

fn no_common_view() -> Error {
    unfit(
        "by the calibration the cameras have no common field of view: check the rotation (from left to right) and the order of the \
         cameras",
    )
}

fn unfit(reason: &str) -> Error {
    Error::NotRectifiable { reason: reason.into() }
}

#[cfg(test)]
mod tests;
