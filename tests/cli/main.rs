//! Tests of the program as a process: its files, output and exit codes.

#![cfg(feature = "cli")]

mod bad_input;
mod batch;
mod bench;
mod calibrated;
mod calibrations;
mod clouds;
mod common;
mod completions;
mod deep_pictures;
mod demo;
mod devices;
mod eval_dense;
mod eval_features;
mod eval_paper;
#[path = "../exif/mod.rs"]
mod exif;
mod features;
#[cfg(target_os = "linux")]
mod inputs;
#[cfg(unix)]
mod interruption;
#[cfg(target_os = "linux")]
mod limits;
mod man;
mod match_views;
mod matches;
mod mosaics;
mod one_file;
#[path = "../pictures/mod.rs"]
mod pictures;
mod pipeline_cache;
mod recordings;
mod rectify;
mod sets;
mod tune;
mod verify;

use common::hsad;
use predicates::{prelude::PredicateBooleanExt, str::contains};

#[test]
fn help_has_examples_and_exit_codes() {
    hsad()
        .arg("--help")
        .assert()
        .success()
        .stdout(contains("Exit codes:").and(contains("3  the pair is not rectified")));
    for command in [
        &["match"][..],
        &["rectify"],
        &["features"],
        &["devices"],
        &["demo"],
        &["verify"],
        &["bench"],
        &["completions"],
        &["man"],
        &["eval", "dense"],
        &["eval", "features"],
        &["eval", "paper"],
    ] {
        hsad().args(command).arg("--help").assert().success().stdout(contains("Examples:").and(contains("Usage:")));
    }
    hsad().arg("-V").assert().success().stdout(format!("hsad {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn usage_errors_are_two() {
    for args in [&[][..], &["match"], &["match", "a", "b"], &["nonsense"], &["demo", "--window", "7"]] {
        hsad().args(args).assert().code(2);
    }
    let out = ["match", "a", "b", "-o", "out"];
    for args in [
        &["--window", "abc"][..],
        &["--window", "7", "--paths", "4"],
        &["--window", "7", "--cost-window", "7"],
        &["--paths", "5"],
        &["--no-lr-check", "--max-lr-difference", "1"],
        &["--fill", "--no-fill"],
        &["--oriented", "--upright"],
        &["--focal", "700"],
        &["--calib", "c", "--focal", "700", "--baseline", "0.1"],
        &["--preset", "best"],
        &["--side-by-side", "left-right"],
        &["--filled", "--min-confidence", "99"],
        &["--min-confidence", "256"],
    ] {
        hsad().args(out).args(args).assert().code(2).stderr(contains("error: "));
    }
}
