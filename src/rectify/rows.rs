//! Models of the rows: the left row on which a pixel of the right view lies.

use glam::{DMat3, DVec2, DVec3};

use super::WarpMap;
use crate::{error::Result, image::Size};

/// Kind of a [`RowModel`], by its free parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RowKind {
    /// Rows correspond as they are; no parameter.
    AsIs,
    /// A vertical shift; one parameter.
    Shift,
    /// Shift, rotation and vertical scale; three parameters.
    Affine,
    /// Also the perspective of a small rotation out of the plane of the picture; five parameters.
    Projective,
}

impl RowKind {
    /// All kinds, the one with the fewest parameters first.
    pub const ALL: [Self; 4] = [Self::AsIs, Self::Shift, Self::Affine, Self::Projective];

    /// Number of free parameters.
    pub const fn parameters(self) -> usize {
        match self {
            Self::AsIs => 0,
            Self::Shift => 1,
            Self::Affine => 3,
            Self::Projective => 5,
        }
    }

    /// The name of the kind.
    pub const fn name(self) -> &'static str {
        match self {
            Self::AsIs => "as is",
            Self::Shift => "shift",
            Self::Affine => "affine",
            Self::Projective => "projective",
        }
    }
}

/// The left row on which a pixel of the right view lies:
/// `y_left = (p0 x + p1 y + p2) / (1 + p3 x + p4 y)`, with all coordinates in pixels from the centre of the picture.
///
/// The epipolar lines of a left view whose rows are epipolar lines have this form in the right view, whatever the depth: a
/// row of the fundamental matrix is zero (Hartley and Zisserman, Multiple View Geometry, 2003, section 11.12). Columns
/// are not part of the model: a warp of the right view by its rows alone keeps disparities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowModel {
    /// Column and row of the centre of the picture, in pixels.
    centre: [f64; 2],
    /// `p0` to `p4`; `p2` in pixels, `p3` and `p4` per pixel.
    p: [f64; 5],
}

impl RowModel {
    /// Rows correspond as they are, in pictures of any size.
    pub const AS_IS: Self = Self { centre: [0.0; 2], p: [0.0, 1.0, 0.0, 0.0, 0.0] };

    /// The model with the parameters `p0` to `p4` for pictures of `size`.
    pub fn new(size: impl Into<Size>, p: [f64; 5]) -> Self {
        let Size { width, height } = size.into();
        let half = |side: u32| (f64::from(side) - 1.0) / 2.0;
        Self { centre: [half(width), half(height)], p }
    }

    /// The parameters `p0` to `p4`.
    pub fn parameters(&self) -> [f64; 5] {
        self.p
    }

    /// The kind with the fewest parameters that includes the model.
    pub fn kind(&self) -> RowKind {
        match self.p {
            [0.0, 1.0, 0.0, 0.0, 0.0] => RowKind::AsIs,
            [0.0, 1.0, _, 0.0, 0.0] => RowKind::Shift,
            [_, _, _, 0.0, 0.0] => RowKind::Affine,
            _ => RowKind::Projective,
        }
    }

    /// Row of the left view, in pixels, on which the pixel `(x, y)` of the right view lies.
    pub fn left_row(&self, x: f64, y: f64) -> f64 {
        let [p0, p1, p2, p3, p4] = self.p;
        let (x, y) = (x - self.centre[0], y - self.centre[1]);
        (p0 * x + p1 * y + p2) / (1.0 + p3 * x + p4 * y) + self.centre[1]
    }

    /// Row of the right view, in pixels, at column `x` of the right view, for the row `y_left` of the left view: the
    /// inverse of [`Self::left_row`] for a given column.
    pub fn right_row(&self, x: f64, y_left: f64) -> f64 {
        let [p0, p1, p2, p3, p4] = self.p;
        let (x, y_left) = (x - self.centre[0], y_left - self.centre[1]);
        (y_left * (1.0 + p3 * x) - p0 * x - p2) / (p1 - p4 * y_left) + self.centre[1]
    }

    /// Largest difference of the left and the right row anywhere in a right view of `size`, in pixels.
    pub fn largest(&self, size: impl Into<Size>) -> f64 {
        let Size { width, height } = size.into();
        // Along a row of the right view, the left row rises or falls throughout: the ends of the row suffice.
        let ends = [0.0, f64::from(width.saturating_sub(1))];
        let rows = (0..height).map(f64::from);
        rows.flat_map(|y| ends.map(|x| (self.left_row(x, y) - y).abs())).fold(0.0, f64::max)
    }

