//! OpenCV's FileStorage: `stereoCalibrate`'s cameras and pose, and `stereoRectify`'s matrices, in one file or two.

use glam::DVec3;

use super::{
    files::Hints,
    matrices::{Projection, camera, matrix, radial_tangential},
    ros::unrectified,
    tree::Field,
    units,
};
use crate::{
    calibration::{Calibration, KannalaBrandt, Lens, RadialTangential, StereoCalibration, Unified},
    error::{Error, Result},
    image::Size,
    io::malformed,
};

/// Names that programs give to camera matrices and distortions, left and right.
const CAMERAS: [&[&str]; 2] = [
    &[
        "M1",
        "K1",
        "CM1",
        "cameraMatrix1",
        "camera_matrix_1",
        "camera_matrix1",
        "cameraMatrixL",
        "left_camera_matrix",
        "M_left",
        "K_left",
        "mtxL",
        "LEFT.K",
    ],
    &[
        "M2",
        "K2",
        "CM2",
        "cameraMatrix2",
        "camera_matrix_2",
        "camera_matrix2",
        "cameraMatrixR",
        "right_camera_matrix",
        "M_right",
        "K_right",
        "mtxR",
        "RIGHT.K",
    ],
];
const DISTORTIONS: [&[&str]; 2] = [
    &[
        "D1",
        "distCoeffs1",
        "dist_coeffs_1",
        "distortion_coefficients_1",
        "distCoeffsL",
        "left_distortion",
        "D_left",
        "distL",
        "LEFT.D",
    ],
    &[
        "D2",
        "distCoeffs2",
        "dist_coeffs_2",
        "distortion_coefficients_2",
        "distCoeffsR",
        "right_distortion",
        "D_right",
        "distR",
        "RIGHT.D",
    ],
];
const XIS: [&[&str]; 2] = [&["xi1"], &["xi2"]];
const ROTATIONS: [&[&str]; 2] = [&["R1", "LEFT.R"], &["R2", "RIGHT.R"]];
const PROJECTIONS: [&[&str]; 2] = [&["P1", "LEFT.P"], &["P2", "RIGHT.P"]];
const ROTATION: &[&str] = &["R", "rotation_matrix", "rotation"];
const TRANSLATION: &[&str] = &["T", "translation_vector", "translation"];

const WAY_OUT: &str = "a stereo calibration has M1, D1, M2, D2, R and T (of stereoCalibrate), or P1 and P2 (of stereoRectify) if \
                       the pictures are rectified";

pub(super) fn recognised(root: &Field<'_>) -> bool {
    let pairs = [CAMERAS, PROJECTIONS, DISTORTIONS].concat();
    let single = root.has(&["camera_matrix", "Camera_Matrix", "cameraMatrix"]);
    single || root.has(TRANSLATION) || pairs.into_iter().any(|keys| root.has(keys))
}

/// The pair of one or two files, whose entries complete each other, and its geometry after `stereoRectify`.
pub(super) fn read(
    files: &[Field<'_>],
    hints: &Hints<'_>,
    notes: &mut Vec<String>,
) -> Result<(StereoCalibration, Option<Calibration>)> {
    let files = Files(files);
    let (size, path) = (files.size()?, files.0[0].path());
    let translation = files.get(TRANSLATION).map(|field| field.array().map(DVec3::from_array)).transpose()?;
    let projections = files.projections()?;
    let shift = projections.map(|[left, right]| (right.shift - left.shift).extend(0.0));
    let Some(length) = translation.or(shift).map(DVec3::length) else {
        let all = [CAMERAS[0], CAMERAS[1], TRANSLATION];
        return Err(files.missing(all.into_iter().find(|keys| files.get(keys).is_none()).unwrap_or(TRANSLATION)));
    };
    let unit = units::of_target(length, hints.unit, path, notes)?;
    let rectified = projections.and_then(|pair| Projection::pair(pair, unit, size));
    let Some([left, right]) = files.both(&CAMERAS)? else {
        // Without camera matrices the pictures are rectified.
        let rectified = rectified.ok_or_else(|| files.missing(CAMERAS[0]))?;
        return Ok((StereoCalibration::from_rectified(&rectified)?, Some(rectified)));
    };
    let cameras = [camera(&left, files.lens(0, notes)?)?, camera(&right, files.lens(1, notes)?)?];
    let stereo = match (translation, shift, files.both(&ROTATIONS)?) {
        (Some(translation), ..) => {
            let rotation = rotation_of(&files.required(ROTATION)?)?;
            StereoCalibration::new(cameras, [size; 2], rotation, unit * translation)
        }
        (None, Some(shift), Some([first, second])) => {
            unrectified(cameras, [size; 2], [matrix(&first.array()?), matrix(&second.array()?)], unit * shift)
        }
        _ => return Err(files.missing(TRANSLATION)),
    };
    Ok((stereo.map_err(|error| malformed(path, error.to_string()))?, rectified))
}

/// A rotation matrix, or a rotation vector: an axis times an angle in radians.
fn rotation_of(field: &Field<'_>) -> Result<glam::DMat3> {
    if field.numbers()?.len() == 3 {
        let vector = DVec3::from_array(field.array()?);
        return Ok(glam::DMat3::from_quat(glam::DQuat::from_scaled_axis(vector)));
    }
    Ok(matrix(&field.array()?))
}

/// One or two files as one.
struct Files<'f, 'a>(&'f [Field<'a>]);

