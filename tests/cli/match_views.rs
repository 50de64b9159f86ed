//! `hsad match`: files, report, options, odd pairs.

use std::{fs, path::Path};

use hsad::{
    Options,
    disparity::{NONE, coverage, in_pixels},
    image::{Plane, Size},
    io::{disparities, disparity_png, load, pfm},
    options::Kind,
};
use image::codecs::png::PngEncoder;
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::{Value, json};

use crate::common::{
    fails, folder, grey_png, hsad, hsad_without_driver, match_on_cpu, names, noise, report, scene, views,
};
#[cfg(unix)]
use crate::interruption::Run;

/// Smallest and largest disparity of a reported range, and its source.
fn ends(range: &Value) -> (i64, i64, &str) {
    (range["min"].as_i64().unwrap(), range["max"].as_i64().unwrap(), range["source"].as_str().unwrap())
}

fn asked(min: i64, max: i64) -> (i64, i64, &'static str) {
    (min, max, "asked")
}

#[test]
fn writes_maps_that_agree_and_a_report() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let out = temporary.path().join("a/b");
    let summary = contains("found from a coarse map").and(contains("coverage")).and(contains("disparity.pfm"));
    match_on_cpu(&left, &right, &out).assert().success().stdout(summary).stderr("");
    let files = ["confidence.png", "disparity-color.png", "disparity.pfm", "disparity.png", "report.json"];
    assert_eq!(names(&out), files);

    let map = pfm::read_disparities(&out.join("disparity.pfm")).unwrap();
    assert_eq!(disparity_png::read(&out.join("disparity.png")).unwrap(), map);
    let confidence = load::load(&out.join("confidence.png")).unwrap().luma();
    let colors = load::load(&out.join("disparity-color.png")).unwrap();
    for ((&d, &confidence), &[r, g, b, _]) in map.data().iter().zip(confidence.data()).zip(colors.data()) {
        assert_eq!(d == NONE, [r, g, b] == [0; 3]);
        assert!(d != NONE || confidence == 0);
    }
    let truth = pfm::read(&scene("planes", "disp_left.pfm")).unwrap();
    let score = hsad::eval::score(&map, &truth, None, &[1.0]).unwrap();
    assert!(score.bad[0].of_estimated < 0.05 && score.coverage() == 1.0, "{score:?}");

    let report = report(&out);
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!([&report["width"], &report["height"]], [340, 255]);
    assert_eq!(report["device"], json!({ "name": "CPU twins", "backend": "none", "driver": "none" }));
    assert_eq!(report["left"], left.to_str().unwrap());
    let aggregation = &report["parameters"]["aggregation"];
    assert_eq!([&aggregation["paths"], &aggregation["cost_window"], &aggregation["p1"]], [3, 1, 16]);
    assert_eq!(report["parameters"]["matching"]["ratio"], json!(0.85));
    assert_eq!(report["range"]["source"], "found");
    // The disparities of the scene are 9.1 to 57.5 px (data/README.md).
    let range = |end: &str| report["range"][end].as_i64().unwrap();
    assert!((-20..=9).contains(&range("min")) && (57..120).contains(&range("max")), "{}", report["range"]);
    assert_eq!(range("count"), range("max") - range("min") + 1);
    assert_eq!(report["rectification"]["verdict"], "rectified");
    assert!(report["features"]["left"].as_u64().unwrap() > 100 && report["seeds"].as_u64().unwrap() > 100);
    assert!((report["coverage"].as_f64().unwrap() - coverage(&map)).abs() < 1e-9);
    assert!(report["trust"].as_f64().unwrap() > 0.5);
    assert!(report["equalised"]["gain"].as_f64().is_some_and(|gain| (gain - 1.0).abs() < 0.1));
    assert!(report["brightness"]["gain"].as_f64().is_some_and(|gain| (gain - 1.0).abs() < 0.1));
    assert!(["luma", "features", "seeding", "dense", "total"].iter().all(|step| report["seconds"][step].is_f64()));
    assert_eq!(report["files"].as_array().unwrap().len(), files.len());
    assert_eq!((&report["calibration"], &report["warnings"]), (&json!(null), &json!([])));
    assert_eq!(report["disparity_png"], json!({ "px_per_value": 1.0 / 256.0, "offset_px": 0 }));
}

