//! `hsad man`.

use std::{fs, process::Command};

use crate::common::{fails, folder, hsad, names};

#[test]
fn the_page_of_the_program_is_printed() {
    let output = hsad().arg("man").assert().success().stderr("").get_output().stdout.clone();
    let page = String::from_utf8(output).unwrap();
    assert!(page.contains(".TH hsad 1"), "{page}");
    for part in ["SYNOPSIS", "hsad\\-match(1)", "Exit codes:", "not rectified"] {
        assert!(page.contains(part), "{part} is not in:\n{page}");
    }
}

#[test]
fn a_folder_gets_a_page_per_command() {
    let folder = folder();
    let out = folder.path().join("share/man1");
    hsad().arg("man").arg(&out).assert().success().stdout("").stderr("");
    let commands = ["completions", "demo", "devices", "eval", "eval-dense", "eval-features", "eval-paper", "features"];
    let mut expected: Vec<String> = commands
        .iter()
        .chain(&["batch", "bench", "man", "match", "rectify", "tune", "verify"])
        .map(|name| format!("hsad-{name}.1"))
        .collect();
    expected.push("hsad.1".into());
    expected.sort();
    assert_eq!(names(&out), expected);
    let page = fs::read_to_string(out.join("hsad-match.1")).unwrap();
    for part in [".TH hsad-match 1", "\\-\\-cost\\-window", "Examples:", "hsad match left.png right.png \\-o out"] {
        assert!(page.contains(part), "{part} is not in:\n{page}");
    }

    // Pages of an older version give way.
    fs::write(out.join("hsad.1"), "old").unwrap();
    hsad().arg("man").arg(&out).assert().success();
    assert_ne!(fs::read(out.join("hsad.1")).unwrap(), b"old");
}

/// groff, where it is installed, has nothing to complain about.
#[test]
fn pages_are_valid_roff() {
    let folder = folder();
    hsad().arg("man").arg(folder.path()).assert().success();
    for name in names(folder.path()) {
        let page = folder.path().join(&name);
        let Ok(output) = Command::new("groff").args(["-man", "-Tutf8", "-ww", "-z"]).arg(page).output() else { return };
        assert!(
            output.status.success() && output.stderr.is_empty(),
            "{name}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}

#[test]
fn what_is_no_folder_is_told_and_stays() {
    let folder = folder();
    let file = folder.path().join("file");
    fs::write(&file, "mine").unwrap();
    let mut command = hsad();
    command.arg("man").arg(&file);
    fails(command, 1, "the results need a folder");
    assert_eq!(fs::read(&file).unwrap(), b"mine");

    // One page cannot take its place: none appears.
    let out = folder.path().join("out");
    fs::create_dir_all(out.join("hsad-match.1")).unwrap();
    let mut command = hsad();
    command.arg("man").arg(&out);
    fails(command, 1, "hsad-match.1");
    assert_eq!(names(&out), ["hsad-match.1"]);
}
