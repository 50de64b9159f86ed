//! `hsad bench`.

use std::fs;

use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;

use crate::common::{folder, hsad};

const SMALL: [&str; 9] = ["bench", "--preset", "balanced", "--size", "64x48", "--disparities", "32", "--runs", "2"];

#[test]
fn a_table_and_json_that_a_later_run_is_compared_with() {
    let temporary = folder();
    let file = temporary.path().join("figures.json");
    let told =
        contains("balanced 64x48 32: first ").and(contains("\n  path  ")).and(contains("Mpd/s")).and(contains("GB/s"));
    hsad().args(SMALL).args(["--plan", "lines", "--json"]).arg(&file).assert().success().stdout(told).stderr("");
    let report: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    let case = &report["cases"][0];
    assert_eq!((&report["plan"], &case["preset"], &case["width"]), (&"lines".into(), &"balanced".into(), &64.into()));
    let kernels = case["kernels"].as_array().unwrap();
    let named = |name: &str| kernels.iter().find(|kernel| kernel["name"] == name);
    assert_eq!(named("path").unwrap()["dispatches"], 2);
    // The path along the rows has the fewest threads, one per row; costs and path costs are read or written once per path, and 8
    // bytes per pixel.
    let (threads, bytes) = (&named("path").unwrap()["threads"], &named("path").unwrap()["bytes"]);
    assert_eq!((threads, bytes), (&48.into(), &(2 * 64 * 48 * (2 * 32 + 8)).into()));
    assert_eq!(named("path").unwrap()["operations"], 2 * 64 * 48 * 32 * 7);
    assert!(named("path").unwrap()["of_integers"].as_f64().is_some_and(|share| share > 0.0));
    assert!(named("path").unwrap()["of_copies"].as_f64().is_some_and(|share| share > 0.0));
    assert!(
        report["copied_bytes_per_s"].as_f64().unwrap() > 1e8
            && report["integer_operations_per_s"].as_f64().unwrap() > 1e8
    );
    // Millions of pixels times disparities per second, from the median in milliseconds.
    let rate = 64.0 * 48.0 * 32.0 / 1e3 / case["median_ms"].as_f64().unwrap();
    assert!((case["mpd_per_s"].as_f64().unwrap() / rate - 1.0).abs() < 1e-9);

    let mut command = hsad();
    command.args(SMALL).args(["--plan", "lines", "--json", "-", "--compare"]).arg(&file);
    let again: Value = serde_json::from_slice(&command.assert().success().get_output().stdout).unwrap();
    assert_eq!(again["cases"][0]["earlier_median_ms"], case["median_ms"]);

    let compared = contains("of the earlier median").and(contains("  lane_path                    1 "));
    hsad().args(SMALL).args(["--plan", "lanes", "--compare"]).arg(&file).assert().success().stdout(compared);
}

#[test]
fn what_cannot_be_measured_is_told() {
    let temporary = folder();
    let file = temporary.path().join("text.json");
    fs::write(&file, "{}").unwrap();
    hsad().args(SMALL).arg("--compare").arg(&file).assert().code(1).stderr(contains("no figures of hsad bench --json"));
    hsad()
        .args(SMALL)
        .args(["--compare", "absent.json"])
        .assert()
        .code(1)
        .stderr(contains("absent.json: No such file"));
    hsad().args(["bench", "--size", "99999x1"]).assert().code(2).stdout("").stderr(contains("1 to 4096 px"));
    hsad().args(["bench", "--runs", "0"]).assert().code(2).stderr(contains("1..=10000"));
    hsad().args(["bench", "--disparities", "0"]).assert().code(2);
    hsad()
        .args(["bench", "--device", "cpu"])
        .assert()
        .code(1)
        .stderr(contains("hsad bench times the kernels of a device"));
    // Told before anything is measured.
    fs::write(&file, r#"{"cases":[{"preset":"fast","width":64,"height":48,"disparities":32,"median_ms":1.5}]}"#)
        .unwrap();
    let told = contains("has no case of this run").and(contains("it has fast 64x48 32 ("));
    hsad().args(SMALL).arg("--compare").arg(&file).assert().code(1).stdout("").stderr(told);
    let mut onto_itself = hsad();
    onto_itself.args(["bench", "--preset", "fast", "--size", "64x48", "--disparities", "32", "--json"]).arg(&file);
    let told = contains("it would replace a file that is read");
    onto_itself.arg("--compare").arg(&file).assert().code(1).stdout("").stderr(told);
}