#[test]
fn the_strongest_points_will_do_and_the_report_says_so() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let run = |name: &str, most: &str| {
        let out = temporary.path().join(name);
        let told = contains(", spread over the picture: --max-features");
        let run = match_on_cpu(&left, &right, &out).args(["--max-features", most, "--disparities", "64"]).assert();
        let run = run.success();
        if most == "200" {
            run.stderr(told)
        } else {
            run.stderr("")
        };
        report(&out)
    };
    let (all, few) = (run("all", "65536"), run("few", "200"));
    let points = |report: &Value, name: &str| report["features"][name].as_u64().unwrap();
    for side in ["left", "right"] {
        let found = format!("{side}_found");
        assert!(points(&all, side) > 400 && points(&all, side) == points(&all, &found), "{}", all["features"]);
        assert_eq!((points(&few, side), points(&few, &found)), (200, points(&all, side)));
    }
    assert!(
        few["warnings"][0].as_str().unwrap().contains("the strongest 200 and 200 were used"),
        "{}",
        few["warnings"]
    );
    // Both views keep mostly the same points, so that a good part of them still matches.
    assert!(few["seeds"].as_u64().unwrap() >= 60 && few["rectification"]["verdict"] == "rectified", "{few}");
}

#[test]
fn gpu_and_cpu_find_the_same_bytes() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let run = |device: &str| {
        let out = temporary.path().join(device);
        let mut command = hsad();
        command.arg("match").args([&left, &right]).arg("-o").arg(&out).args([
            "--device",
            device,
            "--disparities",
            "72",
        ]);
        command.assert().success();
        (fs::read(out.join("disparity.pfm")).unwrap(), fs::read(out.join("confidence.png")).unwrap(), report(&out))
    };
    let ((cpu, cpu_confidence, _), (gpu, gpu_confidence, gpu_report)) = (run("cpu"), run("0"));
    assert_ne!(gpu_report["device"]["backend"], "none", "this test needs a device; lavapipe is one");
    assert!(cpu == gpu && cpu_confidence == gpu_confidence);
}

/// What the library describes is an argument by itself.
#[test]
fn every_option_of_the_library_is_an_argument() {
    let output = hsad().args(["match", "--help"]).assert().success().get_output().stdout.clone();
    let help = String::from_utf8(output).unwrap();
    for option in Options::ALL {
        let name = option.name.replace('_', "-");
        let own = help.split("\n      --").find(|own| own.split_whitespace().next() == Some(&name));
        let own = own.unwrap_or_else(|| panic!("{name} is no argument"));
        let Kind::Choice(choices) = option.kind() else { continue };
        assert!(choices.iter().all(|choice| own.contains(choice.name)), "{own}");
    }
}

#[test]
fn options_override_the_preset() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let out = temporary.path();
    let mut command = match_on_cpu(&left, &right, out);
    command.args(["--preset", "paper", "--window", "5", "--min-disparity", "-3", "--disparities", "40", "-q"]);
    command.args(["--uniqueness", "7", "--max-lr-difference", "1.5", "--interpolation", "none", "--octaves", "3"]);
    command.args(["--step", "2", "--threshold", "0.002", "--upright", "--max-features", "5000", "--ratio", "0.8"]);
    command.args(["--figures", "--strongest", "4", "--force"]);
    command.assert().success().stdout("").stderr("");
    let report = report(out);
    assert_eq!(ends(&report["range"]), asked(-3, 36));
    let expected = json!({
        "method": "hsad", "reference": "right", "aggregation": "window", "window": 5, "search": "whole", "compared": "luma", "range": { "min": -3, "max": 36, "count": 40 }, "min_disparity": -3,
        "interpolation": "none", "uniqueness_percent": 7, "max_lr_difference_px": 1.5, "agreement": 0, "refinement": null, "equalise": false, "align": false, "force": true,
        "features": { "octaves": 3, "step": 2, "threshold": 0.002, "upright": true, "max_features": 5000 },
        "matching": { "ratio": 0.8, "mutual": true, "same_contrast": true, "max_dy_px": 1.5 },
        "tiles": null, "strongest": 4
    });
    assert_eq!(report["parameters"], expected);
    let map = pfm::read_disparities(&out.join("disparity.pfm")).unwrap();
    assert!(map.data().iter().all(|&d| d == NONE || (d % 256 == 0 && (-768..=36 * 256).contains(&d))));
}

