//! Helpers shared by the tests of all subcommands.

use std::{
    fs,
    path::{Path, PathBuf},
};

use assert_cmd::Command;
use hsad::{glam::DVec3, image::Plane, io::png};
use serde_json::Value;
use tempfile::TempDir;

/// The program.
pub fn hsad() -> Command {
    let mut command = assert_cmd::cargo::cargo_bin_cmd!("hsad");
    command.env_remove("RUST_LOG");
    command
}

/// The program on a machine without any GPU driver.
pub fn hsad_without_driver() -> Command {
    let mut command = hsad();
    command.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent");
    command
}

/// `hsad match LEFT RIGHT -o FOLDER` on the CPU.
pub fn match_on_cpu(left: &Path, right: &Path, folder: &Path) -> Command {
    let mut command = hsad();
    command.arg("match").arg(left).arg(right).arg("-o").arg(folder).args(["--device", "cpu"]);
    command
}

/// A file of a shipped scene.
pub fn scene(name: &str, file: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "data", name, file].iter().collect()
}

/// Left and right view of a shipped scene.
pub fn views(name: &str) -> [PathBuf; 2] {
    ["left.png", "right.png"].map(|file| scene(name, file))
}

/// A folder for a test's files.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Writes a grey PNG.
pub fn grey_png(path: &Path, picture: &Plane<u8>) {
    let mut bytes = Vec::new();
    png::write_grey8(&mut bytes, picture).expect("a PNG in memory");
    fs::write(path, bytes).expect("a file in a temporary folder");
}

/// Random grey values, different for each `seed`.
pub fn noise(width: u32, height: u32, seed: u32) -> Plane<u8> {
    let mut state = seed;
    Plane::from_fn((width, height), |_, _| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    })
}

/// The files of `hsad rectify`.
pub const RECTIFIED: [&str; 8] = [
    "epipolar-lines.png",
    "left-mask.png",
    "left.png",
    "rectification.json",
    "rectification.yml",
    "report.json",
    "right-mask.png",
    "right.png",
];

/// The names in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("the folder is there")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"))
        .collect();
    names.sort();
    names
}

/// `report.json` of a folder.
pub fn report(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("report.json")).expect("report.json");
    serde_json::from_str(&text).expect("JSON")
}

/// Runs `command`, which must end with `code`, nothing on stdout, and one line on stderr that contains `expected`.
#[track_caller]
pub fn fails(mut command: Command, code: i32, expected: &str) {
    let output = command.output().expect("the program starts");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
    assert!(stderr.starts_with("error: ") && stderr.ends_with('\n'), "{stderr:?}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    assert!(stderr.contains(expected), "'{expected}' is not in: {stderr}");
}

/// Positions of the points of `cloud.ply` of a folder, in metres.
pub fn cloud(out: &Path) -> Vec<DVec3> {
    let bytes = fs::read(out.join("cloud.ply")).unwrap();
    let end = b"end_header\n";
    let start = bytes.windows(end.len()).position(|window| window == end).unwrap() + end.len();
    let number = |bytes: &[u8]| f64::from(f32::from_le_bytes(bytes.try_into().unwrap()));
    bytes[start..].chunks_exact(15).map(|p| DVec3::new(number(&p[..4]), number(&p[4..8]), number(&p[8..12]))).collect()
}
