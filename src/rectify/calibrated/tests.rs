use glam::{DMat4, DVec2, DVec4};

use super::*;
use crate::calibration::{CameraModel, DoubleSphere, KannalaBrandt, Lens, RadialTangential};

const SIZE: Size = Size::new(640, 480);

fn camera(lens: Lens) -> CameraModel {
    CameraModel::new(DVec2::new(430.0, 432.0), DVec2::new(325.5, 236.25), lens).unwrap()
}

fn barrel() -> Lens {
    Lens::Pinhole(RadialTangential::new(&[-0.28, 0.09, 0.001, -0.0007]).unwrap())
}

/// A lens that sees 175 degrees along the rows of its picture.
fn fisheye() -> CameraModel {
    let lens = Lens::KannalaBrandt(KannalaBrandt::new([-0.012, 0.021, -0.0063, 0.0008]).unwrap());
    CameraModel::new(DVec2::splat(210.0), DVec2::new(318.0, 242.0), lens).unwrap()
}

fn pair(cameras: [CameraModel; 2], rotation: DMat3, right_centre: DVec3) -> StereoCalibration {
    StereoCalibration::new(cameras, [Some(SIZE); 2], rotation, -(rotation * right_centre)).unwrap()
}

fn rectified(stereo: &StereoCalibration) -> CalibratedRectification {
    CalibratedRectification::new(stereo, [SIZE; 2]).unwrap()
}

fn turned(x: f64, y: f64, z: f64) -> DMat3 {
    DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x)
}

/// Rigs, and the quarter turns that they need.
fn rigs() -> Vec<(&'static str, StereoCalibration, u32)> {
    let (flat, curved) = ([camera(barrel()); 2], [fisheye(); 2]);
    let aside = DVec3::new(0.12, 0.002, -0.003);
    let other = CameraModel::pinhole(DVec2::splat(520.0), DVec2::new(300.0, 250.0)).unwrap();
    let sphere = Lens::DoubleSphere(DoubleSphere::new(-0.2, 0.55).unwrap());
    let sphere = CameraModel::new(DVec2::splat(160.0), DVec2::new(320.0, 240.0), sphere).unwrap();
    vec![
        ("parallel", pair(flat, DMat3::IDENTITY, aside), 0),
        ("noisy", pair(flat, turned(0.02, -0.03, 0.05), aside), 0),
        ("towards each other", pair(flat, turned(0.0, 0.5, 0.0), aside), 0),
        ("apart", pair(flat, turned(0.0, -0.3, 0.0), aside), 0),
        ("one rolled", pair(flat, turned(0.0, 0.0, 0.6), aside), 0),
        ("upside down", pair(flat, turned(0.0, 0.0, 3.1), aside), 0),
        ("below", pair(flat, turned(0.03, 0.0, 0.01), DVec3::new(0.003, 0.2, 0.0)), 1),
        ("swapped", pair(flat, turned(0.0, 0.03, 0.01), -aside), 2),
        ("above", pair(flat, turned(-0.03, 0.0, 0.01), DVec3::new(0.003, -0.2, 0.01)), 3),
        ("two cameras", pair([camera(barrel()), other], turned(0.01, 0.02, 0.0), aside), 0),
        ("fisheyes", pair(curved, turned(0.01, 0.02, -0.03), aside), 0),
        ("fisheyes above", pair(curved, turned(0.01, 0.02, -0.03), DVec3::new(0.0, -0.1, 0.0)), 3),
        ("spheres", pair([sphere; 2], turned(0.01, 0.02, -0.03), aside), 0),
    ]
}

/// Points before the left camera, in metres.
fn points() -> impl Iterator<Item = DVec3> {
    let steps = |n: i32| (-n..=n).map(f64::from);
    steps(4).flat_map(move |x| {
        steps(3).flat_map(move |y| [0.8, 2.0, 9.0].map(|z| DVec3::new(0.15 * x * z, 0.15 * y * z, z)))
    })
}

