//! COLMAP's and ETH3D's `cameras.txt` and `images.txt`.
//!
//! Schönberger and Frahm, 'Structure-from-motion revisited', CVPR 2016; the format is in COLMAP's documentation.

use std::path::Path;

use glam::{DMat3, DQuat, DVec2, DVec3};

use super::{
    files::{Format, Hints},
    tree::finite,
    units,
};
use crate::{
    calibration::{CameraModel, KannalaBrandt, Lens, RadialTangential, StereoCalibration},
    error::Result,
    image::Size,
    io::malformed,
};

/// `cameras.txt` or `images.txt`, by the comments that COLMAP writes, or by the first line.
pub(super) fn recognised(text: &str) -> Option<Format> {
    for line in text.lines().take(8) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let is_number = |place: usize| words.get(place).is_some_and(|word| finite(word).is_some());
        if line.starts_with('#') {
            if line.contains("CAMERA_ID, MODEL") {
                return Some(Format::ColmapCameras);
            } else if line.contains("IMAGE_ID, QW") {
                return Some(Format::ColmapImages);
            }
        } else if words.len() > 6 && is_number(0) && words[1].chars().all(|c| c.is_ascii_uppercase() || c == '_') {
            return Some(Format::ColmapCameras);
        } else if words.len() == 10 && (0..9).all(is_number) && !is_number(9) {
            return Some(Format::ColmapImages);
        }
    }
    None
}

/// The pair of the two pictures that `hints` names, or of the only two.
pub(super) fn read(
    cameras: (&str, &Path),
    images: (&str, &Path),
    hints: &Hints<'_>,
    notes: &mut Vec<String>,
) -> Result<StereoCalibration> {
    let [left, right] = pair(images, hints)?;
    let [left_camera, right_camera] = [camera(cameras, left.camera)?, camera(cameras, right.camera)?];
    let rotation = right.rotation * left.rotation.transpose();
    let translation = units::of_metres(right.translation - rotation * left.translation, hints.unit, images.1)?;
    if hints.unit.is_none() {
        notes.push("positions of images.txt are taken as metres: COLMAP alone does not know the scale".into());
    }
    let sizes = [Some(left_camera.1), Some(right_camera.1)];
    StereoCalibration::new([left_camera.0, right_camera.0], sizes, rotation, translation)
        .map_err(|error| malformed(images.1, error.to_string()))
}

/// A picture's pose: a point `p` of the world is `rotation p + translation` in its camera.
struct Image<'a> {
    rotation: DMat3,
    translation: DVec3,
    camera: &'a str,
    name: &'a str,
}

fn pair<'a>((text, path): (&'a str, &Path), hints: &Hints<'_>) -> Result<[Image<'a>; 2]> {
    // Each picture has two lines; the second has its points and can be empty.
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.starts_with('#'));
    let mut images = Vec::new();
    while let Some((number, line)) = lines.next() {
        if line.trim().is_empty() {
            continue;
        }
        images.push(image(line).ok_or_else(|| {
            let rule = "IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, and then a line of points that can be empty";
            malformed(path, format!("line {number} is not of the form {rule}"))
        })?);
        lines.next();
    }
    images.sort_by_key(|image| image.name);
    let count = images.len();
    if let Some(pictures) = hints.pictures {
        let place =
            |picture: &Path| images.iter().position(|image| Path::new(image.name).file_name() == picture.file_name());
        if let [Some(left), Some(right)] = pictures.map(place) {
            if left == right {
                return Err(malformed(path, "both pictures have the same name there"));
            }
            let mut taken: Vec<Option<Image<'a>>> = images.into_iter().map(Some).collect();
            if let (Some(left), Some(right)) = (taken[left].take(), taken[right].take()) {
                return Ok([left, right]);
            }
            return Err(malformed(path, "the pictures are not there"));
        }
    }
    images.try_into().map_err(|_| {
        malformed(
            path,
            format!("there are {count} pictures, and none has the name of the given ones: keep their names"),
        )
    })
}