#[test]
fn holes_of_fast_are_filled_on_demand() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let run = |name: &str, args: &[&str]| {
        let out = temporary.path().join(name);
        let mut command = match_on_cpu(&left, &right, &out);
        command.args(["--preset", "fast", "--disparities", "72"]).args(args).assert().success();
        report(&out)
    };
    let (fast, filled) = (run("fast", &[]), run("filled", &["--fill"]));
    let parameters = |report: &Value| ["compared", "agreement"].map(|name| report["parameters"][name].clone());
    assert_eq!(parameters(&fast), [json!("soft-rank"), json!(6)]);
    assert_eq!(parameters(&fast), parameters(&filled));
    assert_eq!(fast["parameters"]["refinement"], json!(null));
    assert_eq!(filled["parameters"]["refinement"]["fill"], json!(true));
    let coverage = |report: &Value| report["coverage"].as_f64().unwrap();
    assert!(
        (0.7..0.95).contains(&coverage(&fast)) && coverage(&filled) == 1.0,
        "{} {}",
        coverage(&fast),
        coverage(&filled)
    );
    let luma = run("luma", &["--compare", "luma", "--agreement", "0", "--max-lr-difference", "1"]);
    assert_eq!(parameters(&luma), [json!("luma"), json!(0)]);
}

#[test]
fn the_hybrid_method_finds_disparities_too() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let run = |device: &str| {
        let out = temporary.path().join(device);
        let mut command = hsad();
        command.arg("match").args([&left, &right]).arg("-o").arg(&out);
        command.args(["--method", "kamencay", "--device", device]);
        command.assert().success().stdout(contains("found from a coarse map").and(contains("coverage"))).stderr("");
        (fs::read(out.join("disparity.pfm")).unwrap(), fs::read(out.join("confidence.png")).unwrap())
    };
    assert!(run("cpu") == run("0"), "the device and the twins differ");
    let out = temporary.path().join("0");
    let found = report(&out);
    let parameters = &found["parameters"];
    assert_eq!([&parameters["method"], &parameters["reference"]], ["kamencay", "left"]);
    assert_eq!((&parameters["belief_propagation"]["levels"], &parameters["cost"]["window"]), (&json!(5), &json!(3)));
    assert_eq!((&parameters["aggregation"], &found["range"]["source"]), (&json!(null), &json!("found")));
    let map = pfm::read_disparities(&out.join("disparity.pfm")).unwrap();
    let truth = pfm::read(&scene("planes", "disp_left.pfm")).unwrap();
    let score = hsad::eval::score(&map, &truth, None, &[1.0]).unwrap();
    assert!(score.bad[0].of_known < 0.15 && score.coverage() == 1.0, "{score:?}");
}

#[test]
fn the_hybrid_method_searches_what_it_is_told_from_either_view() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let out = temporary.path();
    let mut command = match_on_cpu(&left, &right, out);
    command.args(["--method", "kamencay", "--reference", "right", "--min-disparity", "-3", "--disparities", "72"]);
    command.args(["--no-equalise", "-q"]).assert().success().stdout("").stderr("");
    let found = report(out);
    assert_eq!(ends(&found["range"]), asked(-3, 68));
    assert_eq!((&found["parameters"]["equalise"], &found["parameters"]["reference"]), (&json!(false), &json!("right")));
    let map = pfm::read_disparities(&out.join("disparity.pfm")).unwrap();
    let truth = pfm::read(&scene("planes", "disp_right.pfm")).unwrap();
    let score = hsad::eval::score(&map, &truth, None, &[1.0]).unwrap();
    assert!(score.bad[0].of_known < 0.15 && score.coverage() == 1.0, "{score:?}");
}

