//! Files of every format, whole, cut off and changed.

mod examples;
mod refusals;

use std::path::Path;

use glam::{DMat3, DVec2, DVec3};

use super::*;
use crate::{
    calibration::{
        CameraModel, DoubleSphere, ExtendedUnified, KannalaBrandt, Lens, RadialTangential, StereoCalibration, Unified,
    },
    error::Result,
    image::Size,
    rectify::CalibratedRectification,
};

use self::examples::*;

fn parsed(texts: &[&str], hints: &Hints<'_>) -> Result<Loaded> {
    let names = ["first", "second", "third"];
    let texts: Vec<_> = names.iter().zip(texts).map(|(name, text)| (Path::new(*name), *text)).collect();
    parse(&texts, hints)
}

fn loaded(texts: &[&str]) -> Loaded {
    parsed(texts, &Hints::default()).unwrap()
}

fn error(texts: &[&str]) -> String {
    parsed(texts, &Hints::default()).unwrap_err().to_string()
}

fn radial_tangential(coefficients: &[f64]) -> Lens {
    Lens::Pinhole(RadialTangential::new(coefficients).unwrap())
}

#[test]
fn middlebury_with_two_focal_lengths() {
    let pair = loaded(&[MIDDLEBURY]);
    let [left, right] = *pair.stereo.cameras();
    assert_eq!((left.focal(), right.centre()), (DVec2::new(400.0, 402.0), DVec2::new(182.0, 127.0)));
    assert_eq!((pair.stereo.translation(), pair.rectified), (DVec3::new(-0.1, 0.0, 0.0), None));
    // One focal length: a rectified pair.
    let rectified = loaded(&[&MIDDLEBURY.replace("402", "400")]).rectified.unwrap();
    let (focal, doffs, size) = (rectified.focal, rectified.doffs, rectified.size);
    assert_eq!((focal, doffs, size), (400.0, 12.0, Some(Size::new(340, 255))));
    let unit = Hints { unit: Some(1.0), ..Hints::default() };
    let metres = parsed(&[&MIDDLEBURY.replace("=100", "=0.1")], &unit).unwrap();
    assert_eq!(metres.stereo.baseline(), 0.1);
}

#[test]
fn kittis_cameras_are_told_by_their_folders() {
    let colour = loaded(&[KITTI]);
    // 44.8 + 339.5
    assert!((colour.stereo.baseline() - 384.3 / 721.5).abs() < 1e-12);
    assert!(colour.rectified.is_some() && colour.notes[0].contains("cameras 2 and 3"), "{:?}", colour.notes);
    let pictures = [Path::new("2012/image_0/000000_10.png"), Path::new("2012/image_1/000000_10.png")];
    let grey = parsed(&[KITTI], &Hints { pictures: Some(pictures), ..Hints::default() }).unwrap();
    assert!((grey.stereo.baseline() - 387.5 / 721.5).abs() < 1e-12 && grey.notes.is_empty());
    // The raw pictures are told by their size.
    let sizes = |width, height| Hints { sizes: Some([Size::new(width, height); 2]), ..Hints::default() };
    let raw = parsed(&[KITTI_RAW], &sizes(1392, 512)).unwrap();
    assert_eq!(raw.stereo.translation(), DVec3::new(-0.537, 0.004, -0.012));
    assert_eq!(*raw.stereo.cameras()[0].lens(), radial_tangential(&[-0.37, 0.19, 0.001, 0.001, -0.07]));
    assert_eq!(raw.rectified.unwrap().size, Some(Size::new(1242, 375)));
    let synced = parsed(&[KITTI_RAW], &sizes(1242, 375)).unwrap();
    assert_eq!(synced.stereo.rectified(), synced.rectified);
    assert!(synced.rectified.is_some());
}

#[test]
fn numbers_alone() {
    let rectified = loaded(&[NUMBERS]).rectified.unwrap();
    assert_eq!((rectified.focal, rectified.baseline, rectified.cx, rectified.cy), (754.668, 0.063, 489.379, 265.16));
}

