//! hsad's own JSON.

use std::fmt::Write as _;

use glam::{DMat3, DVec2, DVec3};

use super::{matrices::matrix, tree::Field, units};
use crate::{
    calibration::{
        CameraModel, DoubleSphere, ExtendedUnified, KannalaBrandt, Lens, RadialTangential, StereoCalibration, Unified,
    },
    error::Result,
    image::Size,
};

const WAY_OUT: &str = "a calibration has left, right, rotation and translation, and each camera focal, centre and model \
                       (docs/calibration.md)";

/// The pair of a file.
pub(super) fn read(root: &Field<'_>, unit: Option<f64>) -> Result<StereoCalibration> {
    let sides = [root.required(&["left"], WAY_OUT)?, root.required(&["right"], WAY_OUT)?];
    let [left, right] = sides;
    let cameras = [camera(&left)?, camera(&right)?];
    let size = |camera: &Field<'_>| camera.get(&["size"]).map(|size| size.size()).transpose();
    let rotation = root.get(&["rotation"]);
    let matrix = match &rotation {
        Some(rotation) => matrix(&rotation.array()?),
        None => DMat3::IDENTITY,
    };
    let translation = root.required(&["translation"], WAY_OUT)?;
    let unit = match root.get(&["unit"]) {
        Some(field) => Some(match field.text()? {
            "m" => 1.0,
            "mm" => 1e-3,
            _ => return Err(field.wrong("m or mm")),
        }),
        None => unit,
    };
    let metres = units::of_metres(DVec3::from_array(translation.array()?), unit, root.path())?;
    StereoCalibration::new(cameras, [size(&left)?, size(&right)?], matrix, metres).map_err(|error| root.refused(error))
}

fn camera(field: &Field<'_>) -> Result<CameraModel> {
    let [focal, centre] =
        [field.required(&["focal"], WAY_OUT)?.array()?, field.required(&["centre"], WAY_OUT)?.array()?];
    let lens = lens(field)?;
    CameraModel::new(DVec2::from_array(focal), DVec2::from_array(centre), lens).map_err(|error| field.refused(error))
}

fn lens(field: &Field<'_>) -> Result<Lens> {
    let distortion = || match field.get(&["distortion"]) {
        Some(distortion) => RadialTangential::new(&distortion.numbers()?).map_err(|error| distortion.refused(error)),
        None => Ok(RadialTangential::NONE),
    };
    let number = |key: &str| field.required(&[key], WAY_OUT)?.number();
    let model = field.required(&["model"], WAY_OUT)?;
    let lens = match model.text()? {
        "pinhole" => Ok(Lens::Pinhole(distortion()?)),
        "fisheye" => KannalaBrandt::new(field.required(&["distortion"], WAY_OUT)?.array()?).map(Lens::KannalaBrandt),
        "unified" => Unified::new(number("xi")?, distortion()?).map(Lens::Unified),
        "extended unified" => ExtendedUnified::new(number("alpha")?, number("beta")?).map(Lens::ExtendedUnified),
        "double sphere" => DoubleSphere::new(number("xi")?, number("alpha")?).map(Lens::DoubleSphere),
        _ => return Err(model.wrong("pinhole, fisheye, unified, extended unified or double sphere")),
    };
    lens.map_err(|error| field.refused(error))
}

/// A calibration as hsad's own JSON, which [`super::read`] reads back to the same numbers.
pub fn to_json(stereo: &StereoCalibration) -> String {
    let [left, right] = [0, 1].map(|side| camera_json(&stereo.cameras()[side], stereo.sizes()[side]));
    let [a, b, c] = stereo.rotation().transpose().to_cols_array_2d().map(|row| list(&row));
    let translation = list(&stereo.translation().to_array());
    format!(
        "{{\n  \"left\": {left},\n  \"right\": {right},\n  \"rotation\": [{a}, {b}, {c}],\n  \"translation\": {translation},\n  \
         \"unit\": \"m\"\n}}\n"
    )
}

fn camera_json(camera: &CameraModel, size: Option<Size>) -> String {
    let mut text = String::from("{");
    // Writing to a string does not fail.
    let mut entry = |key: &str, value: String| {
        let comma = if text.len() > 1 { ", " } else { "" };
        let _ = write!(text, "{comma}\"{key}\": {value}");
    };
    if let Some(Size { width, height }) = size {
        entry("size", format!("[{width}, {height}]"));
    }
    entry("focal", list(&camera.focal().to_array()));
    entry("centre", list(&camera.centre().to_array()));
    let mut model = |name: &str| entry("model", format!("\"{name}\""));
    match camera.lens() {
        Lens::Pinhole(distortion) => {
            model("pinhole");
            if !distortion.is_none() {
                entry("distortion", list(&distortion.coefficients()));
            }
        }
        Lens::KannalaBrandt(lens) => {
            model("fisheye");
            entry("distortion", list(&lens.coefficients()));
        }
        Lens::Unified(lens) => {
            model("unified");
            entry("xi", format!("{:?}", lens.xi()));
            entry("distortion", list(&lens.distortion().coefficients()));
        }
        Lens::ExtendedUnified(lens) => {
            model("extended unified");
            let [alpha, beta] = lens.parameters();
            entry("alpha", format!("{alpha:?}"));
            entry("beta", format!("{beta:?}"));
        }
        Lens::DoubleSphere(lens) => {
            model("double sphere");
            let [xi, alpha] = lens.parameters();
            entry("xi", format!("{xi:?}"));
            entry("alpha", format!("{alpha:?}"));
        }
    }
    text.push('}');
    text
}

fn list(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
    format!("[{}]", values.join(", "))
}