#[test]
fn the_hybrid_method_takes_any_picture() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    for (width, height) in [(1, 1), (3, 1), (1, 40), (50, 30)] {
        grey_png(&path("black.png"), &Plane::filled((width, height), 0));
        grey_png(&path("noise.png"), &noise(width, height, 3));
        for (left, right) in [("black.png", "black.png"), ("black.png", "noise.png"), ("noise.png", "noise.png")] {
            let mut command = match_on_cpu(&path(left), &path(right), &path("out"));
            command.args(["--method", "kamencay"]).arg("--force").assert().success();
        }
    }
}

#[test]
fn options_of_the_other_method_are_refused() {
    let temporary = folder();
    for args in [
        &["--preset", "fast"][..],
        &["--window", "7"],
        &["--uniqueness", "1"],
        &["--max-lr-difference", "1"],
        &["--no-lr-check"],
        &["--agreement", "6"],
        &["--compare", "luma"],
        &["--fill"],
        &["--no-fill"],
        &["--interpolation", "none"],
    ] {
        let [left, right] = views("planes");
        let mut command = match_on_cpu(&left, &right, temporary.path());
        command.args(["--method", "kamencay"]).args(args);
        fails(command, 2, &format!("{} needs --method hsad: leave one of the two out", args[0]));
    }
    let [left, right] = views("planes");
    let mut command = match_on_cpu(&left, &right, temporary.path());
    command.args(["--method", "kamencay", "--disparities", "600", "--min-disparity", "-300"]);
    fails(command, 2, "belief propagation takes at most 512");
}

#[test]
fn options_without_effect_are_refused() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let whole = "these options search the whole range as it is";
    for (args, expected) in [
        (&["--whole-range", "--paths", "0"][..], whole),
        (&["--whole-range", "--cost-window", "5"], whole),
        (&["--whole-range", "--search-both-views"], whole),
        (&["--whole-range", "--window", "7"], whole),
        (&["--whole-range", "--preset", "paper"], whole),
        (&["--map-back", "--rectify", "never"], "has no map to take back"),
        (&["--filled", "--no-fill", "--focal", "300", "--baseline", "1"], "no hole is filled with these options"),
    ] {
        let mut command = match_on_cpu(&left, &right, temporary.path());
        command.args(args);
        fails(command, 2, expected);
    }
    // Of narrow pictures the whole range is searched anyway, which the options alone do not tell.
    let mut command = match_on_cpu(&left, &right, temporary.path());
    command.args(["--whole-range", "--disparities", "72"]);
    command
        .assert()
        .success()
        .stderr(contains("warning: --whole-range changes nothing: without it, too, pictures less than 1600 px"));
    let mut command = match_on_cpu(&left, &right, temporary.path());
    command.args(["--strongest", "4"]).assert().code(2).stderr(contains("--figures"));
}

#[test]
fn blocks_are_matched_by_the_costs_of_paths() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let out = temporary.path();
    match_on_cpu(&left, &right, out).args(["--paths", "0", "--cost-window", "7"]).assert().success();
    let aggregation = &report(out)["parameters"]["aggregation"];
    assert_eq!([&aggregation["paths"], &aggregation["cost_window"]], [0, 7]);
    // Without paths there are no penalties.
    assert_eq!([&aggregation["p1"], &aggregation["p2"]], [&json!(null); 2]);
}

