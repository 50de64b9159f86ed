//! `hsad verify`.

use std::{fs, path::Path};

use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;

use crate::common::{fails, folder, hsad, hsad_without_driver, names, scene};

#[test]
fn one_case_as_a_table_and_as_json() {
    let temporary = folder();
    let file = temporary.path().join("report.json");
    let mut command = hsad();
    command.current_dir(temporary.path()).args(["verify", "--only", "census", "--only", "pad"]);
    command.args(["--size", "17x13", "--seed", "4", "--json"]).arg(&file);
    let table = contains("census               17x13       4  none").and(contains("all 2 cases pass"));
    command.assert().success().stdout(table).stderr("");
    // No case failed, so no arrays are written.
    assert_eq!(names(temporary.path()), ["report.json"]);

    let report: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    assert_eq!((&report["planned"], &report["failed"]), (&2.into(), &0.into()));
    let case = &report["cases"][1];
    assert_eq!((&case["kernel"], &case["width"], &case["seed"]), (&"census".into(), &17.into(), &4.into()));
    assert_eq!(case["command"], "hsad verify --only census --size 17x13 --seed 4");
    assert_eq!(case["arrays"][0]["values"], 2 * 17 * 13);
    assert_eq!((&case["passes"], &case["golden"]), (&true.into(), &true.into()));
}

#[test]
fn json_instead_of_the_table() {
    let output = hsad().args(["verify", "--only", "pad", "--json", "-"]).assert().success().get_output().stdout.clone();
    let report: Value = serde_json::from_slice(&output).unwrap();
    assert_eq!(report["cases"].as_array().unwrap().len(), 8);
}

#[test]
fn what_cannot_be_verified_is_told() {
    hsad().args(["verify", "--only", "nonsense"]).assert().code(2).stderr(contains("there are luma"));
    hsad().args(["verify", "--size", "17"]).assert().code(2).stderr(contains("as in 311x239"));
    hsad().args(["verify", "--size", "5000x2"]).assert().code(2).stderr(contains("1 to 4096 px"));
    hsad()
        .args(["verify", "--device", "cpu"])
        .assert()
        .code(1)
        .stderr(contains("the CPU twins are no GPU: they are what hsad verify compares a device with"));
}

/// `hsad verify` needs a device, so the message does not offer the CPU.
#[test]
fn without_a_driver_the_cpu_is_offered_to_those_who_can_use_it() {
    let told = || contains("no GPU adapter was found").and(contains("apt-get install mesa-vulkan-drivers"));
    let cpu = || contains("--device cpu");
    hsad_without_driver().arg("verify").assert().code(1).stderr(told().and(cpu().not()));
    let mut command = hsad_without_driver();
    command.args(["features", "--device", "0"]).arg(scene("weak", "left.png"));
    command.assert().code(1).stderr(told().and(cpu()));
}

/// The check comes before the first case.
#[test]
fn what_cannot_be_written_is_told_at_once() {
    let temporary = folder();
    let file = temporary.path().join("file");
    fs::write(&file, "mine").unwrap();
    let verify = |option: &str, path: &Path| {
        let mut command = hsad();
        command.current_dir(temporary.path()).args(["verify", "--only", "pad", option]).arg(path);
        command
    };
    fails(verify("-o", &file), 1, "name another folder");
    fails(verify("-o", &file.join("below")), 1, "name another folder");
    fails(verify("--json", &temporary.path().join("missing/report.json")), 1, "name another one");
    fails(verify("--json", temporary.path()), 1, "name another one");
    assert_eq!(names(temporary.path()), ["file"]);
}

#[test]
fn a_device_is_tested_before_it_is_used() {
    hsad().args(["features", "--self-test", "-q"]).arg(scene("weak", "left.png")).assert().success().stderr("");
}
