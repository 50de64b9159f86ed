//! ROS `camera_info` of a left and a right camera: REP 104, and the YAML of `camera_calibration_parsers`.

#[cfg(feature = "recordings")]
use std::path::Path;

use glam::DVec3;

#[cfg(feature = "recordings")]
use super::{Loaded, tree::Node};
use super::{
    matrices::{Projection, camera, matrix, radial_tangential},
    tree::Field,
    units,
};
#[cfg(feature = "recordings")]
use crate::io::recording::CameraInfo;
use crate::{
    calibration::{Calibration, CameraModel, KannalaBrandt, Lens, StereoCalibration},
    error::Result,
    image::Size,
};

const WAY_OUT: &str = "camera_info has image_width, image_height, camera_matrix, distortion_model, distortion_coefficients, \
                       rectification_matrix and projection_matrix";

const CAMERA: [&str; 3] = ["camera_matrix", "K", "k"];
const DISTORTION: [&str; 3] = ["distortion_coefficients", "D", "d"];
const RECTIFICATION: [&str; 3] = ["rectification_matrix", "R", "r"];
const PROJECTION: [&str; 3] = ["projection_matrix", "P", "p"];

pub(super) fn recognised(root: &Field<'_>) -> bool {
    root.has(&PROJECTION) && root.has(&CAMERA) && root.has(&["image_width", "width"])
}

/// The pair, and its geometry after rectification by the files' own matrices.
pub(super) fn read(files: &[Field<'_>; 2], unit: Option<f64>) -> Result<(StereoCalibration, Option<Calibration>)> {
    let [left, right] = files;
    let cameras = [of_file(left)?, of_file(right)?];
    let [left_size, right_size] = [size(left)?, size(right)?];
    let turn = |file: &Field<'_>| -> Result<_> { Ok(matrix(&file.required(&RECTIFICATION, WAY_OUT)?.array()?)) };
    let projections = [projection(left)?, projection(right)?];
    let shift = (projections[1].shift - projections[0].shift).extend(0.0);
    let shift = units::of_metres(shift, unit, right.path())?;
    if shift == DVec3::ZERO {
        let rule =
            "one whose fourth value is minus focal length times baseline: calibrate both cameras as a stereo pair";
        return Err(right.required(&PROJECTION, WAY_OUT)?.wrong(rule));
    }
    let stereo = unrectified(cameras, [Some(left_size), Some(right_size)], [turn(left)?, turn(right)?], shift)
        .map_err(|error| right.refused(error))?;
    let rectified = Projection::pair(projections, unit.unwrap_or(1.0), Some(left_size));
    Ok((stereo, rectified))
}

/// The pair of two messages `sensor_msgs/CameraInfo`, left first; `paths` name them in errors.
#[cfg(feature = "recordings")]
pub(crate) fn of_infos(infos: &[CameraInfo; 2], paths: [&Path; 2]) -> Result<Loaded> {
    let [left, right] = infos.each_ref().map(as_values);
    let (stereo, rectified) = read(&[Field::root(&left, paths[0]), Field::root(&right, paths[1])], None)?;
    Ok(Loaded { rectified: rectified.or_else(|| stereo.rectified()), stereo, notes: Vec::new() })
}

/// A message as the values of a file.
#[cfg(feature = "recordings")]
fn as_values(info: &CameraInfo) -> Node {
    let list = |numbers: &[f64]| Node::List(numbers.iter().map(|number| Node::Text(number.to_string())).collect());
    let text = |text: &dyn ToString| Node::Text(text.to_string());
    let values = [
        ("width", text(&info.size.width)),
        ("height", text(&info.size.height)),
        ("distortion_model", text(&info.distortion_model)),
        ("D", list(&info.distortion)),
        ("K", list(&info.camera)),
        ("R", list(&info.rectification)),
        ("P", list(&info.projection)),
    ];
    Node::Map(values.map(|(name, value)| (name.to_owned(), value)).into())
}

/// The pair that rectifying rotations rectify, with the right camera's `shift` in rectified coordinates, in metres.
///
/// A rectified point `x` is `x + shift` in the right camera: with `x = R1 p` that is `R2 (R p + T)`.
pub(super) fn unrectified(
    cameras: [CameraModel; 2],
    sizes: [Option<Size>; 2],
    [left, right]: [glam::DMat3; 2],
    shift: DVec3,
) -> Result<StereoCalibration> {
    let back = right.transpose();
    StereoCalibration::new(cameras, sizes, back * left, back * shift)
}

fn projection(file: &Field<'_>) -> Result<Projection> {
    Projection::of(&file.required(&PROJECTION, WAY_OUT)?)
}

fn size(file: &Field<'_>) -> Result<Size> {
    let side = |keys: &[&str]| file.required(keys, WAY_OUT)?.side();
    Ok(Size::new(side(&["image_width", "width"])?, side(&["image_height", "height"])?))
}

fn of_file(file: &Field<'_>) -> Result<CameraModel> {
    let coefficients = file.get(&DISTORTION);
    let model = file.get(&["distortion_model"]);
    let lens = match model.as_ref().map(Field::text).transpose()? {
        None | Some("plumb_bob" | "rational_polynomial" | "") => {
            Lens::Pinhole(radial_tangential(coefficients.as_ref())?)
        }
        Some("equidistant") => {
            let coefficients = file.required(&DISTORTION, WAY_OUT)?;
            let lens = KannalaBrandt::new(coefficients.array()?).map_err(|error| coefficients.refused(error))?;
            Lens::KannalaBrandt(lens)
        }
        Some(_) => {
            let rule = "plumb_bob, rational_polynomial or equidistant";
            return Err(file.required(&["distortion_model"], WAY_OUT)?.wrong(rule));
        }
    };
    camera(&file.required(&CAMERA, WAY_OUT)?, lens)
}