    /// The model for pictures enlarged by `factor`, whose pixels are the blocks' pixels.
    #[must_use]
    pub fn enlarged(&self, factor: u32) -> Self {
        let factor = f64::from(factor);
        let [p0, p1, p2, p3, p4] = self.p;
        Self {
            centre: self.centre.map(|place| factor * place + (factor - 1.0) / 2.0),
            p: [p0, p1, factor * p2, p3 / factor, p4 / factor],
        }
    }

    /// The model for a view of `size` that `homography` maps to the picture of this model, pixels to pixels.
    pub(crate) fn behind(&self, homography: &DMat3, size: impl Into<Size>) -> Self {
        let [p0, p1, p2, p3, p4] = self.p;
        let ([cx, cy], of) = (self.centre, Self::new(size, self.p));
        // Linear forms of a place from the centre of the view: column and row from the centre of the picture, and what divides both.
        let form = |row: DVec3| DVec3::new(row.x, row.y, row.dot(DVec3::new(of.centre[0], of.centre[1], 1.0)));
        let [x, y, one] = [0, 1, 2].map(|row| form(homography.row(row)));
        let (x, y) = (x - cx * one, y - cy * one);
        let below = one + p3 * x + p4 * y;
        let above = p0 * x + p1 * y + p2 * one + (cy - of.centre[1]) * below;
        let [above, below] = [above, below].map(|form| form / below.z);
        Self { p: [above.x, above.y, above.z, below.x, below.y], ..of }
    }

    /// The map that resamples a right view of `size` so that its rows become the left ones and columns stay; `None` for rows
    /// as they are. Disparities are then those of the views as given.
    ///
    /// # Errors
    /// See [`WarpMap::new`].
    pub fn warp(&self, size: impl Into<Size>) -> Result<Option<WarpMap>> {
        let size = size.into();
        if self.kind() == RowKind::AsIs {
            return Ok(None);
        }
        WarpMap::new(size, size, |p| DVec2::new(p.x, self.right_row(p.x, p.y))).map(Some)
    }

    /// Whether each row of either view has exactly one row in the other, anywhere in pictures of `size`.
    pub(super) fn is_one_to_one(&self, size: Size) -> bool {
        let [_, p1, _, p3, p4] = self.p;
        let [x, y] = [size.width, size.height].map(|side| f64::from(side) / 2.0);
        (p3 * x).abs() + (p4 * y).abs() < 1.0 && (p4 * y).abs() < p1.abs()
    }

    /// Rotation of the right view against the left at its centre, in degrees, clockwise on the screen. Points that are
    /// rotated by `w` and enlarged by `s` lie on the left rows `(y cos w - x sin w) / s`.
    pub fn rotation(&self) -> f64 {
        let [by_x, by_y] = self.slopes();
        libm::atan2(0.0 - by_x, by_y).to_degrees()
    }

    /// Vertical size of an object at the centre of the right view divided by that in the left view.
    pub fn scale(&self) -> f64 {
        let [by_x, by_y] = self.slopes();
        1.0 / (by_x * by_x + by_y * by_y).sqrt()
    }

