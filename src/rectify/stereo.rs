//! Rectification of both views, by a calibration or without one.

use glam::{DVec2, DVec3};

use super::{
    CalibratedRectification, RowModel, WarpMap,
    epipolar::{Model, Uncalibrated},
    map::TOLERANCE,
};
use crate::{calibration::Calibration, error::Result, image::Size};

/// A rectification of both views. Views are 0, the left one, and 1, the right one.
#[derive(Clone, Debug)]
pub enum StereoRectification {
    /// From a calibration.
    Calibrated(Box<CalibratedRectification>),
    /// From matched points alone.
    Uncalibrated(Box<Uncalibrated>),
}

impl StereoRectification {
    /// Width and height of both rectified pictures, in pixels.
    pub fn size(&self) -> Size {
        match self {
            Self::Calibrated(found) => found.size(),
            Self::Uncalibrated(found) => found.size,
        }
    }

    /// Width and height of the left and of the right view as they were taken, in pixels.
    pub fn source_sizes(&self) -> [Size; 2] {
        match self {
            Self::Calibrated(found) => found.views().each_ref().map(|view| view.source_size()),
            Self::Uncalibrated(found) => found.sources(),
        }
    }

    /// The geometry of the rectified pair; `None` without a calibration.
    pub fn calibration(&self) -> Option<&Calibration> {
        match self {
            Self::Calibrated(found) => Some(found.calibration()),
            Self::Uncalibrated(_) => None,
        }
    }

    /// The radial distortions of the left and the right lens that were found from the matches, [`Uncalibrated::k1`]; 0 with a
    /// calibration, which has its own.
    pub fn distortion(&self) -> [f64; 2] {
        match self {
            Self::Calibrated(_) => [0.0; 2],
            Self::Uncalibrated(found) => found.k1,
        }
    }

    /// Whether the rectified left picture is the left view as it was taken.
    pub fn keeps_left(&self) -> bool {
        match self {
            Self::Calibrated(_) => false,
            Self::Uncalibrated(found) => matches!(found.model, Model::Right(_)) && found.k1 == [0.0; 2],
        }
    }

    /// The position in the rectified picture at which a position of the view appears, in pixels; perhaps outside the picture. `None`
    /// if it appears nowhere.
    pub fn rectified_of(&self, view: usize, position: DVec2) -> Option<DVec2> {
        match self {
            Self::Calibrated(found) => found.views()[view].rectified_of(position),
            Self::Uncalibrated(found) => found.rectified(view, position),
        }
    }

    /// The position in the view that a position of the rectified picture shows, in pixels; perhaps outside the view. `None` if it
    /// shows nothing.
    pub fn source_of(&self, view: usize, position: DVec2) -> Option<DVec2> {
        match self {
            Self::Calibrated(found) => found.views()[view].source_of(position),
            Self::Uncalibrated(found) => found.original(view, position),
        }
    }

    /// For each pixel of a rectified picture the position in the view, to within 1/32 px.
    ///
    /// # Errors
    /// As [`WarpMap::new`].
    pub fn map(&self, view: usize) -> Result<WarpMap> {
        self.map_of(view, |position| position)
    }

    /// The map of the right view whose rows are then moved by `rows`, a model of the rectified pictures: one resampling does both.
    ///
    /// # Errors
    /// As [`WarpMap::new`].
    pub fn right_map_along(&self, rows: &RowModel) -> Result<WarpMap> {
        self.map_of(1, |position| DVec2::new(position.x, rows.right_row(position.x, position.y)))
    }

    /// For each pixel of a view the position in the rectified picture, to within 1/32 px.
    ///
    /// # Errors
    /// As [`WarpMap::new`].
    pub fn map_back(&self, view: usize) -> Result<WarpMap> {
        self.map_back_to(view, |place| place)
    }

    /// For each pixel of the right view the position in the rectified picture whose rows were moved by `rows`: the way back of
    /// [`Self::right_map_along`].
    ///
    /// # Errors
    /// As [`WarpMap::new`].
    pub fn right_map_back_along(&self, rows: &RowModel) -> Result<WarpMap> {
        self.map_back_to(1, |place| DVec2::new(place.x, rows.left_row(place.x, place.y)))
    }

    fn map_back_to(&self, view: usize, moved: impl Fn(DVec2) -> DVec2) -> Result<WarpMap> {
        let rectified_of = |position| self.rectified_of(view, position).map_or(DVec2::NAN, &moved);
        WarpMap::within(TOLERANCE, self.source_sizes()[view], self.size(), rectified_of)
    }

