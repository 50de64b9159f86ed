//! `hsad tune`.

use std::{env, fs, path::Path};

use assert_cmd::Command;
use hsad::gpu::{SgmPlan, Shapes};
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;

use crate::common::{folder, hsad, names};

const SMALL: [&str; 8] = ["--size", "64x48", "--disparities", "32", "--runs", "5", "--seconds", "900"];

/// The program with the user's cache in `cache`; the driver keeps its own cache where it is.
fn hsad_with(cache: &Path) -> Command {
    let mut command = hsad();
    if let Some(drivers) = env::var_os("MESA_SHADER_CACHE_DIR").or_else(|| env::var_os("HOME")) {
        command.env("MESA_SHADER_CACHE_DIR", drivers);
    }
    command.env("XDG_CACHE_HOME", cache);
    command
}

/// The shapes that `hsad bench` measures.
fn shapes_of(cache: &Path) -> String {
    let args =
        ["bench", "--preset", "balanced", "--size", "40x30", "--disparities", "16", "--runs", "1", "--json", "-"];
    let output = hsad_with(cache).args(args).assert().success().get_output().stdout.clone();
    let report: Value = serde_json::from_slice(&output).expect("JSON");
    report["shapes"].as_str().expect("the shapes").into()
}

#[test]
fn the_choice_is_kept_for_later_runs_until_it_is_forgotten() {
    let cache = folder();
    let before = shapes_of(cache.path());
    let output = hsad_with(cache.path()).arg("tune").args(SMALL).args(["--json", "-"]).assert().success().stderr("");
    let report: Value = serde_json::from_slice(&output.get_output().stdout).expect("JSON");
    let parts = report["parts"].as_array().expect("parts");
    let candidates = parts[4]["candidates"].as_array().expect("candidates");
    assert_eq!((parts.len(), candidates.len()), (5, 25), "{report:#}");
    for part in parts {
        let chosen =
            part["candidates"].as_array().unwrap().iter().find(|candidate| candidate["name"] == part["chosen"]);
        assert!(chosen.is_some_and(|chosen| chosen["ms"].as_f64().is_some_and(|time| time > 0.0)), "{part:#}");
        let of_default = |candidate: &Value| candidate["of_default"].as_f64().expect("a ratio");
        assert!(chosen.is_some_and(|chosen| of_default(chosen) <= 1.0), "{part:#}");
    }
    let kept = report["shapes"].as_str().expect("the shapes");
    assert_eq!(shapes_of(cache.path()), kept);

    // What is kept decides, whatever it is.
    let file = names(&cache.path().join("hsad")).into_iter().find(|name| name.ends_with(".shapes")).expect("a file");
    let file = cache.path().join("hsad").join(file);
    let text = fs::read_to_string(&file).unwrap();
    let shapes: Shapes = kept.parse().unwrap();
    let sgm = if shapes.sgm == SgmPlan::Lines { SgmPlan::Lanes } else { SgmPlan::Lines };
    let other = Shapes { sgm, ..shapes }.to_string();
    fs::write(&file, text.replace(kept, &other)).unwrap();
    assert_eq!(shapes_of(cache.path()), other);
    // Another driver's are not taken.
    fs::write(&file, format!("another driver{text}")).unwrap();
    assert_eq!(shapes_of(cache.path()), before);

    let forgotten =
        |said: &str| hsad_with(cache.path()).args(["tune", "--forget"]).assert().success().stdout(contains(said));
    forgotten("forgotten: ");
    assert!(!file.exists());
    forgotten("nothing was kept: ");
}

#[test]
fn what_cannot_be_measured_is_told() {
    let cache = folder();
    let tune = |args: &[&str]| hsad_with(cache.path()).arg("tune").args(args).assert();
    tune(&["--size", "99999x1"]).code(2).stdout("").stderr(contains("1 to 4096 px"));
    tune(&["--disparities", "0"]).code(2).stdout("");
    tune(&["--runs", "4"]).code(2).stdout("").stderr(contains("5..=10000"));
    tune(&["--forget", "--runs", "7"]).code(2).stderr(contains("cannot be used with"));
    tune(&["--device", "cpu"]).code(1).stderr(contains("hsad tune times the kernels of a device"));
    tune(&["--json", "/nonexistent/figures.json"]).code(1).stderr(contains("figures.json").and(contains("error: ")));
    let mut homeless = hsad();
    homeless.env_remove("XDG_CACHE_HOME").env_remove("LOCALAPPDATA").env("HOME", "here").arg("tune").args(SMALL);
    homeless.assert().code(1).stderr(contains("set HOME, XDG_CACHE_HOME or LOCALAPPDATA"));
}