impl<'a> Files<'_, 'a> {
    fn get(&self, keys: &[&str]) -> Option<Field<'a>> {
        self.0.iter().find_map(|file| file.get(keys))
    }

    fn required(&self, keys: &[&str]) -> Result<Field<'a>> {
        self.get(keys).ok_or_else(|| self.missing(keys))
    }

    fn missing(&self, keys: &[&str]) -> Error {
        malformed(self.0[0].path(), format!("there is no {}: {WAY_OUT}", keys.first().unwrap_or(&"")))
    }

    fn projections(&self) -> Result<Option<[Projection; 2]>> {
        let Some([left, right]) = self.both(&PROJECTIONS)? else { return Ok(None) };
        Ok(Some([Projection::of(&left)?, Projection::of(&right)?]))
    }

    /// The entries of both cameras; `None` without either.
    fn both(&self, keys: &[&[&str]; 2]) -> Result<Option<[Field<'a>; 2]>> {
        match keys.map(|keys| self.get(keys)) {
            [None, None] => Ok(None),
            [Some(left), Some(right)] => Ok(Some([left, right])),
            [None, _] => Err(self.missing(keys[0])),
            [_, None] => Err(self.missing(keys[1])),
        }
    }

    fn size(&self) -> Result<Option<Size>> {
        if let Some(size) = self.get(&["image_size", "imageSize", "size", "Size"]) {
            return size.size().map(Some);
        }
        let sides = [["image_width", "width", "LEFT.width"], ["image_height", "height", "LEFT.height"]];
        match sides.map(|keys| self.get(&keys)) {
            [Some(width), Some(height)] => Ok(Some(Size::new(width.side()?, height.side()?))),
            _ => Ok(None),
        }
    }

    /// The lens of one of the cameras.
    fn lens(&self, camera: usize, notes: &mut Vec<String>) -> Result<Lens> {
        let distortion = self.get(DISTORTIONS[camera]);
        let model = self.get(&["distortion_model", "model"]);
        let name = model.as_ref().map(Field::text).transpose()?;
        if let Some(xi) = self.get(XIS[camera]) {
            let lens = Unified::new(xi.number()?, radial_tangential(distortion.as_ref())?);
            return Ok(Lens::Unified(lens.map_err(|error| xi.refused(error))?));
        }
        match (name, distortion) {
            (Some("fisheye" | "equidistant"), distortion) => {
                let distortion = distortion.map_or_else(|| self.required(DISTORTIONS[camera]), Ok)?;
                let lens = KannalaBrandt::new(distortion.array()?).map_err(|error| distortion.refused(error))?;
                Ok(Lens::KannalaBrandt(lens))
            }
            (None | Some("pinhole" | "plumb_bob" | "rational_polynomial" | "radial-tangential"), distortion) => {
                let lens = radial_tangential(distortion.as_ref())?;
                if name.is_none() && distortion.is_some_and(|field| field.numbers().is_ok_and(|all| all.len() == 4)) {
                    notes.push(format!(
                        "{} has four coefficients: taken as k1 k2 p1 p2; for those of cv2.fisheye add the line \
                         distortion_model: fisheye",
                        DISTORTIONS[camera][0]
                    ));
                }
                Ok(if lens.is_none() { Lens::Pinhole(RadialTangential::NONE) } else { Lens::Pinhole(lens) })
            }
            (Some(_), _) => {
                Err(self.required(&["distortion_model", "model"])?.wrong("fisheye, plumb_bob or rational_polynomial"))
            }
        }
    }
}

/// The matrices of a rectification, as OpenCV's FileStorage writes them in YAML.
pub fn to_opencv_yaml(rectification: &crate::rectify::CalibratedRectification) -> String {
    use std::fmt::Write as _;
    let Size { width, height } = rectification.size();
    let mut text = format!("%YAML:1.0\n---\nimage_width: {width}\nimage_height: {height}\n");
    let [left, right] = rectification.views().each_ref().map(|view| view.rotation().transpose().to_cols_array());
    let [p1, p2] = rectification.projections();
    let q = rectification.reprojection();
    let matrices: [(&str, usize, &[f64]); 5] =
        [("R1", 3, &left), ("R2", 3, &right), ("P1", 4, &p1), ("P2", 4, &p2), ("Q", 4, &q)];
    for (name, columns, values) in matrices {
        let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
        let (rows, data) = (values.len() / columns, values.join(", "));
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {data} ]"
        );
    }
    text
}
