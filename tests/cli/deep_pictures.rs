//! `hsad match` of deep pictures, masks and missing data.

use std::{fs, path::Path};

use hsad::{
    image::Plane,
    io::{load, pfm},
};
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::json;

use crate::{
    common::{fails, folder, grey_png, hsad, match_on_cpu, names, report, views},
    exif::turned_jpeg,
};

/// The luma of a view as PFM: `20 + grey / 1000`, a small part of what floats can be.
fn float_copy(view: &Path, copy: &Path) {
    let luma = load::load(view).unwrap().luma();
    let mut bytes = Vec::new();
    pfm::write(&mut bytes, &luma.map(|&grey| 20.0 + f32::from(grey) / 1000.0)).unwrap();
    fs::write(copy, bytes).unwrap();
}

#[test]
fn the_stretch_of_floats_is_told() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let [left_copy, right_copy] = ["left.pfm", "right.pfm"].map(|name| temporary.path().join(name));
    float_copy(&left, &left_copy);
    float_copy(&right, &right_copy);
    let out = temporary.path().join("out");
    let mut command = match_on_cpu(&left_copy, &right_copy, &out);
    let told = contains("stretch    20.").and(contains(" in the files became 0 to 255"));
    command.args(["--disparities", "72", "--preset", "fast"]).assert().success().stdout(told).stderr("");
    let stretch = &report(&out)["stretch"];
    let [low, high] = ["low", "high"].map(|end| stretch[end].as_f64().unwrap());
    assert!(20.0 <= low && low < high && high <= 20.255, "{stretch}");

    // Pictures of 8 bits have none.
    let out = temporary.path().join("shallow");
    let mut command = match_on_cpu(&left, &right, &out);
    command.args(["--disparities", "72", "--preset", "fast"]);
    command.assert().success().stdout(contains("stretch").not());
    assert_eq!(report(&out)["stretch"], json!(null));
}

#[test]
fn masks_and_missing_data_that_do_not_fit() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let path = |name: &str| temporary.path().join(name);
    grey_png(&path("small.png"), &Plane::filled((9, 9), 255));
    grey_png(&path("black.png"), &Plane::filled((340, 255), 0));
    grey_png(&path("flat.png"), &Plane::filled((340, 255), 7));
    let written = names(temporary.path());
    let fails_with = |left: &Path, args: &[&str], expected: &str| {
        let mut command = match_on_cpu(left, &right, &path("out"));
        command.args(args);
        fails(command, 1, expected);
        assert_eq!(names(temporary.path()), written);
    };
    let [small, black, missing] =
        ["small.png", "black.png", "missing.png"].map(|name| path(name).display().to_string());
    fails_with(&left, &["--mask", &small], "small.png: the mask is 9x9");
    fails_with(&left, &["--mask", &black], "black.png: the mask leaves no pixel of");
    fails_with(&left, &["--mask", left.to_str().unwrap(), &small], "right.png, 340x255 pixels");
    fails_with(&left, &["--mask", &missing], "missing.png");
    fails_with(&path("flat.png"), &["--nodata", "7"], "flat.png: all its pixels have the value for missing data, 7");
    for impossible in ["300", "-9999", "7.5"] {
        let mut command = match_on_cpu(&left, &right, &path("out"));
        command.args(["--nodata", impossible]);
        let told = format!("--nodata is {impossible}, but samples of these pictures are whole numbers from 0 to 255");
        fails(command, 2, &told);
    }
    for args in [&["--nodata", "none"][..], &["--nodata"], &["--mask"]] {
        hsad().args(["match", "a", "b", "-o", "out"]).args(args).assert().code(2).stderr(contains("error: "));
    }
}

#[test]
fn masks_and_negative_missing_data_are_taken() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let out = temporary.path().join("out");
    let mask = temporary.path().join("mask.png");
    grey_png(&mask, &Plane::from_fn((340, 255), |x, _| if x < 20 { 0 } else { 1 }));
    let floats = [left, right].map(|view| {
        let path = temporary.path().join(view.with_extension("pfm").file_name().unwrap());
        let mut bytes = Vec::new();
        pfm::write(&mut bytes, &load::load(&view).unwrap().luma().map(|&grey| f32::from(grey))).unwrap();
        fs::write(&path, bytes).unwrap();
        path
    });
    let [left, right] = &floats;
    for nodata in ["-9999", "nan", "-3.4e38"] {
        let mut command = match_on_cpu(left, right, &out);
        command.args(["--disparities", "72", "--preset", "fast", "--nodata", nodata, "--mask"]).args([&mask, &mask]);
        command.assert().success().stderr("");
    }
}

#[test]
fn different_exif_orientations_end_in_the_report() {
    let temporary = folder();
    let [upright, reversed] = [1, 3].map(|orientation| {
        let path = temporary.path().join(format!("{orientation}.jpg"));
        fs::write(&path, turned_jpeg(64, 48, orientation)).unwrap();
        path
    });
    let out = temporary.path().join("out");
    let mut command = match_on_cpu(&upright, &reversed, &out);
    let told = "the left view is not turned and the right view turned by 180 degrees";
    command.args(["--force", "--disparities", "9"]).assert().success().stderr(contains(told).count(1));
    assert!(report(&out)["warnings"][0].as_str().unwrap().contains(told));
}