    /// The point in the coordinates of a view's camera as it stood, in metres, that appears at a position of the rectified picture with
    /// a disparity in pixels; `None` at infinity and beyond, and without a calibration.
    pub fn point(&self, view: usize, position: DVec2, disparity: f64) -> Option<DVec3> {
        let Self::Calibrated(found) = self else { return None };
        found.point(view, position, disparity)
    }

    fn map_of(&self, view: usize, moved: impl Fn(DVec2) -> DVec2) -> Result<WarpMap> {
        let source_of = |position| self.source_of(view, moved(position)).unwrap_or(DVec2::NAN);
        WarpMap::within(TOLERANCE, self.size(), self.source_sizes()[view], source_of)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, IVec2};

    use super::*;
    use crate::calibration::{CameraModel, Lens, RadialTangential, StereoCalibration};

    /// Cameras with distorted lenses, 0.1 m apart, turned against each other.
    fn calibrated() -> StereoRectification {
        let lens = Lens::Pinhole(RadialTangential::new(&[-0.2, 0.05]).unwrap());
        let camera = CameraModel::new(DVec2::new(300.0, 302.0), DVec2::new(161.0, 118.0), lens).unwrap();
        let sizes = [Size::new(320, 240); 2];
        let turned = DMat3::from_rotation_y(0.05) * DMat3::from_rotation_z(0.1);
        let stereo =
            StereoCalibration::new([camera; 2], sizes.map(Some), turned, DVec3::new(-0.1, 0.004, 0.002)).unwrap();
        StereoRectification::Calibrated(CalibratedRectification::new(&stereo, sizes).unwrap().into())
    }

    #[test]
    fn maps_lead_there_and_back() {
        let rectification = calibrated();
        for view in [0, 1] {
            let [there, back] = [rectification.map(view), rectification.map_back(view)].map(Result::unwrap);
            assert_eq!((there.size(), back.size()), (rectification.size(), Size::new(320, 240)));
            for (x, y) in [(160, 120), (40, 30), (300, 200)] {
                let shown = back.source_at(x, y).unwrap().as_dvec2() / 2048.0;
                let taken = rectification.source_of(view, shown).unwrap();
                assert!((taken - DVec2::new(x.into(), y.into())).length() < 0.05, "view {view}, ({x}, {y}): {taken}");
            }
        }
    }

    #[test]
    fn rows_are_moved_in_the_rectified_picture() {
        let rectification = calibrated();
        // A right picture that lies 2 px lower is lifted: its pixels show what was 2 px further down.
        let rows = RowModel::new(rectification.size(), [0.0, 1.0, -2.0, 0.0, 0.0]);
        let [plain, moved] = [rectification.map(1), rectification.right_map_along(&rows)].map(Result::unwrap);
        for (x, y) in [(100, 90), (200, 150)] {
            let [below, there] = [plain.source_at(x, y + 2), moved.source_at(x, y)].map(Option::unwrap);
            assert!((below - there).abs().max_element() <= 2 * 2048 / 32, "{below} {there}");
        }
        // On the way back rows are found where they were moved to.
        let [plain, moved] = [rectification.map_back(1), rectification.right_map_back_along(&rows)].map(Result::unwrap);
        for (x, y) in [(100, 90), (200, 150)] {
            let [there, lifted] = [plain.source_at(x, y), moved.source_at(x, y)].map(Option::unwrap);
            let off = lifted - there + IVec2::new(0, 2 * 2048);
            assert!(off.abs().max_element() <= 2 * 2048 / 32, "{there} {lifted}");
        }
    }

    #[test]
    fn a_point_appears_where_both_cameras_see_it() {
        let rectification = calibrated();
        let StereoRectification::Calibrated(found) = &rectification else { unreachable!() };
        let point = DVec3::new(0.2, -0.1, 1.5);
        let seen = [0, 1].map(|view| {
            let camera = found.views()[view].camera();
            let turned = DMat3::from_rotation_y(0.05) * DMat3::from_rotation_z(0.1);
            let own = if view == 0 { point } else { turned * point + DVec3::new(-0.1, 0.004, 0.002) };
            (own, rectification.rectified_of(view, camera.project(own).unwrap()).unwrap())
        });
        let [(_, left), (_, right)] = seen;
        assert!((left.y - right.y).abs() < 1e-6, "{left} {right}");
        for (view, (own, place)) in seen.into_iter().enumerate() {
            let found = rectification.point(view, place, left.x - right.x).unwrap();
            assert!((found - own).length() < 1e-6, "view {view}: {found} {own}");
            assert_eq!(rectification.point(view, place, 0.0), None, "infinity");
        }
    }
}
