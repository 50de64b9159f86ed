//! KITTI: `calib_cam_to_cam.txt` of raw sequences, and the projection matrices `P0` to `P3` of the benchmarks.
//!
//! Geiger, Lenz, Stiller and Urtasun, 'Vision meets robotics: the KITTI dataset', IJRR 32(11), 2013, section IV.

use std::{collections::HashMap, path::Path};

use glam::{DMat3, DVec3};

use super::{
    files::Hints,
    matrices::{Projection, camera, matrix, radial_tangential},
    tree::{Field, Node},
    units,
};
use crate::{
    calibration::{Calibration, Lens, StereoCalibration},
    error::Result,
    image::Size,
    io::malformed,
};

const WAY_OUT: &str =
    "KITTI calibrations have P0: to P3:, or S_00:, K_00:, D_00:, R_00:, T_00:, S_rect_00:, P_rect_00: and so on";
/// Folders of the pictures of each camera.
const FOLDERS: [[&str; 3]; 4] = [
    ["image_0", "image_00", "grey_left"],
    ["image_1", "image_01", "grey_right"],
    ["image_2", "image_02", "colored_0"],
    ["image_3", "image_03", "colored_1"],
];

pub(super) fn recognised(text: &str) -> bool {
    text.lines().filter_map(|line| line.split_once(':')).any(|(key, rest)| {
        let is_projection = matches!(key.trim(), "P0" | "P1" | "P2" | "P3" | "P_rect_00" | "P_rect_02");
        is_projection && rest.split_whitespace().count() == 12
    })
}

/// The pair of the cameras that took the pictures, and its geometry after KITTI's rectification.
pub(super) fn read(
    text: &str,
    path: &Path,
    hints: &Hints<'_>,
    notes: &mut Vec<String>,
) -> Result<(StereoCalibration, Option<Calibration>)> {
    let mut entries: HashMap<&str, &str> = HashMap::new();
    for (key, value) in text.lines().filter_map(|line| line.split_once(':')) {
        if entries.insert(key.trim(), value).is_some() {
            return Err(malformed(path, format!("{} is there twice", key.trim())));
        }
    }
    let nodes = entries.into_iter().map(|(key, value)| (key.into(), Node::Text(value.into()))).collect();
    let root = Node::Map(nodes);
    let file =
        File { root: Field::root(&root, path), is_raw: Field::root(&root, path).has(&["P_rect_00", "P_rect_02"]) };
    let pair = match cameras_of(hints) {
        Some(pair) => pair,
        None if file.has_camera(2) => {
            notes.push("no folder such as image_2 tells the cameras: the colour cameras 2 and 3 are taken".into());
            [2, 3]
        }
        None => [0, 1],
    };
    let rectified = file.rectified(pair, hints.unit)?;
    let is_rectified = hints.sizes.is_none_or(|[left, _]| rectified.size.is_none_or(|size| size == left));
    if file.is_raw && !is_rectified {
        return Ok((file.unrectified(pair, hints.unit)?, Some(rectified)));
    }
    Ok((StereoCalibration::from_rectified(&rectified)?, Some(rectified)))
}

/// The cameras whose folders the pictures lie in.
fn cameras_of(hints: &Hints<'_>) -> Option<[usize; 2]> {
    let camera = |picture: &Path| {
        let parts: Vec<_> = picture.components().filter_map(|part| part.as_os_str().to_str()).collect();
        FOLDERS.iter().position(|names| names.iter().any(|name| parts.contains(name)))
    };
    let [left, right] = hints.pictures?;
    camera(left).zip(camera(right)).map(|(left, right)| [left, right]).filter(|[left, right]| left != right)
}

struct File<'a> {
    root: Field<'a>,
    /// True for `calib_cam_to_cam.txt`.
    is_raw: bool,
}

impl<'a> File<'a> {
    fn entry(&self, key: &str) -> Result<Field<'a>> {
        self.root.required(&[key], WAY_OUT)
    }

    fn projection_key(&self, camera: usize) -> String {
        if self.is_raw { format!("P_rect_0{camera}") } else { format!("P{camera}") }
    }

    fn has_camera(&self, camera: usize) -> bool {
        self.root.has(&[&self.projection_key(camera)])
    }

    fn rectified(&self, cameras: [usize; 2], unit: Option<f64>) -> Result<Calibration> {
        let fields = cameras.map(|camera| self.entry(&self.projection_key(camera)));
        let [left, right] = fields;
        let (left, right) = (left?, right?);
        let pair = [Projection::of(&left)?, Projection::of(&right)?];
        let size = match self.root.get(&[&format!("S_rect_0{}", cameras[0])]) {
            Some(size) => Some(size.size()?),
            None => None,
        };
        Projection::pair(pair, unit.unwrap_or(1.0), size)
            .ok_or_else(|| right.wrong("of a camera to the right of the left one"))
    }

    fn unrectified(&self, cameras: [usize; 2], unit: Option<f64>) -> Result<StereoCalibration> {
        let [left, right] = cameras.map(|camera| self.camera(camera));
        let ((left, left_size, turn, from), (right, right_size, other_turn, other_from)) = (left?, right?);
        let rotation = other_turn * turn.transpose();
        let translation = units::of_metres(other_from - rotation * from, unit, self.root.path())?;
        StereoCalibration::new([left, right], [Some(left_size), Some(right_size)], rotation, translation)
            .map_err(|error| self.root.refused(error))
    }

    fn camera(&self, camera_number: usize) -> Result<(crate::calibration::CameraModel, Size, DMat3, DVec3)> {
        let entry = |name: &str| self.entry(&format!("{name}_0{camera_number}"));
        let lens = Lens::Pinhole(radial_tangential(Some(&entry("D")?))?);
        let model = camera(&entry("K")?, lens)?;
        Ok((model, entry("S")?.size()?, matrix(&entry("R")?.array()?), DVec3::from_array(entry("T")?.array()?)))
    }
}
