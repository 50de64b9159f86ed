//! Ground truth of a pair of views: positions of the first view's points in the second, by a disparity map or a
//! homography, combined with a change of the second view.

use glam::{DAffine2, DMat2, DMat3, DVec2, DVec3};

use super::conditions::{Changed, VISIBLE, value_at};
use crate::{
    error::{Error, Result},
    image::{Plane, Size},
};

/// Ground truth of a pair of views.
#[derive(Clone, Debug)]
pub struct Truth {
    model: Model,
    first_size: Size,
    second_size: Size,
    /// Change of the second view: map from its original to its changed pixels, and mask of what is [`VISIBLE`].
    change: Option<(DAffine2, Plane<u8>)>,
}

#[derive(Clone, Debug)]
enum Model {
    Stereo {
        /// True disparities of the first view, in pixels; not finite where unknown.
        disparities: Plane<f32>,
        /// For each pixel of the first view: whether the second view shows it, too.
        shown: Plane<bool>,
        /// For each pixel of the second view: whether it shows a pixel of the first.
        claimed: Plane<bool>,
    },
    Plane {
        matrix: DMat3,
        inverse: DMat3,
    },
}

impl Truth {
    /// Ground truth of a rectified pair: the left pixel `(x, y)` with disparity `d` corresponds to the right pixel
    /// `(x - d, y)`. `disparities` are in pixels, not finite where unknown.
    ///
    /// `nonocc` is 255 where both views show the left pixel; without a mask all pixels count whose partner lies in the
    /// picture.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the sizes differ.
    pub fn stereo(disparities: Plane<f32>, nonocc: Option<&Plane<u8>>) -> Result<Self> {
        let Size { width, height } = disparities.size();
        if let Some(mask) = nonocc.filter(|mask| mask.size() != (width, height)) {
            return Err(Error::Parameter {
                name: "the mask",
                value: format!("{}x{} pixels", mask.width(), mask.height()),
                expected: format!("the truth has {width}x{height}"),
            });
        }
        let partner = |x: u32, y: u32| f64::from(x) - f64::from(disparities.get(x, y));
        let in_picture = |x: f64| (-0.5..f64::from(width) - 0.5).contains(&x);
        let shown = Plane::from_fn((width, height), |x, y| {
            in_picture(partner(x, y)) && nonocc.is_none_or(|mask| mask.get(x, y) == 255)
        });
        let mut claimed = Plane::filled((width, height), false);
        for y in 0..height {
            for x in (0..width).filter(|&x| shown.get(x, y)) {
                // Both neighbouring columns, so that a surface which is larger in the second view has no gaps.
                for column in [partner(x, y).floor(), partner(x, y).ceil()] {
                    claimed.set(column.clamp(0.0, f64::from(width - 1)) as u32, y, true);
                }
            }
        }
        let model = Model::Stereo { disparities, shown, claimed };
        Ok(Self { model, first_size: Size::new(width, height), second_size: Size::new(width, height), change: None })
    }

    /// Ground truth of two views of a plane, or of two views from one position: the homography `matrix` maps `(x, y,
    /// 1)` of the first view to the second. Sizes are width and height in pixels.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the matrix has no inverse.
    pub fn homography(matrix: DMat3, first_size: impl Into<Size>, second_size: impl Into<Size>) -> Result<Self> {
        let (first_size, second_size) = (first_size.into(), second_size.into());
        let inverse = matrix.inverse();
        if !matrix.is_finite() || !inverse.is_finite() {
            return Err(Error::Parameter {
                name: "the homography",
                value: in_rows(matrix),
                expected: "it must be nine finite numbers and have an inverse".into(),
            });
        }
        Ok(Self { model: Model::Plane { matrix, inverse }, first_size, second_size, change: None })
    }

    /// The ground truth after a change of the second view.
    ///
    /// # Panics
    /// If the second view was changed before; several conditions make one [`Changed`].
    #[must_use]
    pub fn changed(self, change: &Changed) -> Self {
        assert!(self.change.is_none(), "a second view is changed once");
        Self { change: Some((change.map, change.visible.clone())), ..self }
    }

    /// The truth with what `other` makes of its homography; `None` for the truth of a stereo pair, and for a matrix without an inverse.
    pub(super) fn with_homography(&self, other: impl FnOnce(DMat3) -> DMat3) -> Option<Self> {
        let Model::Plane { matrix, .. } = self.model else { return None };
        let truth = Self::homography(other(matrix), self.first_size, self.second_size).ok()?;
        Some(Self { change: self.change.clone(), ..truth })
    }

