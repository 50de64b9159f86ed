//! `hsad devices`.

use std::process::{Command, Stdio};

use predicates::{prelude::PredicateBooleanExt, str::contains};

use crate::common::{hsad, hsad_without_driver};

#[test]
fn lists_adapters_and_the_cpu() {
    let adapters = hsad::gpu::block_on(hsad::gpu::list_adapters());
    let output = hsad().arg("devices").assert().success().get_output().stdout.clone();
    let text = String::from_utf8(output).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), adapters.len() + 2);
    assert!(lines[0].starts_with("index  name"));
    for ((index, info), line) in adapters.iter().enumerate().zip(&lines[1..]) {
        assert!(line.starts_with(&format!("{index} ")) && line.contains(&info.name), "{line}");
    }
    assert!(lines[lines.len() - 1].starts_with("cpu "));
}

#[test]
fn without_a_driver_tells_how_to_get_one() {
    let told = contains("no GPU adapter was found").and(contains("apt-get install mesa-vulkan-drivers"));
    hsad_without_driver().arg("devices").assert().success().stdout(contains("\ncpu ")).stderr(told);
}

#[test]
fn nothing_is_said_where_there_is_no_desktop() {
    hsad().arg("devices").env_remove("XDG_RUNTIME_DIR").env("VK_LOADER_DEBUG", "none").assert().success().stderr("");
}

#[test]
fn a_closed_pipe_is_no_failure() {
    // The reader closes the pipe before anything is printed.
    let mut child = Command::new(assert_cmd::cargo::cargo_bin!("hsad"))
        .args(["features", concat!(env!("CARGO_MANIFEST_DIR"), "/data/planes/left.png"), "--device", "cpu", "-q"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}
