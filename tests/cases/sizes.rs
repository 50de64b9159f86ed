//! Views of different sizes: a constant of the disparity is right, or said to be unknown.

use hsad::{
    image::{Plane, Size},
    io::Picture,
};

use crate::pair::{Pair, resampled};

/// The picture without so many columns and rows at its left, top, right and lower side.
fn cropped(picture: &Picture, [left, top, right, below]: [u32; 4]) -> Picture {
    let Size { width, height } = picture.size();
    Picture::from_fn((width - left - right, height - top - below), |x, y| picture.get(x + left, y + top))
}

/// The picture `scale` times as large.
fn scaled(picture: &Picture, scale: f64) -> Picture {
    let Size { width, height } = picture.size();
    let large = [width, height].map(|side| (f64::from(side) * scale).round() as u32);
    let placed = resampled(picture, |x, y| ((x + 0.5) / scale - 0.5, (y + 0.5) / scale - 0.5));
    Picture::from_fn((large[0].min(width), large[1].min(height)), |x, y| placed.get(x, y))
}

/// Cropped by 10 x 5 px at any corner, either view: a disparity is the column of the left pixel minus that of the right one.
#[test]
fn cropped_views_have_the_disparities_of_the_pictures_as_they_are() {
    let pair = Pair::shipped("planes");
    let level = pair.matched(&[]).wrong(&pair.truth);
    for (cut, more) in [([0, 0, 10, 5], 0.0), ([10, 5, 0, 0], 10.0), ([0, 5, 10, 0], 0.0), ([10, 0, 0, 5], 10.0)] {
        let mut right = pair.clone().with_right(|right| cropped(right, cut));
        right.truth.data_mut().iter_mut().for_each(|disparity| *disparity += more);
        let run = right.matched(&[]).ends(0, &["disparities are those of the views as they are"]);
        let rectified = &run.report()["rectified"];
        assert_eq!((&rectified["disparity_constant_known"], &rectified["shift_px"]), (&true.into(), &0.0.into()));
        run.judges(&right.truth).errs_below(level + 0.04, &right.truth);

        let truth = Plane::from_fn((330, 250), |x, y| pair.truth.get(x + cut[0], y + cut[1]) - more);
        let left = Pair { left: cropped(&pair.left, cut), truth, ..pair.clone() };
        let run = left.matched(&[]).ends(0, &["disparities are those of the views as they are"]);
        run.judges(&left.truth).errs_below(level + 0.04, &left.truth);
    }
}

/// Columns that were moved tell no constant: the report and the program say so, and no depth is given.
#[test]
fn a_constant_that_is_not_known_is_told() {
    let pair = Pair::shipped("planes");
    let smaller = pair.clone().with_right(|right| cropped(&scaled(right, 0.95), [0, 0, 8, 3]));
    let told = "the constant of the disparities is unknown";
    let run = smaller.matched(&["--focal", "378", "--baseline", "0.1"]).ends(5, &[told, "no depth"]);
    assert_eq!(run.report()["rectified"]["disparity_constant_known"], false);
    let warnings = run.report()["warnings"].to_string();
    assert!(warnings.contains(told) && !run.has("depth.pfm") && !run.has("cloud.ply"), "{warnings}");
}