#[test]
fn rows_correspond_and_depth_comes_back_in_the_left_camera() {
    for (name, stereo, _) in rigs() {
        let rectification = rectified(&stereo);
        let mut seen = 0;
        for point in points() {
            let there = stereo.rotation() * point + stereo.translation();
            let raw = stereo.cameras()[0].project(point).zip(stereo.cameras()[1].project(there));
            let Some((left, right)) = raw else { continue };
            let [left_view, right_view] = rectification.views();
            let places = left_view.rectified_of(left).zip(right_view.rectified_of(right));
            let Some((left_place, right_place)) = places else { continue };
            assert!((left_place.y - right_place.y).abs() < 1e-7, "{name}: {left_place} and {right_place}");
            let disparity = left_place.x - right_place.x;
            let calibration = rectification.calibration();
            let depth = calibration.depth(disparity).unwrap();
            let ray = ((left_place - DVec2::new(calibration.cx, calibration.cy)) / calibration.focal).extend(1.0);
            let back = rectification.in_left_camera(depth * ray);
            assert!((back - point).length() < 1e-7 * point.length(), "{name}: {point} came back as {back}");
            // OpenCV's matrices say the same.
            let q = DMat4::from_cols_array(&rectification.reprojection()).transpose();
            let homogeneous = q * DVec4::new(left_place.x, left_place.y, disparity, 1.0);
            let reprojected = homogeneous.truncate() / homogeneous.w;
            assert!((rectification.in_left_camera(reprojected) - point).length() < 1e-7 * point.length());
            let [_, p2] = rectification.projections();
            let rows = [0, 4, 8].map(|row| DVec4::from_slice(&p2[row..]).dot(reprojected.extend(1.0)));
            assert!((DVec2::new(rows[0], rows[1]) / rows[2] - right_place).length() < 1e-6, "{name}");
            // And back to the pictures.
            assert!((left_view.source_of(left_place).unwrap() - left).length() < 1e-6, "{name}");
            assert!((right_view.source_of(right_place).unwrap() - right).length() < 1e-6, "{name}");
            seen += 1;
        }
        assert!(seen > 60, "{name}: {seen} points");
    }
}

#[test]
fn pictures_are_as_large_as_needed_and_turned_by_quarters() {
    for (name, stereo, quarter_turns) in rigs() {
        let rectification = rectified(&stereo);
        assert_eq!(rectification.quarter_turns(), quarter_turns, "{name}");
        let Size { width, height } = rectification.size();
        assert!(width.max(height) <= 1280, "{name}: {width}x{height}");
        let middle = rectification.views()[0].rectified_of(DVec2::new(320.0, 240.0)).unwrap();
        assert!((middle - middle.round()).length() < 1e-6, "{name}: the middle of the left view is at {middle}");
        for view in rectification.views() {
            // At the centre of the picture the rectified pixels are not larger than those of the source.
            let middle = view.rectified_of(DVec2::new(319.5, 239.5)).unwrap();
            let source = |x: f64, y: f64| view.source_of(middle + DVec2::new(x, y)).unwrap();
            let (across, down) = (source(0.5, 0.0) - source(-0.5, 0.0), source(0.0, 0.5) - source(0.0, -0.5));
            let area = across.perp_dot(down);
            assert!((0.55..1.001).contains(&area), "{name}: {area}");
            let shown = view.map().unwrap().visible().data().iter().filter(|&&mask| mask != 0).count();
            let share = shown as f64 / f64::from(width * height);
            assert!(share > 0.45, "{name}: {share} of {width}x{height} is shown");
        }
    }
}

#[test]
fn maps_follow_the_cameras_to_within_a_32nd_of_a_pixel() {
    for (name, stereo, _) in rigs() {
        let rectification = rectified(&stereo);
        for (view, map) in rectification.views().iter().zip(rectification.maps().unwrap()) {
            let deviation = map.deviation(|position| view.source_of(position).unwrap_or(DVec2::NAN));
            assert!(deviation <= 1.0 / 32.0, "{name}: {deviation}");
        }
    }
}

#[test]
fn a_rectified_pair_is_left_as_it_is() {
    let calibration = Calibration { focal: 400.0, baseline: 0.1, doffs: 0.0, cx: 170.0, cy: 127.0, size: Some(SIZE) };
    let rectification = rectified(&StereoCalibration::from_rectified(&calibration).unwrap());
    let found = rectification.calibration();
    assert_eq!(rectification.size(), SIZE);
    for (found, given) in [(found.focal, 400.0), (found.cx, 170.0), (found.cy, 127.0), (found.baseline, 0.1)] {
        assert!((found - given).abs() < 1e-5, "{found} is {given}");
    }
    let identity = WarpMap::new(SIZE, SIZE, |p| p).unwrap();
    assert_eq!(rectification.maps().unwrap(), [identity.clone(), identity]);
}

#[test]
fn what_no_turn_rectifies_is_refused() {
    let cameras = [camera(barrel()); 2];
    for (stereo, expected) in [
        (pair(cameras, DMat3::IDENTITY, DVec3::new(0.01, 0.0, 0.3)), "one camera stands in front of the other"),
        (pair(cameras, DMat3::IDENTITY, DVec3::new(0.01, 0.0, -0.3)), "one camera stands in front of the other"),
        (pair(cameras, turned(0.0, std::f64::consts::PI, 0.0), DVec3::X), "no common field of view"),
        (pair(cameras, turned(0.0, -1.6, 0.0), DVec3::new(0.3, 0.0, 0.1)), "no common field of view"),
    ] {
        let error = CalibratedRectification::new(&stereo, [SIZE; 2]).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let stereo = pair(cameras, DMat3::IDENTITY, DVec3::X);
    let error = CalibratedRectification::new(&stereo, [SIZE, Size::new(320, 240)]).unwrap_err().to_string();
    assert!(error.contains("640x480") && error.contains("the right view is 320x240"), "{error}");
}
