//! The files of a rectified pair, and its words.

use std::io::{self, Write};

use hsad::{
    Result, Size,
    io::{calibration::to_opencv_yaml, figure, png},
    pipeline::RectifiedPair,
    rectify::{
        CalibratedRectification, Residual, RowKind, StereoRectification,
        epipolar::{Evidence, Model, Uncalibrated},
    },
    report,
};

use super::{names::Rectified, output::Output};

/// Number of epipolar lines in a figure.
const LINES: usize = 24;

/// Adds all files of a rectified pair.
pub fn add_files(pair: &RectifiedPair, names: &Rectified, output: &mut Output) -> Result<()> {
    for ((name, mask_name), (picture, mask)) in
        names.pictures.iter().zip(names.masks).zip(pair.pictures.iter().zip(pair.masks()))
    {
        output.add(name, |out| png::write_rgba8(out, picture))?;
        output.add(mask_name, |out| png::write_grey8(out, &mask))?;
    }
    let figure = figure::epipolar_lines(&pair.pictures[0], &pair.pictures[1], &lines(pair));
    output.add(names.figure, |out| png::write_rgb8(out, &figure))?;
    output.add_json(names.json, &report::rectified(pair))?;
    output.add(names.yaml, |out| match &pair.rectification {
        StereoRectification::Calibrated(found) => out.write_all(to_opencv_yaml(found).as_bytes()),
        StereoRectification::Uncalibrated(found) => write_yaml(out, found),
    })
}

/// Matched points of the rectified pictures, spread over the rows.
fn lines(pair: &RectifiedPair) -> Vec<figure::PointPair> {
    let place = |view, pixel| pair.rectification.rectified_of(view, pixel).map(|place| place.as_vec2().to_array());
    let mut points: Vec<figure::PointPair> = pair
        .points
        .iter()
        .filter_map(|point| Some((place(0, point.left)?, place(1, point.right)?)))
        .filter(|(left, right)| (left[1] - right[1]).abs() <= 3.0)
        .collect();
    points.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]));
    let step = points.len().div_ceil(LINES).max(1);
    points.into_iter().step_by(step).collect()
}

/// What was done to the pair, in one line.
pub fn words(pair: &RectifiedPair) -> String {
    let what = match &pair.rectification {
        StereoRectification::Calibrated(found) => by_calibration(found),
        StereoRectification::Uncalibrated(found) => by_matches(found),
    };
    let Residual { points, right, mean, most } = pair.residual;
    let of_points = format!("rows of {right} of {points} matches that had no part in it agree");
    match right {
        0 => format!("{what}; {of_points}"),
        _ => format!("{what}; {of_points} to {mean:.2} px in the mean, 95 % to {most:.1} px"),
    }
}

fn by_calibration(found: &CalibratedRectification) -> String {
    let [left, right] = found.views().each_ref().map(|view| {
        let cosine = (view.rotation().x_axis.x + view.rotation().y_axis.y + view.rotation().z_axis.z - 1.0) / 2.0;
        cosine.clamp(-1.0, 1.0).acos().to_degrees()
    });
    let calibration = found.calibration();
    format!(
        "by the calibration, the left view turned by {left:.1} and the right one by {right:.1} degrees, focal length {:.1} px, baseline \
         {:.4} m",
        calibration.focal, calibration.baseline
    )
}

fn by_matches(found: &Uncalibrated) -> String {
    let Evidence { inliers, points, .. } = found.evidence;
    let lens = match found.k1 {
        [0.0, 0.0] => "".into(),
        [left, right] if left == right => format!(", distortion k1 {left:.3} removed"),
        [left, right] => format!(", distortion k1 {left:.3} and {right:.3} removed"),
    };
    let what = match found.model {
        Model::Right(RowKind::AsIs) => "rows correspond as they are".into(),
        Model::Right(kind) => format!("the right view was resampled ({})", kind.name()),
        Model::Both => "both views were turned".into(),
    };
    let shift = if found.shift == 0.0 { "".into() } else { format!(", the right view moved by {:.0} px", found.shift) };
    format!("{what}{lens}{shift}, by {inliers} of {points} matches")
}

/// Size of the rectified pictures, and how shapes change, in one line.
pub fn pictures(found: &StereoRectification) -> String {
    let size = found.size();
    match found {
        StereoRectification::Calibrated(_) => format!("{size} pixels"),
        StereoRectification::Uncalibrated(found) => {
            let shapes = found.distortion;
            let change =
                format!("aspect {:.2}, skew {:.1} degrees, area {:.2}", shapes.aspect, shapes.skew, shapes.area);
            format!("{size} pixels; shapes change by up to {change}")
        }
    }
}

/// The rectification as OpenCV's `FileStorage` reads it. With M, D and H of a view,
/// `initUndistortRectifyMap(M, D, H * M, Mat::eye(3, 3, CV_64F), size, ...)` makes the maps for `remap`.
fn write_yaml(out: &mut impl Write, found: &Uncalibrated) -> io::Result<()> {
    writeln!(out, "%YAML:1.0\n---")?;
    writeln!(out, "# initUndistortRectifyMap(M1, D1, H1 * M1, eye(3, 3), size, CV_32FC1): maps for remap; likewise 2")?;
    writeln!(out, "size: [ {}, {} ]", found.size.width, found.size.height)?;
    for (view, number) in [(0, 1), (1, 2)] {
        let Size { width, height } = found.sources()[view];
        let (unit, [x, y]) = (found.mean_side(view), [width, height].map(|side| (f64::from(side) - 1.0) / 2.0));
        let homography = found.homographies[view].transpose().to_cols_array();
        write_matrix(out, &format!("M{number}"), 3, &[unit, 0.0, x, 0.0, unit, y, 0.0, 0.0, 1.0])?;
        write_matrix(out, &format!("D{number}"), 1, &[found.k1[view], 0.0, 0.0, 0.0, 0.0])?;
        write_matrix(out, &format!("H{number}"), 3, &homography)?;
    }
    Ok(())
}

fn write_matrix(out: &mut impl Write, name: &str, rows: usize, values: &[f64]) -> io::Result<()> {
    let data: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
    writeln!(out, "{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {}\n   dt: d", values.len() / rows)?;
    writeln!(out, "   data: [ {} ]", data.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_is_written_as_opencv_writes_it() {
        let mut text = Vec::new();
        write_matrix(&mut text, "D1", 1, &[-0.25, 0.0, 1e-7]).unwrap();
        let expected = "D1: !!opencv-matrix\n   rows: 1\n   cols: 3\n   dt: d\n   data: [ -0.25, 0.0, 1e-7 ]\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }
}
