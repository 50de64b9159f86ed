//! `hsad rectify`, and the same in front of `hsad match`.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hsad::{
    image::Plane,
    io::{Picture, load, pfm},
};
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;

use crate::common::{RECTIFIED, folder, grey_png, hsad, names, noise, report, scene, views};

/// The right view of the shipped scene turned by 90 degrees, clockwise on the screen.
fn turned_right(folder: &Path) -> PathBuf {
    let right = load::load(&scene("planes", "right.png")).unwrap().luma();
    let path = folder.join("turned.png");
    grey_png(&path, &Plane::from_fn((255, 340), |x, y| right.get(y, 254 - x)));
    path
}

fn rectified(left: &Path, right: &Path, out: &Path, device: &str) -> assert_cmd::assert::Assert {
    hsad().arg("rectify").args([left, right]).arg("-o").arg(out).args(["--device", device]).assert()
}

#[test]
fn a_turned_view_of_another_size_is_turned_back() {
    let (temporary, [left, _]) = (folder(), views("planes"));
    let right = turned_right(temporary.path());
    let out = temporary.path().join("out");
    rectified(&left, &right, &out, "cpu")
        .success()
        .stdout(contains("the right view was resampled (affine)").and(contains("340x255 pixels")));
    assert_eq!(names(&out), RECTIFIED);
    assert_eq!(load::load(&out.join("left.png")).unwrap(), load::load(&left).unwrap(), "the left view stays");
    let original = load::load(&scene("planes", "right.png")).unwrap();
    let shown = load::load(&out.join("right.png")).unwrap();
    let off = |picture: &Picture, x, y| {
        let [a, b] = [picture, &original].map(|picture| i64::from(picture.luma().get(x, y)));
        a.abs_diff(b)
    };
    let places = (0..300).map(|i| (20 + i % 20 * 15, 20 + i / 20 * 14));
    let sum: u64 = places.map(|(x, y)| off(&shown, x, y)).sum();
    assert!(sum < 300 * 12, "{sum}");

    let json: Value = serde_json::from_slice(&fs::read(out.join("rectification.json")).unwrap()).unwrap();
    assert_eq!((&json["model"], &json["k1"]), (&Value::from("affine"), &Value::from(0.0)));
    assert!(json["residual"]["mean_px"].as_f64().unwrap() < 0.5, "{json}");
    let yaml = fs::read_to_string(out.join("rectification.yml")).unwrap();
    assert_eq!(report(&out)["rectified"], json);
    assert!(yaml.starts_with("%YAML:1.0\n---\n") && yaml.matches("!!opencv-matrix").count() == 6, "{yaml}");
}

#[test]
fn gpu_and_cpu_write_the_same_pictures() {
    let (temporary, [left, _]) = (folder(), views("planes"));
    let right = turned_right(temporary.path());
    let pictures = ["cpu", "best"].map(|device| {
        let out = temporary.path().join(device);
        rectified(&left, &right, &out, device).success();
        // Positions of interest points are floats, and so are homographies: the pictures may differ by a rounding of the map.
        load::load(&out.join("right.png")).unwrap()
    });
    let [cpu, gpu] = pictures.each_ref().map(|picture| picture.luma());
    let far = cpu.data().iter().zip(gpu.data()).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    assert!(far < cpu.data().len() / 500, "{far} pixels differ");
}

#[test]
fn a_match_of_views_of_different_sizes_rectifies_them() {
    let (temporary, [left, _]) = (folder(), views("planes"));
    let right = turned_right(temporary.path());
    let out = temporary.path().join("out");
    let run = |more: &[&str]| {
        let mut command = hsad();
        command.arg("match").args([&left, &right]).arg("-o").arg(&out).args(["--device", "cpu"]).args(more);
        command.assert()
    };
    run(&["--rectify", "never"]).code(1).stderr(contains("a rectified pair has one size"));
    run(&["--focal", "500", "--baseline", "0.1"])
        .code(5)
        .stderr(contains("rectified from its matches").and(contains("which tell no baseline")));
    let report = report(&out);
    assert_eq!((&report["rectified"]["model"], &report["calibration"]), (&Value::from("affine"), &Value::Null));
    let truth = pfm::read(&scene("planes", "disp_left.pfm")).unwrap();
    let map = pfm::read_disparities(&out.join("disparity.pfm")).unwrap();
    let score = hsad::eval::score(&map, &truth, None, &[1.0]).unwrap();
    assert!(score.bad[0].of_estimated < 0.08, "{score:?}");
    assert!(out.join("rectified-left.png").exists() && !out.join("cloud.ply").exists());
}

#[test]
fn what_cannot_be_rectified_is_three_and_leaves_nothing() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let other = temporary.path().join("noise.png");
    grey_png(&other, &noise(340, 255, 3));
    let out = temporary.path().join("out");
    rectified(&left, &other, &out, "cpu").code(3).stderr(contains("the views are unrelated"));
    rectified(&left, &left, &out, "cpu").code(3).stderr(contains("the views show no parallax"));
    // One picture 20 px lower, as a camera shows a plane that moved.
    let picture = load::load(&left).unwrap().luma();
    let lower = temporary.path().join("lower.png");
    grey_png(&lower, &Plane::from_fn((340, 255), |x, y| picture.get_clamped(i64::from(x), i64::from(y) - 40)));
    rectified(&left, &lower, &out, "cpu").code(3).stderr(contains("the views show a plane, "));
    // What a camera shows that turned to the right: K R K^-1.
    let turned = temporary.path().join("panned.png");
    let (sin, cos) = 0.12_f64.sin_cos();
    grey_png(
        &turned,
        &Plane::from_fn((340, 255), |x, y| {
            let (x, y) = ((f64::from(x) - 169.5) / 378.0, (f64::from(y) - 127.0) / 378.0);
            let depth = cos - sin * x;
            let (u, v) = (378.0 * (cos * x + sin) / depth + 169.5, 378.0 * y / depth + 127.0);
            let (i, j) = (u.floor(), v.floor());
            let at = |i: f64, j: f64| f64::from(picture.get_clamped(i as i64, j as i64));
            let row = |j: f64| at(i, j) * (1.0 - u + i) + at(i + 1.0, j) * (u - i);
            (row(j) * (1.0 - v + j) + row(j + 1.0) * (v - j)).round() as u8
        }),
    );
    rectified(&left, &turned, &out, "cpu").code(3).stderr(contains("the camera turned on the spot, "));
    assert!(!out.exists());
    rectified(&left, &right, &out, "cpu").success().stdout(contains("rows correspond as they are"));
}
