//! Kalibr's `camchain.yaml`, its first two cameras.

use glam::DVec2;

use super::{
    matrices::{radial_tangential, transform},
    tree::Field,
    units,
};
use crate::{
    calibration::{
        CameraModel, DoubleSphere, ExtendedUnified, KannalaBrandt, Lens, RadialTangential, StereoCalibration, Unified,
    },
    error::Result,
};

const WAY_OUT: &str = "a camchain has cam0 and cam1 with camera_model, intrinsics, distortion_model, distortion_coeffs and \
                       resolution, and cam1.T_cn_cnm1";

/// The pair `cam0` and `cam1`.
pub(super) fn read(root: &Field<'_>, unit: Option<f64>) -> Result<StereoCalibration> {
    let [left, right] = [root.required(&["cam0"], WAY_OUT)?, root.required(&["cam1"], WAY_OUT)?];
    let cameras = [camera(&left)?, camera(&right)?];
    let size = |camera: &Field<'_>| camera.get(&["resolution"]).map(|size| size.size()).transpose();
    let pose = right.required(&["T_cn_cnm1"], WAY_OUT)?;
    let (rotation, translation) = transform(&pose)?;
    let translation = units::of_metres(translation, unit, root.path())?;
    StereoCalibration::new(cameras, [size(&left)?, size(&right)?], rotation, translation)
        .map_err(|error| pose.refused(error))
}

fn camera(field: &Field<'_>) -> Result<CameraModel> {
    let (model, intrinsics) = (field.required(&["camera_model"], WAY_OUT)?, field.required(&["intrinsics"], WAY_OUT)?);
    let (lens, [fx, fy, cx, cy]) = match model.text()? {
        "pinhole" => (pinhole(field)?, intrinsics.array()?),
        "omni" => {
            let [xi, fx, fy, cx, cy] = intrinsics.array()?;
            let Lens::Pinhole(distortion) = pinhole(field)? else {
                return Err(field
                    .required(&["distortion_model"], WAY_OUT)?
                    .wrong("radtan or none with camera_model omni"));
            };
            let lens = Unified::new(xi, distortion).map_err(|error| intrinsics.refused(error))?;
            (Lens::Unified(lens), [fx, fy, cx, cy])
        }
        "eucm" => {
            let [alpha, beta, fx, fy, cx, cy] = intrinsics.array()?;
            undistorted(field)?;
            let lens = ExtendedUnified::new(alpha, beta).map_err(|error| intrinsics.refused(error))?;
            (Lens::ExtendedUnified(lens), [fx, fy, cx, cy])
        }
        "ds" => {
            let [xi, alpha, fx, fy, cx, cy] = intrinsics.array()?;
            undistorted(field)?;
            let lens = DoubleSphere::new(xi, alpha).map_err(|error| intrinsics.refused(error))?;
            (Lens::DoubleSphere(lens), [fx, fy, cx, cy])
        }
        _ => return Err(model.wrong("pinhole, omni, eucm or ds")),
    };
    CameraModel::new(DVec2::new(fx, fy), DVec2::new(cx, cy), lens).map_err(|error| intrinsics.refused(error))
}

/// The lens of a pinhole with distortion.
fn pinhole(field: &Field<'_>) -> Result<Lens> {
    let Some(model) = field.get(&["distortion_model"]) else { return Ok(Lens::Pinhole(RadialTangential::NONE)) };
    let coefficients = || field.required(&["distortion_coeffs"], WAY_OUT);
    match model.text()? {
        "none" => Ok(Lens::Pinhole(RadialTangential::NONE)),
        "radtan" => Ok(Lens::Pinhole(radial_tangential(Some(&coefficients()?))?)),
        "equidistant" => {
            let coefficients = coefficients()?;
            let lens = KannalaBrandt::new(coefficients.array()?).map_err(|error| coefficients.refused(error))?;
            Ok(Lens::KannalaBrandt(lens))
        }
        _ => Err(model.wrong("radtan, equidistant or none: calibrate with one of these")),
    }
}

/// Refuses distortion beside a model that has its own.
fn undistorted(field: &Field<'_>) -> Result<()> {
    match pinhole(field)? {
        Lens::Pinhole(distortion) if distortion.is_none() => Ok(()),
        _ => Err(field.required(&["distortion_model"], WAY_OUT)?.wrong("none with this camera_model")),
    }
}
