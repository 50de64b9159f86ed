//! EuRoC's `sensor.yaml` of two cameras.

use glam::{DVec2, DVec3};

use super::{
    matrices::{radial_tangential, transform},
    tree::Field,
    units,
};
use crate::{
    calibration::{CameraModel, KannalaBrandt, Lens, StereoCalibration},
    error::Result,
};

const WAY_OUT: &str =
    "a camera's sensor.yaml has T_BS, resolution, intrinsics, distortion_model and distortion_coefficients";

/// The pair of a left and a right camera on one body.
pub(super) fn read(files: &[Field<'_>; 2], unit: Option<f64>) -> Result<StereoCalibration> {
    let [left, right] = files;
    let cameras = [camera(left)?, camera(right)?];
    let sizes = [left, right].map(|file| file.get(&["resolution"]).map(|size| size.size()).transpose());
    let [first, second] = sizes;
    let [(turn, from), (other_turn, other_from)] = [pose(left)?, pose(right)?];
    // From the left camera to the body, and from the body to the right camera.
    let rotation = other_turn.transpose() * turn;
    let translation: DVec3 = other_turn.transpose() * (from - other_from);
    let translation = units::of_metres(translation, unit, right.path())?;
    StereoCalibration::new(cameras, [first?, second?], rotation, translation).map_err(|error| right.refused(error))
}

fn pose(file: &Field<'_>) -> Result<(glam::DMat3, DVec3)> {
    transform(&file.required(&["T_BS"], WAY_OUT)?)
}

fn camera(file: &Field<'_>) -> Result<CameraModel> {
    let intrinsics = file.required(&["intrinsics"], WAY_OUT)?;
    let [fx, fy, cx, cy] = intrinsics.array()?;
    let coefficients = file.required(&["distortion_coefficients"], WAY_OUT)?;
    let model = file.required(&["distortion_model"], WAY_OUT)?;
    let lens = match model.text()? {
        "radial-tangential" | "radtan" | "plumb_bob" => Lens::Pinhole(radial_tangential(Some(&coefficients))?),
        "equidistant" => Lens::KannalaBrandt(KannalaBrandt::new(coefficients.array()?).map_err(|e| file.refused(e))?),
        _ => return Err(model.wrong("radial-tangential or equidistant")),
    };
    CameraModel::new(DVec2::new(fx, fy), DVec2::new(cx, cy), lens).map_err(|error| intrinsics.refused(error))
}