fn image(line: &str) -> Option<Image<'_>> {
    let words: Vec<&str> = line.split_whitespace().take(10).collect();
    let numbers: Option<Vec<f64>> = words.get(1..8)?.iter().map(|word| finite(word)).collect();
    let (&[w, x, y, z, tx, ty, tz], &[camera, name]) = (numbers?.first_chunk()?, words.get(8..)?.first_chunk()?);
    let quaternion = DQuat::from_xyzw(x, y, z, w);
    let is_unit = (quaternion.length() - 1.0).abs() < 1e-3;
    is_unit.then(|| Image {
        rotation: DMat3::from_quat(quaternion.normalize()),
        translation: DVec3::new(tx, ty, tz),
        camera,
        name,
    })
}

fn camera((text, path): (&str, &Path), wanted: &str) -> Result<(CameraModel, Size)> {
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.starts_with('#'));
    let found = lines.find(|(_, line)| line.split_whitespace().next() == Some(wanted));
    let Some((number, line)) = found else {
        return Err(malformed(path, format!("there is no camera {wanted}, which images.txt names")));
    };
    let wrong = |rule: &str| malformed(path, format!("line {number}: camera {wanted} {rule}"));
    let mut words = line.split_whitespace().skip(1);
    let model = words.next().unwrap_or_default();
    let mut side = || words.next().and_then(|word| word.parse().ok()).filter(|&side: &u32| side > 0);
    let size = side().zip(side()).map(|(width, height)| Size::new(width, height));
    let size = size.ok_or_else(|| wrong("has no width and height"))?;
    let parameters: Option<Vec<f64>> = words.map(finite).collect();
    let parameters = parameters.ok_or_else(|| wrong("has a parameter that is no finite number"))?;
    let radial = |coefficients: &[f64]| RadialTangential::new(coefficients).map(Lens::Pinhole);
    let (focal, centre, lens) = match (model, parameters.as_slice()) {
        ("SIMPLE_PINHOLE", &[f, cx, cy]) => ([f, f], [cx, cy], radial(&[])),
        ("PINHOLE", &[fx, fy, cx, cy]) => ([fx, fy], [cx, cy], radial(&[])),
        ("SIMPLE_RADIAL", &[f, cx, cy, k]) => ([f, f], [cx, cy], radial(&[k])),
        ("RADIAL", &[f, cx, cy, k1, k2]) => ([f, f], [cx, cy], radial(&[k1, k2])),
        ("OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2]) => ([fx, fy], [cx, cy], radial(&[k1, k2, p1, p2])),
        ("FULL_OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6]) => {
            ([fx, fy], [cx, cy], radial(&[k1, k2, p1, p2, k3, k4, k5, k6]))
        }
        ("SIMPLE_RADIAL_FISHEYE", &[f, cx, cy, k]) => ([f, f], [cx, cy], fisheye([k, 0.0, 0.0, 0.0])),
        ("RADIAL_FISHEYE", &[f, cx, cy, k1, k2]) => ([f, f], [cx, cy], fisheye([k1, k2, 0.0, 0.0])),
        ("OPENCV_FISHEYE", &[fx, fy, cx, cy, k1, k2, k3, k4]) => ([fx, fy], [cx, cy], fisheye([k1, k2, k3, k4])),
        _ => {
            return Err(wrong(
                "must be SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV or one of their FISHEYE \
                 models with all parameters: for others undistort the pictures (colmap image_undistorter; ETH3D offers \
                 undistorted ones)",
            ));
        }
    };
    // COLMAP counts from the corner of the first pixel, hsad from its centre.
    let centre = DVec2::from(centre) - 0.5;
    let camera = lens.and_then(|lens| CameraModel::new(DVec2::from(focal), centre, lens));
    Ok((camera.map_err(|error| malformed(path, format!("line {number}: {error}")))?, size))
}

fn fisheye(coefficients: [f64; 4]) -> Result<Lens> {
    KannalaBrandt::new(coefficients).map(Lens::KannalaBrandt)
}