    /// Width and height of the first and the second view, in pixels.
    pub fn sizes(&self) -> [Size; 2] {
        [self.first_size, self.second_size]
    }

    /// Position in the second view of a point of the first, visible or not, in pixels; `None` where unknown.
    ///
    /// The disparity of a point is that of the pixel it lies in.
    pub fn locate(&self, first: DVec2) -> Option<DVec2> {
        let place = match &self.model {
            Model::Stereo { disparities, .. } => {
                let disparity = value_at(disparities, first).filter(|d| d.is_finite())?;
                DVec2::new(first.x - f64::from(disparity), first.y)
            }
            Model::Plane { matrix, .. } => project(matrix, first)?,
        };
        Some(self.change.as_ref().map_or(place, |(map, _)| map.transform_point2(place)))
    }

    /// Whether the second view shows a point of the first; false where its position is unknown.
    pub fn shows(&self, first: DVec2) -> bool {
        let in_model = match &self.model {
            Model::Stereo { shown, .. } => value_at(shown, first) == Some(true),
            Model::Plane { .. } => true,
        };
        in_model && self.locate(first).is_some_and(|second| self.is_visible(second))
    }

    /// Whether the first view shows the scene point at a position of the second view, too.
    pub fn is_shared(&self, second: DVec2) -> bool {
        if !self.is_visible(second) {
            return false;
        }
        let place = self.change.as_ref().map_or(second, |(map, _)| map.inverse().transform_point2(second));
        match &self.model {
            Model::Stereo { claimed, .. } => value_at(claimed, place) == Some(true),
            Model::Plane { inverse, .. } => {
                project(inverse, place).is_some_and(|first| lies_in(first, self.first_size))
            }
        }
    }

    /// Local linear map (rotation, scale, shear) from the surroundings of a point to the second view. Surfaces of a
    /// stereo scene are assumed to face the cameras.
    pub fn linear(&self, first: DVec2) -> DMat2 {
        let model = match &self.model {
            Model::Stereo { .. } => DMat2::IDENTITY,
            Model::Plane { matrix, .. } => {
                let DVec3 { x, y, z } = *matrix * first.extend(1.0);
                let column = |d: DVec3| DVec2::new(d.x * z - x * d.z, d.y * z - y * d.z) / (z * z);
                DMat2::from_cols(column(matrix.x_axis), column(matrix.y_axis))
            }
        };
        self.change.as_ref().map_or(model, |(map, _)| map.matrix2 * model)
    }

    /// Whether the position lies in the second view and is not occluded by a change.
    fn is_visible(&self, second: DVec2) -> bool {
        match &self.change {
            None => lies_in(second, self.second_size),
            Some((_, visible)) => value_at(visible, second) == Some(VISIBLE),
        }
    }
}

/// The elements of a matrix as they are written on paper, row by row.
fn in_rows(matrix: DMat3) -> String {
    let rows = matrix.transpose().to_cols_array_2d();
    format!("[{}]", rows.map(|[a, b, c]| format!("[{a}, {b}, {c}]")).join(", "))
}

/// Whether the position lies in a pixel of a picture of this size.
fn lies_in(place: DVec2, Size { width, height }: Size) -> bool {
    let inside = |at: f64, side: u32| at >= -0.5 && at < f64::from(side) - 0.5;
    inside(place.x, width) && inside(place.y, height)
}