#[test]
fn opencvs_files_complete_each_other() {
    for files in [[OPENCV, OPENCV_POSE], [OPENCV_POSE, OPENCV]] {
        let pair = loaded(&files);
        let [left, right] = *pair.stereo.cameras();
        assert_eq!((left.focal(), right.centre()), (DVec2::new(534.0, 535.0), DVec2::new(334.0, 242.0)));
        assert_eq!(*right.lens(), radial_tangential(&[-0.2, 0.05]));
        assert!((pair.stereo.translation() - DVec3::new(-0.12, 0.0005, 0.0002)).length() < 1e-15);
        assert!(
            pair.notes[0].contains("the baseline is 120.0012 in the file: taken as millimetres"),
            "{:?}",
            pair.notes
        );
        // P2 says 63600 / 530 = 120.
        assert!((pair.rectified.unwrap().baseline - 0.12).abs() < 1e-12);
    }
    // Without camera matrices the pictures are rectified.
    let rectified = loaded(&[OPENCV_POSE]);
    assert_eq!((rectified.stereo.rectified().unwrap().focal, rectified.rectified.unwrap().cx), (530.0, 330.0));
    let fisheye = loaded(&[OPENCV_XML]);
    let lens = Lens::KannalaBrandt(KannalaBrandt::new([-0.01, 0.02, 0.001, 0.0]).unwrap());
    assert_eq!((*fisheye.stereo.cameras()[0].lens(), fisheye.stereo.sizes()[1]), (lens, Some(Size::new(640, 480))));
    let four = loaded(&[&OPENCV_XML.replace("<distortion_model>fisheye</distortion_model>", "")]);
    assert!(four.notes.iter().any(|note| note.contains("D1 has four coefficients: taken as k1 k2 p1 p2")));
}

/// R1, R2, P1 and P2 tell R and T.
#[test]
fn opencvs_rectification_is_undone() {
    let turned = DMat3::from_rotation_y(0.05).transpose().to_cols_array().map(|x| x.to_string()).join(", ");
    let file = format!(
        "{OPENCV}{}R1: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nR2: [{turned}]\n",
        OPENCV_POSE.split_once("P1").map(|(_, rest)| format!("P1{rest}")).unwrap()
    );
    let pair = loaded(&[&file]).stereo;
    assert!(pair.rotation().abs_diff_eq(DMat3::from_rotation_y(-0.05), 1e-12), "{}", pair.rotation());
    let expected = DMat3::from_rotation_y(-0.05) * DVec3::new(-0.12, 0.0, 0.0);
    assert!((pair.translation() - expected).length() < 1e-12);
}

#[test]
fn ros_with_both_spellings() {
    let pair = loaded(&[ROS_LEFT, ROS_RIGHT]);
    assert_eq!(*pair.stereo.cameras()[0].lens(), radial_tangential(&[-0.33, 0.11, 0.0005, 0.0007]));
    assert_eq!(*pair.stereo.cameras()[1].lens(), radial_tangential(&[-0.3, 0.1, 0.0, 0.0, 0.0, 0.02, 0.01]));
    // 51.48 / 429, and R = R2' R1
    assert!((pair.stereo.baseline() - 0.12).abs() < 1e-12);
    assert!((pair.stereo.rotation().row(0) - DVec3::new(0.9995000416652778, 0.0, 0.03161750711666)).length() < 1e-9);
    assert!((pair.rectified.unwrap().baseline - 0.12).abs() < 1e-12);
    let swapped = error(&[ROS_LEFT, ROS_LEFT]);
    assert!(swapped.contains("fourth value is minus focal length times baseline"), "{swapped}");
}

#[test]
fn kalibrs_models() {
    let pair = loaded(&[KALIBR]).stereo;
    let fisheye = Lens::KannalaBrandt(KannalaBrandt::new([-0.01, 0.02, -0.006, 0.0008]).unwrap());
    let distortion = RadialTangential::new(&[-0.05, 0.01, 0.001, -0.002]).unwrap();
    let lenses = pair.cameras().map(|camera| *camera.lens());
    assert_eq!(lenses, [fisheye, Lens::Unified(Unified::new(0.9, distortion).unwrap())]);
    assert_eq!((pair.translation(), pair.sizes()[0]), (DVec3::new(-0.101, 0.001, 0.002), Some(Size::new(512, 512))));
    let omni = "camera_model: omni\n  distortion_coeffs: [-0.05, 0.01, 0.001, -0.002]\n  distortion_model: radtan\n  \
                intrinsics: [0.9, 190.4";
    let other = |text: &str| *loaded(&[&KALIBR.replace(omni, text)]).stereo.cameras()[1].lens();
    let none = "distortion_coeffs: []\n  distortion_model: none\n ";
    assert_eq!(
        other(&format!("camera_model: ds\n  {none} intrinsics: [-0.2, 0.55, 190.4")),
        Lens::DoubleSphere(DoubleSphere::new(-0.2, 0.55).unwrap())
    );
    assert_eq!(
        other(&format!("camera_model: eucm\n  {none} intrinsics: [0.6, 1.1, 190.4")),
        Lens::ExtendedUnified(ExtendedUnified::new(0.6, 1.1).unwrap())
    );
}

