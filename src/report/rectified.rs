//! A rectified pair.

use serde_json::{Value, json};

use super::calibration;
use crate::{
    glam::DMat3,
    image::Size,
    pipeline::RectifiedPair,
    rectify::{
        CalibratedRectification, Residual, StereoRectification,
        epipolar::{Evidence, Uncalibrated},
    },
};

/// The rectification for programs: figures, and matrices row by row.
pub fn rectified(pair: &RectifiedPair) -> Value {
    let Residual { points, right, mean, most } = pair.residual;
    let mut value = match &pair.rectification {
        StereoRectification::Calibrated(found) => calibrated(found),
        StereoRectification::Uncalibrated(found) => uncalibrated(found),
    };
    let Size { width, height } = pair.rectification.size();
    value["width"] = json!(width);
    value["height"] = json!(height);
    value["sources"] =
        pair.rectification.source_sizes().iter().map(|Size { width, height }| json!([width, height])).collect();
    let [mean, most] = [mean, most].map(|error| (right > 0).then_some(error));
    value["residual"] = json!({ "points": points, "right": right, "mean_px": mean, "95_percent_px": most });
    value
}

fn calibrated(found: &CalibratedRectification) -> Value {
    let [left, right] = found.views().each_ref().map(|view| rows(&view.rotation()));
    let [p1, p2] = found.projections();
    json!({
        "method": "calibrated",
        "rotations": { "left": left, "right": right },
        "calibration": calibration(found.calibration()),
        "P1": p1.as_chunks::<4>().0,
        "P2": p2.as_chunks::<4>().0,
        "Q": found.reprojection().as_chunks::<4>().0,
        "quarter_turns": found.quarter_turns(),
    })
}

fn uncalibrated(found: &Uncalibrated) -> Value {
    let Evidence { inliers, points, off_plane, epipoles, .. } = found.evidence;
    let distortion = found.distortion;
    json!({
        "method": "uncalibrated",
        "model": found.model.name(),
        "homographies": { "left": rows(&found.homographies[0]), "right": rows(&found.homographies[1]) },
        "k1": found.k1[0],
        "k1_right": found.k1[1],
        "k1_unit_px": [found.mean_side(0), found.mean_side(1)],
        "shift_px": found.shift,
        "disparity_constant_known": found.keeps_columns,
        "points": points,
        "inliers": inliers,
        "off_plane": off_plane,
        "epipoles": epipoles,
        "distortion": { "aspect": distortion.aspect, "skew_degrees": distortion.skew, "area": distortion.area },
    })
}

fn rows(matrix: &DMat3) -> Value {
    json!(matrix.transpose().to_cols_array_2d())
}