/// Maps a point by a homography; `None` behind the camera.
fn project(matrix: &DMat3, point: DVec2) -> Option<DVec2> {
    let image = *matrix * point.extend(1.0);
    // A homography is defined up to its sign; the sign of its last element marks the front.
    let front = image.z * matrix.z_axis.z.signum() > 0.0;
    front.then(|| image.truncate() / image.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{eval::conditions::Condition, io::Picture};

    fn stereo() -> Truth {
        // Columns 0 and 1 leave the picture, column 4 is unknown, column 5 is occluded.
        let disparities = Plane::from_fn((9, 3), |x, _| if x == 4 { f32::INFINITY } else { 2.0 });
        let nonocc = Plane::from_fn((9, 3), |x, _| if x == 5 { 0 } else { 255 });
        Truth::stereo(disparities, Some(&nonocc)).unwrap()
    }

    #[test]
    fn a_disparity_leads_to_the_left() {
        let truth = stereo();
        assert_eq!(truth.locate(DVec2::new(6.25, 1.0)), Some(DVec2::new(4.25, 1.0)));
        assert_eq!(truth.locate(DVec2::new(4.4, 1.0)), None, "not known");
        assert_eq!(truth.locate(DVec2::new(9.0, 1.0)), None, "not in the picture");
        let shown: Vec<bool> = (0..9).map(|x| truth.shows(DVec2::new(x.into(), 1.0))).collect();
        assert_eq!(shown, [false, false, true, true, false, false, true, true, true]);
        let shared: Vec<bool> = (0..9).map(|x| truth.is_shared(DVec2::new(x.into(), 1.0))).collect();
        assert_eq!(shared, [true, true, false, false, true, true, true, false, false]);
    }

    #[test]
    fn a_change_of_the_second_view_moves_and_hides() {
        let picture = Picture::filled((9, 3), [0; 4]);
        let turned = "rotation=90".parse::<Condition>().unwrap().apply(&picture, 1);
        let truth = stereo().changed(&turned);
        // (6, 1) corresponds to (4, 1) of the second view, its centre; (8, 1) to (6, 1), which rotates to two rows
        // below the centre, outside the three rows.
        assert_eq!(truth.locate(DVec2::new(6.0, 1.0)), Some(DVec2::new(4.0, 1.0)));
        assert_eq!(truth.locate(DVec2::new(8.0, 1.0)), Some(DVec2::new(4.0, 3.0)));
        assert!(truth.shows(DVec2::new(7.0, 1.0)) && !truth.shows(DVec2::new(8.0, 1.0)));
        // The two positions come from (5, 1), and from (3, 1), which the first view does not show.
        assert!(truth.is_shared(DVec2::new(4.0, 2.0)) && !truth.is_shared(DVec2::new(4.0, 0.0)));
        assert_eq!(truth.linear(DVec2::ZERO), turned.map.matrix2);

        let framed = "occlusion=0.6".parse::<Condition>().unwrap().apply(&picture, 1);
        let truth = stereo().changed(&framed);
        // The frame is 2.7 columns wide, rounded to 3, and 0.9 rows high, rounded to 1.
        let shown: Vec<bool> = (0..9).map(|x| truth.shows(DVec2::new(x.into(), 1.0))).collect();
        assert_eq!(shown, [false, false, false, false, false, false, true, true, false]);
        assert!(!truth.is_shared(DVec2::new(1.0, 1.0)) && truth.is_shared(DVec2::new(5.0, 1.0)));
    }

    #[test]
    fn a_homography_by_hand() {
        let matrix = DMat3::from_cols_array(&[2.0, 0.0, 0.01, 0.0, 1.0, 0.0, 5.0, -3.0, 1.0]);
        let truth = Truth::homography(matrix, (100, 80), (60, 50)).unwrap();
        // (20 + 5, 30 - 3) / 1.1
        let place = truth.locate(DVec2::new(10.0, 30.0)).unwrap();
        assert!((place - DVec2::new(25.0, 27.0) / 1.1).length() < 1e-12);
        assert!(truth.shows(DVec2::new(10.0, 30.0)) && !truth.shows(DVec2::new(99.0, 30.0)));
        assert!(truth.is_shared(place) && !truth.is_shared(DVec2::new(4.0, 10.0)));
        assert_eq!(truth.locate(DVec2::new(-100.0, 0.0)), None, "at infinity");
        // The derivative agrees with finite differences.
        let (at, step) = (DVec2::new(10.0, 30.0), 1e-5);
        for axis in [DVec2::X, DVec2::Y] {
            let difference = (truth.locate(at + step * axis).unwrap() - place) / step;
            assert!((truth.linear(at) * axis - difference).length() < 1e-4);
        }
        // The negated matrix is the same homography.
        let negative = Truth::homography(-matrix, (100, 80), (60, 50)).unwrap();
        assert_eq!(negative.locate(at), Some(place));
    }

    #[test]
    fn what_is_no_truth_is_refused() {
        let message = |truth: Result<Truth>| truth.unwrap_err().to_string();
        let flat = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0, 0.0, 1.0]);
        let told = "the homography is [[1, 2, 3], [0, 0, 0], [0, 0, 1]], but it must be nine finite numbers and have an inverse";
        assert_eq!(message(Truth::homography(flat, (9, 9), (9, 9))), told);
        assert!(
            message(Truth::stereo(Plane::filled((3, 3), 0.0), Some(&Plane::filled((2, 3), 0)))).contains("2x3 pixels")
        );
    }
}
