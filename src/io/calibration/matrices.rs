//! Matrices in files, row by row.

use glam::{DMat3, DMat4, DVec2, DVec3};

use super::tree::Field;
use crate::{
    calibration::{Calibration, CameraModel, Lens, RadialTangential},
    error::Result,
    image::Size,
};

/// A rotation or another 3x3 matrix of nine numbers.
pub(super) fn matrix(rows: &[f64; 9]) -> DMat3 {
    DMat3::from_cols_array(rows).transpose()
}

/// A transform between coordinates of 16 numbers: rotation and translation.
pub(super) fn transform(field: &Field<'_>) -> Result<(DMat3, DVec3)> {
    let matrix = DMat4::from_cols_array(&field.array()?).transpose();
    if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        return Err(field.wrong("a 4x4 matrix with the last row 0 0 0 1"));
    }
    Ok((DMat3::from_mat4(matrix), matrix.w_axis.truncate()))
}

/// Focal lengths and principal point of a camera matrix `[fx 0 cx; 0 fy cy; 0 0 1]`.
pub(super) fn intrinsics(field: &Field<'_>) -> Result<(DVec2, DVec2)> {
    const RULE: &str = "[fx 0 cx; 0 fy cy; 0 0 1], without skew";
    match field.array()? {
        [fx, skew, cx, 0.0, fy, cy, 0.0, 0.0, 1.0] if skew.abs() <= 1e-9 * fx.abs() => {
            Ok((DVec2::new(fx, fy), DVec2::new(cx, cy)))
        }
        _ => Err(field.wrong(RULE)),
    }
}

/// A camera with a camera matrix and a lens.
pub(super) fn camera(field: &Field<'_>, lens: Lens) -> Result<CameraModel> {
    let (focal, centre) = intrinsics(field)?;
    CameraModel::new(focal, centre, lens).map_err(|error| field.refused(error))
}

/// Distortion by OpenCV's coefficients; none without the field.
pub(super) fn radial_tangential(field: Option<&Field<'_>>) -> Result<RadialTangential> {
    let Some(field) = field else { return Ok(RadialTangential::NONE) };
    let coefficients = field.numbers()?;
    if !matches!(coefficients.len(), 0 | 4 | 5 | 8 | 12 | 14) {
        return Err(field.wrong(&format!("4, 5, 8, 12 or 14 coefficients, and there are {}", coefficients.len())));
    }
    RadialTangential::new(&coefficients).map_err(|error| field.refused(error))
}

/// A projection matrix `[f 0 cx tx; 0 f cy ty; 0 0 1 tz]` of a rectified camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    pub focal: f64,
    pub centre: DVec2,
    /// The last column divided by the focal length: where the camera stands, negated, in the file's unit.
    pub shift: DVec2,
}

impl Projection {
    /// The projection of 12 numbers; `None` if they are none of a rectified camera.
    pub fn new(rows: &[f64; 12]) -> Option<Self> {
        match *rows {
            [f, 0.0, cx, tx, 0.0, fy, cy, ty, 0.0, 0.0, 1.0, _] if f > 0.0 && (fy - f).abs() <= 1e-3 * f => {
                Some(Self { focal: f, centre: DVec2::new(cx, cy), shift: DVec2::new(tx, ty) / f })
            }
            _ => None,
        }
    }

    pub fn of(field: &Field<'_>) -> Result<Self> {
        Self::new(&field.array()?).ok_or_else(|| field.wrong("[f 0 cx tx; 0 f cy ty; 0 0 1 0] of a rectified camera"))
    }

    /// The geometry of a pair of projections side by side, for lengths of `unit` metres; `None` if the second camera does not
    /// stand at the right of the first, or has other rows.
    pub fn pair([left, right]: [Self; 2], unit: f64, size: Option<Size>) -> Option<Calibration> {
        let baseline = unit * (left.shift.x - right.shift.x);
        let calibration = Calibration {
            focal: left.focal,
            baseline,
            doffs: right.centre.x - left.centre.x,
            cx: left.centre.x,
            cy: left.centre.y,
            size,
        };
        let same_rows = (left.focal - right.focal).abs() <= 1e-3 * left.focal
            && (left.centre.y - right.centre.y).abs() <= 0.25
            // Files of rectified pairs have a millimetre or two across.
            && (left.shift.y - right.shift.y).abs() * unit <= 0.02 * baseline;
        (same_rows && calibration.validate().is_ok()).then_some(calibration)
    }
}