    /// Derivatives of the left row by column and row at the centre of the right view.
    fn slopes(&self) -> [f64; 2] {
        let [p0, p1, p2, p3, p4] = self.p;
        [p0 - p2 * p3, p1 - p2 * p4]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size::new(641, 481);

    #[test]
    fn rows_by_hand() {
        // 20 px right of and 10 px below the centre: (2 + 9 + 3) / (1 + 0.02 - 0.01) = 14 / 1.01.
        let model = RowModel::new(SIZE, [0.1, 0.9, 3.0, 0.001, -0.001]);
        assert!((model.left_row(340.0, 250.0) - (240.0 + 14.0 / 1.01)).abs() < 1e-12);
        assert_eq!(RowModel::AS_IS.left_row(17.0, 5.5), 5.5);
        assert_eq!(RowModel::AS_IS.right_row(17.0, 5.5), 5.5);
    }

    #[test]
    fn right_row_inverts_left_row() {
        let model = RowModel::new(SIZE, [0.05, 1.03, -4.0, 2e-4, -1e-4]);
        for (x, y) in [(0.0, 0.0), (640.0, 0.0), (320.0, 240.0), (13.7, 480.0)] {
            assert!((model.right_row(x, model.left_row(x, y)) - y).abs() < 1e-9);
        }
    }

    #[test]
    fn kind_is_the_least_that_includes_the_model() {
        let kind = |p| RowModel::new(SIZE, p).kind();
        assert_eq!(RowModel::AS_IS.kind(), RowKind::AsIs);
        assert_eq!(kind([0.0, 1.0, -0.5, 0.0, 0.0]), RowKind::Shift);
        assert_eq!(kind([0.1, 1.0, 0.0, 0.0, 0.0]), RowKind::Affine);
        assert_eq!(kind([0.0, 1.0, 0.0, 0.0, 1e-5]), RowKind::Projective);
    }

    #[test]
    fn largest_by_hand() {
        assert_eq!(RowModel::AS_IS.largest(SIZE), 0.0);
        assert_eq!(RowModel::new(SIZE, [0.0, 1.0, -2.5, 0.0, 0.0]).largest(SIZE), 2.5);
        // 0.01 * 320 + 0.1 * 240 + 1.
        let affine = RowModel::new(SIZE, [0.01, 1.1, 1.0, 0.0, 0.0]);
        assert!((affine.largest(SIZE) - 28.2).abs() < 1e-9);
        // y / (1 + y / 480) - y in the last row of 240 is -80, in the first row of -240 it is -240.
        let projective = RowModel::new(SIZE, [0.0, 1.0, 0.0, 0.0, 1.0 / 480.0]);
        assert!((projective.largest(SIZE) - 240.0).abs() < 1e-9);
    }

    #[test]
    fn rotation_and_scale_by_hand() {
        // Rotated by 30 degrees clockwise and halved: 2 (y cos 30 - x sin 30).
        let model = RowModel::new(SIZE, [-1.0, 3f64.sqrt(), 7.0, 0.0, 0.0]);
        assert!((model.rotation() - 30.0).abs() < 1e-12 && (model.scale() - 0.5).abs() < 1e-12);
        assert_eq!((RowModel::AS_IS.rotation(), RowModel::AS_IS.scale()), (0.0, 1.0));
        assert_eq!(RowModel::new(SIZE, [0.0, -1.0, 7.0, 0.0, 0.0]).rotation(), 180.0);
    }

    #[test]
    fn enlarged_rows_are_rows_of_the_enlarged_picture() {
        let model = RowModel::new(SIZE, [0.05, 1.03, -4.0, 2e-4, -1e-4]);
        let place = |reduced: f64| 3.0 * reduced + 1.0;
        let (x, y) = (100.0, 77.0);
        let enlarged = model.enlarged(3);
        assert!((enlarged.left_row(place(x), place(y)) - place(model.left_row(x, y))).abs() < 1e-9);
        assert_eq!(RowModel::AS_IS.enlarged(4).left_row(7.0, 9.0), 9.0);
    }

    #[test]
    fn rows_behind_a_homography_are_those_of_the_picture_it_leads_to() {
        let model = RowModel::new(SIZE, [0.05, 1.03, -4.0, 2e-4, -1e-4]);
        let there =
            DMat3::from_cols(DVec3::new(0.9, 0.1, 1e-4), DVec3::new(-0.2, 1.1, -2e-4), DVec3::new(7.0, -5.0, 1.0));
        let behind = model.behind(&there, (500, 400));
        for place in [DVec2::new(20.0, 30.0), DVec2::new(450.0, 20.0), DVec2::new(249.5, 380.0)] {
            let picture = there * place.extend(1.0) / (there * place.extend(1.0)).z;
            let rows = behind.left_row(place.x, place.y) - model.left_row(picture.x, picture.y);
            assert!(rows.abs() < 1e-9, "{place}: {rows}");
        }
        assert_eq!(RowModel::AS_IS.behind(&DMat3::IDENTITY, SIZE).kind(), RowKind::AsIs);
    }

    #[test]
    fn a_model_that_folds_the_picture_is_not_one_to_one() {
        assert!(RowModel::AS_IS.is_one_to_one(SIZE));
        assert!(RowModel::new(SIZE, [0.0, -1.0, 0.0, 0.0, 0.0]).is_one_to_one(SIZE));
        assert!(!RowModel::new(SIZE, [0.0, 1.0, 0.0, 0.004, 0.0]).is_one_to_one(SIZE), "1 - 0.004 * 320 is negative");
        assert!(!RowModel::new(SIZE, [0.0, 0.2, 0.0, 0.0, 0.001]).is_one_to_one(SIZE), "0.2 - 0.001 * 240 is negative");
    }
}