#[test]
fn the_paper_searches_to_one_side_from_the_right_view() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let out = temporary.path();
    match_on_cpu(&left, &right, out).args(["--preset", "paper", "--figures", "--force"]).assert().success();
    let found = report(out);
    let parameters = &found["parameters"];
    assert_eq!([&parameters["reference"], &parameters["window"]], [&json!("right"), &json!(7)]);
    assert_eq!([&parameters["min_disparity"], &parameters["strongest"]], [0, 10]);
    assert_eq!((&parameters["max_lr_difference_px"], &parameters["uniqueness_percent"]), (&json!(null), &json!(0)));
    assert_eq!((&parameters["features"]["upright"], &found["range"]["source"]), (&json!(false), &json!("found")));
    assert!(found["range"]["min"].as_i64().unwrap() >= 0);
    for (name, width) in [("keypoints.png", 688), ("matches.png", 688)] {
        assert_eq!(load::load(&out.join(name)).unwrap().size(), (width, 255));
    }
    let map = pfm::read_disparities(&out.join("disparity.pfm")).unwrap();
    let truth = pfm::read(&scene("planes", "disp_right.pfm")).unwrap();
    let score = hsad::eval::score(&map, &truth, None, &[1.0]).unwrap();
    assert!(score.bad[0].of_estimated < 0.4, "{score:?}");

    // With exchanged views, all disparities are negative.
    let out = temporary.path().join("mixed-up");
    let mut command = match_on_cpu(&right, &left, &out);
    command.args(["--preset", "paper"]).assert().stderr(contains("if left and right are mixed up, exchange them"));
}

#[test]
fn depth_is_metric() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let calib = temporary.path().join("calib.txt");
    fs::write(&calib, "cam0=[300 0 169.5; 0 300 127; 0 0 1]\ndoffs=5\nbaseline=100\nwidth=340\nheight=255\n").unwrap();
    let by_file = temporary.path().join("file");
    let by_options = temporary.path().join("options");
    let range = ["--disparities", "72"];
    match_on_cpu(&left, &right, &by_file).args(range).arg("--calib").arg(&calib).assert().success();
    let mut command = match_on_cpu(&left, &right, &by_options);
    command.args(range).args(["--focal", "300", "--baseline", "0.1", "--doffs", "5"]).assert().success();
    for name in ["depth.pfm", "cloud.ply"] {
        // The middle of 340x255 pixels is the principal point above.
        assert!(fs::read(by_file.join(name)).unwrap() == fs::read(by_options.join(name)).unwrap(), "{name}");
    }
    let map = pfm::read_disparities(&by_file.join("disparity.pfm")).unwrap();
    let depth = pfm::read(&by_file.join("depth.pfm")).unwrap();
    for (&d, &z) in map.data().iter().zip(depth.data()) {
        let expected = if d == NONE { f32::INFINITY } else { 30.0 / (d as f32 / 256.0 + 5.0) };
        assert!(z == expected || (z - expected).abs() < 1e-5, "{d}: {z}, not {expected}");
    }
    assert_eq!(report(&by_file)["calibration"]["baseline_m"], 0.1);
}

#[test]
fn a_range_wider_than_the_picture_is_clipped() {
    let (temporary, [left, right]) = (folder(), views("weak"));
    let out = temporary.path();
    let mut command = match_on_cpu(&left, &right, out);
    command.args(["--min-disparity", "-1000", "--disparities", "100000"]).assert().success();
    let range = report(out)["range"].clone();
    assert_eq!(ends(&range), asked(-286, 286));
}

#[test]
fn a_range_that_misses_the_matches_is_told() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let warned = |left: &Path, right: &Path, args: &[&str], expected: &'static str| {
        let mut command = match_on_cpu(left, right, temporary.path());
        command.args(args).arg("--force").assert().success().stderr(contains("warning: ").and(contains(expected)));
    };
    warned(&left, &right, &["--min-disparity", "100", "--disparities", "50"], "leave --disparities out");
    warned(&left, &right, &["--min-disparity", "50"], "lower --min-disparity");
    warned(&right, &left, &["--disparities", "50"], "exchange them");
    warned(&right, &left, &[], "exchange them");
}

#[test]
fn pictures_without_depth_give_results_without_measured_disparities() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    grey_png(&path("black.png"), &Plane::filled((90, 70), 0));
    for seed in [1, 2] {
        grey_png(&path(&format!("noise{seed}.png")), &noise(90, 70, seed));
    }
    // Black is ambiguous everywhere; noise is unambiguous in a few places by chance.
    for (left, right, most) in [("black.png", "black.png", 0.0), ("noise1.png", "noise2.png", 0.15)] {
        let out = path("out");
        let mut command = match_on_cpu(&path(left), &path(right), &out);
        let told = contains("range could not be found").and(contains("were searched instead"));
        command.assert().code(4).stderr(told.and(contains("error: the map is not to be trusted")));
        let report = report(&out);
        assert_eq!(report["range"]["source"], "fallback");
        assert!(report["trust"].as_f64().unwrap() < 0.05, "{left}: {}", report["trust"]);
        assert!(report["measured"].as_f64().unwrap() <= most, "{left}: {}", report["measured"]);
    }
}