#[test]
fn eurocs_cameras_stand_on_a_body() {
    let pair = loaded(&[EUROC_LEFT, &euroc_right()]).stereo;
    assert!(pair.rotation().abs_diff_eq(DMat3::IDENTITY, 1e-15));
    // The right camera is 0.11 m along the body's y, which is the cameras' x.
    assert!((pair.translation() - DVec3::new(-0.11, 0.0, 0.0)).length() < 1e-15, "{}", pair.translation());
    assert_eq!(pair.cameras()[0].centre(), DVec2::new(367.215, 248.375));
}

#[test]
fn colmaps_pictures_are_found_by_their_names() {
    for files in [[COLMAP_CAMERAS, COLMAP_IMAGES], [COLMAP_IMAGES, COLMAP_CAMERAS]] {
        let pair = loaded(&files).stereo;
        assert!((pair.translation() - DVec3::new(-0.12, 0.0, 0.0)).length() < 1e-15);
        // From the corner of the first pixel to its centre.
        assert_eq!(pair.cameras()[0].centre(), DVec2::new(367.0, 248.0));
        assert!(matches!(pair.cameras()[1].lens(), Lens::KannalaBrandt(_)));
    }
    let three = format!("{COLMAP_IMAGES}9 1 0 0 0 -0.5 0.2 0.3 0 images/im2.png\n\n");
    let pictures = [Path::new("a/im2.png"), Path::new("a/im0.png")];
    let named = parsed(&[COLMAP_CAMERAS, &three], &Hints { pictures: Some(pictures), ..Hints::default() }).unwrap();
    assert!((named.stereo.translation() - DVec3::new(0.6, 0.0, 0.0)).length() < 1e-15);
    assert!(error(&[COLMAP_CAMERAS, &three]).contains("there are 3 pictures"));
}

#[test]
fn own_json_comes_back_as_it_was_written() {
    let pair = loaded(&[OWN]).stereo;
    assert_eq!(*pair.cameras()[0].lens(), radial_tangential(&[-0.3, 0.1, 0.001, 0.0]));
    assert_eq!((pair.translation(), pair.sizes()), (DVec3::new(-0.12, 0.0, 0.0), [Some(Size::new(640, 480)), None]));
    for texts in examples() {
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let stereo = loaded(&texts).stereo;
        assert_eq!(loaded(&[&to_json(&stereo)]).stereo, stereo);
    }
    let lens = Lens::ExtendedUnified(ExtendedUnified::new(0.6, 1.1).unwrap());
    let camera = CameraModel::new(DVec2::splat(0.1 + 0.2), DVec2::splat(1e-7), lens).unwrap();
    let stereo = StereoCalibration::new([camera; 2], [None; 2], DMat3::from_rotation_x(0.1), DVec3::X).unwrap();
    assert_eq!(loaded(&[&to_json(&stereo)]).stereo, stereo);
}

#[test]
fn a_rectification_is_read_back_as_opencvs() {
    let pair = loaded(&[OPENCV, OPENCV_POSE]).stereo;
    let rectification = CalibratedRectification::new(&pair, [Size::new(640, 480); 2]).unwrap();
    let text = to_opencv_yaml(&rectification);
    let read = loaded(&[&text]).rectified.unwrap();
    let (found, written) = (read, *rectification.calibration());
    assert!((found.baseline - written.baseline).abs() < 1e-12);
    assert_eq!(Calibration { baseline: written.baseline, ..found }, written);
}

/// The sections of the page about calibrations, each with its files.
#[test]
fn the_examples_of_the_page_are_read() {
    let page = include_str!("../../../../docs/calibration.md");
    let mut count = 0;
    for section in page.split("\n### ").skip(1) {
        let blocks = section.split("\n```").skip(1).step_by(2).filter(|block| !block.starts_with("python"));
        let files: Vec<&str> = blocks.map(|block| block.split_once('\n').unwrap().1).collect();
        parsed(&files, &Hints::default()).unwrap_or_else(|error| panic!("{section}: {error}"));
        count += 1;
    }
    assert_eq!(count, 9);
}
