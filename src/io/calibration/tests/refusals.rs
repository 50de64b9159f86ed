//! Files with something missing, wrong or damaged.

use super::{examples::*, *};
use crate::{image::Size, rectify::CalibratedRectification};

#[test]
fn what_is_missing_or_wrong_is_told_with_what_to_write() {
    let changed = |text: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    for (texts, expected) in [
        (vec![""], "there is no value"),
        (vec!["hello: world"], "no calibration that hsad knows: calibrations are read from Middlebury's calib.txt"),
        (vec!["\u{0}\u{1}PNG"], "calibrations are read from"),
        (vec![ROS_LEFT], "this is ROS camera_info of one camera: name the files of the left and of the right one"),
        (vec![EUROC_LEFT], "name those of the left and of the right camera"),
        (vec![COLMAP_CAMERAS], "name images.txt after it"),
        (vec![COLMAP_IMAGES], "name cameras.txt before it"),
        (vec![NUMBERS, KALIBR], "second: this file has the format Kalibr and first the format Numbers: two files are"),
        (vec![OPENCV], "first: there is no T: a stereo calibration has M1, D1, M2, D2, R and T"),
        (vec![&changed(OPENCV, "M2", "M3")], "there is no M2: a stereo calibration has"),
        (vec!["camera_matrix: [1, 0, 0, 0, 1, 0, 0, 0, 1]"], "there is no M1: a stereo calibration has"),
        (vec![OPENCV, &changed(OPENCV_POSE, "-120., 0.5", "-3.3, 0.5")], "the baseline is 3.3"),
        (
            vec![OPENCV, &changed(OPENCV_POSE, "1., 0., 0., 0., 1.,", "1., 2., 0., 0., 1.,")],
            "the rotation is [1.0, 2.0",
        ),
        (
            vec![OPENCV, &changed(OPENCV_POSE, "1., 0., 0., 0., 1.,", "1., .nan, 0., 0., 1.,")],
            "R.data has '.nan', but all its",
        ),
        (
            vec![&changed(OPENCV, "-0.3, 0.1, 0.001, 0., 0.", "1, 2, 3"), OPENCV_POSE],
            "D1 is a group, but it must be 4, 5",
        ),
        (
            vec![&changed(OPENCV, "534., 0., 335.", "534., 3., 335."), OPENCV_POSE],
            "[fx 0 cx; 0 fy cy; 0 0 1], without skew",
        ),
        (vec![&changed(NUMBERS, "0.063", "")], "the baseline is missing: write it in metres in a second line"),
        (vec![&changed(NUMBERS, "0.063", "63")], "the baseline is 63, and lengths here are in metres"),
        (vec![&changed(NUMBERS, "0.063", "-1")], "the numbers are others: a K.txt has"),
        (vec![&changed(KALIBR, "T_cn_cnm1", "T_x")], "there is no cam1.T_cn_cnm1: a camchain has"),
        (
            vec![&changed(KALIBR, "distortion_model: equidistant", "distortion_model: fov")],
            "cam0.distortion_model is 'fov'",
        ),
        (
            vec![&changed(KALIBR, "camera_model: omni", "camera_model: x")],
            "cam1.camera_model is 'x', but it must be pinhole,",
        ),
        (
            vec![&changed(KALIBR, "resolution: [512, 512]", "resolution: [512]")],
            "cam0.resolution is a list, but it must be 2 numbers",
        ),
        (vec![&changed(KALIBR, "-0.101", "-101")], "the baseline is 101"),
        (vec![&changed(OWN, "double sphere", "sphere")], "right.model is 'sphere', but it must be pinhole, fisheye"),
        (vec![&changed(OWN, "\"alpha\"", "\"a\"")], "there is no right.alpha"),
        (vec![&changed(OWN, "\"mm\"", "\"in\"")], "unit is 'in', but it must be m or mm"),
        (vec![&changed(KITTI, "P3", "P4")], "there is no P3: KITTI calibrations have"),
        (vec![COLMAP_CAMERAS, &changed(COLMAP_IMAGES, "8 1 0 0 0", "8 1 1 0 0")], "line 5 is not of the form IMAGE_ID"),
        (vec![&changed(COLMAP_CAMERAS, "PINHOLE", "FOV"), COLMAP_IMAGES], "line 4: camera 0 must be SIMPLE_PINHOLE"),
        (vec![COLMAP_CAMERAS, &changed(COLMAP_IMAGES, "0 images/im0", "5 images/im0")], "there is no camera 5"),
        (vec![MIDDLEBURY, MIDDLEBURY, MIDDLEBURY], "the number of calibration files is 3, but it must be one, or two"),
    ] {
        let message = error(&texts);
        assert!(message.contains(expected), "'{message}' should contain '{expected}'");
    }
    let long = format!("a: {}", "x".repeat(1 << 20));
    assert!(error(&[&long]).contains("longer than 1048576 bytes"));
}

/// Files cut off anywhere, and with any byte replaced, are read or refused.
#[test]
fn damaged_files_do_not_panic() {
    let mut read = 0;
    let mut try_with = |texts: &[String], place: usize, text: &str| {
        let mut texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        texts[place] = text;
        if let Ok(found) = parsed(&texts, &Hints::default()) {
            read += 1;
            // CalibratedRectification takes longer than reading.
            if read % 32 == 0 {
                let sizes = found.stereo.sizes().map(|size| size.unwrap_or(Size::new(640, 480)));
                let _ = CalibratedRectification::new(&found.stereo, sizes);
            }
        }
    };
    for texts in examples() {
        for (place, text) in texts.iter().enumerate() {
            for end in 0..text.len() {
                try_with(&texts, place, &text[..end]);
            }
            for (i, with) in (0..text.len()).step_by(3).zip("0-9e.x:[]{}\n \t&*<'\"".chars().cycle()) {
                let damaged = format!("{}{with}{}", &text[..i], &text[i + 1..]);
                try_with(&texts, place, &damaged);
            }
        }
    }
    assert!(read > 500, "{read} were read");
}

#[test]
fn files_are_checked_before_any_picture_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let check_of = |texts: &[&str]| {
        let paths: Vec<_> = (0..texts.len()).map(|number| folder.path().join(number.to_string())).collect();
        paths.iter().zip(texts).for_each(|(path, text)| std::fs::write(path, text).unwrap());
        check(&paths, None).map_err(|error| error.to_string())
    };
    let many = format!("{COLMAP_IMAGES}9 1 0 0 0 -0.5 0.2 0.3 0 images/im2.png\n\n");
    let first_alone = KITTI.lines().take(1).map(|line| format!("{line}\n")).collect::<String>();
    for texts in [&[MIDDLEBURY][..], &[ROS_LEFT, ROS_RIGHT], &[COLMAP_CAMERAS, &many], &[&first_alone]] {
        assert_eq!(check_of(texts), Ok(()));
    }
    for (texts, told) in [
        (&["hello: world"][..], "no calibration that hsad knows"),
        (&[ROS_LEFT], "this is ROS camera_info of one camera"),
        (&[NUMBERS, KALIBR], "two files are"),
        (&[COLMAP_CAMERAS], "name images.txt after it"),
        (&[&MIDDLEBURY.replace("baseline", "base")], "baseline"),
    ] {
        let error = check_of(texts).unwrap_err();
        assert!(error.contains(told), "{error}");
    }
}