/// A photograph is not replaced by a result of its name, nor a mask, through a link either.
#[test]
fn what_was_read_is_not_replaced() {
    let folder = folder();
    let names = ["left.png", "right.png", "confidence.png"];
    let files = names.map(|name| folder.path().join(name));
    for (file, source) in files.iter().zip(["left.png", "right.png", "left.png"]) {
        fs::copy(scene("planes", source), file).unwrap();
    }
    let before = files.each_ref().map(|file| fs::read(file).unwrap());
    let told = || contains("would replace a file that was read: name another folder (-o)");
    let out = folder.path().join(".");
    match_on_cpu(&files[2], &files[1], &out).assert().code(1).stderr(told());
    match_on_cpu(&files[0], &files[1], &out).arg("--mask").arg(&files[2]).assert().code(1).stderr(told());
    hsad().arg("rectify").args(&files[..2]).arg("-o").arg(&out).assert().code(1).stderr(told());
    assert_eq!(files.each_ref().map(|file| fs::read(file).unwrap()), before);
    assert_eq!(crate::common::names(folder.path()), ["confidence.png", "left.png", "right.png"]);
}

#[test]
fn the_same_picture_twice_has_no_depth() {
    let (temporary, [left, _]) = (folder(), views("planes"));
    let out = temporary.path();
    let calibration = ["--focal", "300", "--baseline", "0.1"];
    let told = contains("both views are the same picture").and(contains("error: the views show no parallax"));
    match_on_cpu(&left, &left, out).args(calibration).assert().code(4).stderr(told);
    assert!(out.join("disparity.pfm").exists() && !out.join("depth.pfm").exists() && !out.join("cloud.ply").exists());
    assert_eq!((&report(out)["no_depth"], &report(out)["trust"]), (&"no parallax".into(), &0.0.into()));
    match_on_cpu(&left, &left, out).args(calibration).arg("--force").assert().success();
    assert!(out.join("depth.pfm").exists());
    let map = pfm::read_disparities(&out.join("disparity.pfm")).unwrap();
    assert!(map.data().iter().all(|&d| d == NONE || d.abs() < 256));
}

#[test]
fn a_map_that_is_not_to_be_trusted_ends_with_four() {
    let (temporary, [left, _]) = (folder(), views("planes"));
    let unrelated = temporary.path().join("unrelated.png");
    grey_png(&unrelated, &noise(340, 255, 5));
    let out = temporary.path().join("out");
    let told = contains("error: the map is not to be trusted").and(contains("--force accepts"));
    match_on_cpu(&left, &unrelated, &out).arg("-q").assert().code(4).stdout("").stderr(told);
    let found = report(&out);
    assert!(found["trust"].as_f64().unwrap() < 0.1 && found["not_trusted"].as_str().is_some(), "{found}");
    assert!(out.join("disparity.pfm").exists());
    // Confidences say the same as the trust.
    let confidence = load::load(&out.join("confidence.png")).unwrap().luma();
    assert!(confidence.data().iter().all(|&value| value < 64));
    match_on_cpu(&left, &unrelated, &out).args(["-q", "--force"]).assert().success().stdout("").stderr("");
    assert!(report(&out)["warnings"].to_string().contains("not to be trusted"));
}

