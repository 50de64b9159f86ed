//! A camera matrix of nine numbers and a baseline in metres, as FoundationStereo and others read `K.txt`.

use std::path::Path;

use glam::{DMat3, DVec2, DVec3};

use super::{
    files::Hints,
    tree::{finite, words},
    units,
};
use crate::{
    calibration::{CameraModel, StereoCalibration},
    error::Result,
    io::malformed,
};

const RULE: &str = "a K.txt has fx 0 cx 0 fy cy 0 0 1 and then the baseline in metres";

/// Numbers alone, nine or ten.
pub(super) fn recognised(text: &str) -> bool {
    let mut count = 0;
    words(text).take(11).all(|word| {
        count += 1;
        word.parse::<f64>().is_ok()
    }) && (9..=10).contains(&count)
}

/// The rectified pair of a file.
pub(super) fn read(text: &str, path: &Path, hints: &Hints<'_>) -> Result<StereoCalibration> {
    let numbers: Option<Vec<f64>> = words(text).map(finite).collect();
    let refused = |error: crate::error::Error| malformed(path, format!("{error}; {RULE}"));
    match numbers.as_deref() {
        Some(&[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0, baseline]) if baseline > 0.0 => {
            let camera = CameraModel::pinhole(DVec2::new(fx, fy), DVec2::new(cx, cy)).map_err(refused)?;
            let shift = units::of_metres(DVec3::new(-baseline, 0.0, 0.0), hints.unit, path)?;
            StereoCalibration::new([camera; 2], [None; 2], DMat3::IDENTITY, shift).map_err(refused)
        }
        Some(numbers) if numbers.len() == 9 => {
            Err(malformed(path, format!("the baseline is missing: write it in metres in a second line; {RULE}")))
        }
        _ => Err(malformed(path, format!("the numbers are others: {RULE}"))),
    }
}
