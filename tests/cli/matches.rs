//! Matches of interest points as CSV: `hsad match --matches` and `hsad features FIRST SECOND`.

use std::{collections::HashMap, fs, path::Path};

use hsad::io::{load, pfm};
use predicates::str::contains;

use crate::common::{fails, folder, hsad, match_on_cpu, names, report, scene, views};

/// The lines of a table, by the names of its columns.
fn rows(table: &str) -> Vec<HashMap<&str, f64>> {
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines.map(|line| names.iter().copied().zip(line.split(',').map(|value| value.parse().unwrap())).collect()).collect()
}

/// Runs `hsad features` for both views of `planes`; returns standard output and error.
fn features(args: &[&str]) -> (String, String) {
    let mut command = hsad();
    let output = command.arg("features").args(views("planes")).args(["--device", "cpu"]).args(args).output().unwrap();
    assert!(output.status.success());
    (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn the_matches_of_a_pair_are_a_table() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let out = temporary.path().join("out");
    match_on_cpu(&left, &right, &out).args(["--matches", "--disparities", "72"]).assert().success();
    assert!(names(&out).contains(&"matches.csv".into()) && report(&out)["files"].to_string().contains("matches.csv"));
    let text = fs::read_to_string(out.join("matches.csv")).unwrap();
    let table = rows(&text);
    assert!(table.len() > 200, "{}", table.len());
    let truth = pfm::read(&scene("planes", "disp_left.pfm")).unwrap();
    let mut right_ones = 0;
    for row in &table {
        let [x1, y1, x2, y2] = ["x1", "y1", "x2", "y2"].map(|name| row[name]);
        assert_eq!(row["agrees"] == 1.0, (y1 - y2).abs() <= 1.5, "rows of the scene correspond: {row:?}");
        assert!(row["scale1"] > 1.0 && row["scale2"] > 1.0 && row["orientation1"] == 0.0 && row["orientation2"] == 0.0);
        assert!(row["ratio"] <= 0.8501 && (row["ratio"] + row["confidence"] - 1.0).abs() < 1e-5);
        assert!((0.0..2.0).contains(&row["distance"]));
        let disparity = f64::from(truth.get(x1.round() as u32, y1.round() as u32));
        right_ones += usize::from(row["agrees"] == 1.0 && (x1 - x2 - disparity).abs() < 3.0);
    }
    assert!(right_ones as f64 > 0.8 * table.len() as f64, "{right_ones} of {}", table.len());
    assert!(table.is_sorted_by(|a, b| a["confidence"] >= b["confidence"]));
    // The columns are those of another program's matches.
    let mut command = hsad();
    command.args(["eval", "features"]).arg(scene("planes", "")).arg("--matches").arg(out.join("matches.csv"));
    command.assert().success().stdout(contains(table.len().to_string()));
    // Two pictures have the same matches without a map.
    let (printed, note) = features(&[]);
    assert_eq!(printed, text);
    let agreeing = table.iter().filter(|row| row["agrees"] == 1.0).count();
    assert!(note.starts_with(&format!("{} matches, {agreeing} of them in corresponding rows", table.len())), "{note}");
}

#[test]
fn the_matches_of_two_pictures_go_to_a_folder() {
    let temporary = folder();
    let out = temporary.path().join("out");
    let (printed, note) = features(&["-q", "--ratio", "0.6"]);
    assert!(note.is_empty() && rows(&printed).iter().all(|row| row["ratio"] <= 0.6001));
    let (told, note) = features(&["--ratio", "0.6", "-o", out.to_str().unwrap()]);
    assert!(told.contains(" matches, ") && told.contains("out") && note.is_empty(), "{told} {note}");
    assert_eq!(names(&out), ["matches.csv", "matches.png", "report.json"]);
    assert_eq!(fs::read_to_string(out.join("matches.csv")).unwrap(), printed);
    assert_eq!(load::load(&out.join("matches.png")).unwrap().size(), (688, 255));
}

#[test]
fn what_two_pictures_do_not_have_is_refused() {
    let left = scene("planes", "left.png");
    for args in [&["--ratio", "0.5"][..], &["right.png", "--descriptors"]] {
        hsad().arg("features").arg(&left).args(args).assert().code(2);
    }
    let mut command = hsad();
    command.arg("features").args([&left, &left]).args(["--ratio", "0"]);
    fails(command, 2, "ratio is 0");
    let mut command = hsad();
    command.arg("features").args([&left, Path::new("nowhere.png")]);
    fails(command, 1, "nowhere.png");
}