#[test]
fn a_png_holds_negative_disparities_by_an_offset() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let out = temporary.path();
    let told =
        contains("lie outside the 0 to 255.996 px of a 16-bit PNG").and(contains("disparity.pfm has it as it is"));
    match_on_cpu(&right, &left, out).assert().success().stderr(told);
    let map = pfm::read_disparities(&out.join("disparity.pfm")).unwrap();
    assert_eq!(disparity_png::read(&out.join("disparity.png")).unwrap(), map);
    assert_eq!(disparities::read(&out.join("disparity.png")).unwrap(), in_pixels(&map));
    // What another program makes of the file and the report.
    let told = report(out)["disparity_png"].clone();
    let [scale, offset] = ["px_per_value", "offset_px"].map(|name| told[name].as_f64().unwrap());
    assert!(offset <= -50.0, "{told}");
    let values =
        image::load_from_memory(&fs::read(out.join("disparity.png")).unwrap()).unwrap().into_luma16().into_raw();
    for (&value, &d) in values.iter().zip(map.data()) {
        assert!(if d == NONE { value == 0 } else { f64::from(value) * scale + offset == f64::from(d) / 256.0 });
    }
}

#[test]
fn without_a_driver_the_cpu_works_and_says_so() {
    let (temporary, [left, right]) = (folder(), views("weak"));
    let out = temporary.path();
    let mut command = hsad_without_driver();
    command.arg("match").args([&left, &right]).arg("-o").arg(out);
    let told = contains("the CPU does the work").and(contains("mesa-vulkan-drivers"));
    command.assert().success().stdout(contains("CPU twins")).stderr(told);
    assert_eq!(report(out)["device"]["backend"], "none");
}

#[test]
fn other_kinds_of_pictures_are_read() {
    let temporary = folder();
    let luma = load::load(&scene("weak", "left.png")).unwrap().luma();
    let Size { width, height } = luma.size();
    let deep = image::ImageBuffer::from_fn(width, height, |x, y| image::Luma([u16::from(luma.get(x, y)) * 257]));
    let alpha = image::ImageBuffer::from_fn(width, height, |x, y| image::LumaA([luma.get(x, y), x as u8 | 1]));
    let [deep_path, alpha_path] = ["deep.png", "alpha.png"].map(|name| temporary.path().join(name));
    deep.write_with_encoder(PngEncoder::new(fs::File::create(&deep_path).unwrap())).unwrap();
    alpha.write_with_encoder(PngEncoder::new(fs::File::create(&alpha_path).unwrap())).unwrap();
    // Both files decode to the same grey values.
    match_on_cpu(&deep_path, &alpha_path, temporary.path()).assert().code(4).stderr(contains("the same picture"));
}

/// A pair that the twins take a minute for, and the arguments of a match of it that leaves its results in `out`.
#[cfg(unix)]
pub fn endless(folder: &Path, out: &Path) -> Vec<std::ffi::OsString> {
    let [left, right] = ["left.png", "right.png"].map(|name| folder.join(name));
    for path in [&left, &right] {
        grey_png(path, &noise(1500, 1300, 3));
    }
    let options = ["match", "--device", "cpu", "--disparities", "1000", "--force", "--quiet", "-o"];
    options.iter().map(Into::into).chain([out, &left, &right].map(Into::into)).collect()
}

#[cfg(unix)]
#[test]
fn nothing_is_left_after_an_interruption() {
    let folder = folder();
    let out = folder.path().join("out/new");
    let arguments = endless(folder.path(), &out);
    for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP] {
        let mut run = Run::start(&arguments, &[]);
        run.wait_for(&out);
        run.signal(signal);
        assert_eq!(run.exit_code(), Some(130), "signal {signal}");
        assert!(!folder.path().join("out").exists(), "a folder is left by signal {signal}");
    }
}

#[cfg(unix)]
#[test]
fn a_signal_that_the_parent_ignores_stays_ignored() {
    let folder = folder();
    let out = folder.path().join("out/new");
    let mut run = Run::start(endless(folder.path(), &out), &[libc::SIGINT, libc::SIGHUP]);
    run.wait_for(&out);
    for signal in [libc::SIGINT, libc::SIGHUP] {
        run.signal(signal);
        run.stays();
    }
    run.signal(libc::SIGTERM);
    assert_eq!(run.exit_code(), Some(130));
    assert!(!folder.path().join("out").exists(), "a folder is left");
}
