//! `hsad features`.

use std::fs;

use hsad::{image::Plane, io::load};
use predicates::{prelude::PredicateBooleanExt, str::contains};

use crate::common::{folder, grey_png, hsad, hsad_without_driver, names, noise, scene};

const HEADER: &str = "x,y,scale,orientation,response,dark";

/// Runs `hsad features` with these arguments; returns the CSV on stdout and the text on stderr.
fn printed(args: &[&str]) -> (Vec<Vec<f64>>, String) {
    let output = hsad().arg("features").arg(scene("planes", "left.png")).args(args).output().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let mut lines = text.lines();
    assert!(lines.next().unwrap().starts_with(HEADER));
    let rows = lines.map(|line| line.split(',').map(|value| value.parse().unwrap()).collect()).collect();
    (rows, String::from_utf8(output.stderr).unwrap())
}

#[test]
fn csv_goes_to_stdout_and_the_number_to_stderr() {
    let (rows, stderr) = printed(&["--device", "cpu"]);
    assert!(rows.len() > 100);
    assert!(stderr.starts_with(&format!("{} interest points", rows.len())), "{stderr}");
    for row in &rows {
        let [x, y, scale, orientation, response, dark] = row[..] else { panic!("{row:?}") };
        assert!((0.0..340.0).contains(&x) && (0.0..255.0).contains(&y) && scale > 1.0);
        assert!(orientation == 0.0 && response > 0.0 && (dark == 0.0 || dark == 1.0));
    }
    assert_eq!(printed(&["--device", "cpu", "-q"]), (rows, String::new()));
}

#[test]
fn descriptors_have_unit_length_and_orientations_differ() {
    let (rows, _) = printed(&["--device", "cpu", "--descriptors", "--oriented"]);
    assert!(rows.iter().any(|row| row[3] != 0.0));
    for row in rows {
        assert_eq!(row.len(), 70);
        assert!((row[6..].iter().map(|value| value * value).sum::<f64>() - 1.0).abs() < 1e-4);
    }
}

#[test]
fn a_higher_threshold_finds_fewer() {
    let count = |threshold: &str| printed(&["--device", "cpu", "-q", "--threshold", threshold]).0.len();
    assert!(count("0.01") < count("0.001"));
}

#[test]
fn a_file_without_its_end_is_told_and_one_without_its_pixels_refused() {
    let temporary = folder();
    let path = temporary.path().join("cut.png");
    let whole = fs::read(scene("planes", "left.png")).unwrap();
    let features = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let mut command = hsad();
        command.arg("features").arg(&path).args(["--device", "cpu"]);
        command.assert()
    };
    let told = contains("cut.png: the PNG has no end chunk, but all of its picture");
    features(&whole[..whole.len() - 12]).success().stderr(told);
    features(&whole[..whole.len() - 13]).code(1).stdout("").stderr(contains("cut.png: the picture is cut off"));
}

#[test]
fn files_go_to_the_folder() {
    let temporary = folder();
    let out = temporary.path().join("out");
    let mut command = hsad();
    command.arg("features").arg(scene("planes", "left.png")).arg("-o").arg(&out).args(["--device", "cpu"]);
    command.assert().success().stdout(contains("interest points").and(contains("out"))).stderr("");
    assert_eq!(names(&out), ["features.csv", "keypoints.png", "report.json"]);
    assert!(fs::read_to_string(out.join("features.csv")).unwrap().starts_with(HEADER));
    assert_eq!(load::load(&out.join("keypoints.png")).unwrap().size(), (340, 255));
}

#[test]
fn without_a_driver_the_cpu_works_and_says_so() {
    let mut command = hsad_without_driver();
    command.arg("features").arg(scene("weak", "left.png"));
    command.assert().success().stdout(contains(HEADER)).stderr(contains("warning: the CPU does the work"));
}

#[test]
fn the_cpu_in_place_of_a_device_is_told_once_even_if_quiet() {
    let temporary = folder();
    let mut command = hsad_without_driver();
    command.arg("features").arg(scene("weak", "left.png")).arg("-o").arg(temporary.path().join("out")).arg("-q");
    let output = command.output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && output.stdout.is_empty(), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    assert!(
        stderr.contains("the CPU does the work") && stderr.contains("apt-get install mesa-vulkan-drivers"),
        "{stderr}"
    );
    let mut command = hsad();
    command.arg("features").arg(scene("weak", "left.png")).args(["-q", "--device", "cpu"]);
    command.assert().success().stderr("");
}

#[test]
fn of_too_many_points_the_strongest_are_kept_and_told() {
    let (all, _) = printed(&["--device", "cpu", "-q"]);
    let (kept, note) = printed(&["--device", "cpu", "--max-features", "50"]);
    assert_eq!(kept.len(), 50);
    assert!(note.contains(&format!("50 interest points, the strongest of {},", all.len())), "{note}");
    assert!(all.iter().filter(|point| kept.contains(point)).eq(&kept), "some of all points, in their order");
    // They are spread: each quarter of the picture has some.
    for (right, low) in [(false, false), (false, true), (true, false), (true, true)] {
        let within = |point: &&Vec<f64>| (point[0] > 170.0) == right && (point[1] > 127.0) == low;
        assert!(kept.iter().filter(within).count() >= 3, "{right} {low}");
    }
}

#[test]
fn large_pictures_are_reduced_unless_told_otherwise() {
    let folder = folder();
    let path = folder.path().join("large.png");
    // Blobs of 16 px, which are detected at full and at reduced size.
    let blobs = noise(125, 75, 5);
    grey_png(&path, &Plane::from_fn((2000, 1200), |x, y| blobs.get(x / 16, y / 16)));
    let run = |option: &[&str]| {
        let mut command = hsad();
        command.arg("features").arg(&path).args(option).args(["--device", "cpu", "--upright"]);
        let output = command.output().unwrap();
        assert!(output.status.success());
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let (table, note) = run(&[]);
    assert!(note.contains("interest points at 1/2 of its size"), "{note}");
    // Positions are in pixels of the full-size picture in both cases.
    let columns = table.lines().skip(1).map(|line| line.split(',').next().unwrap().parse::<f32>().unwrap());
    assert!(columns.fold(0.0, f32::max) > 1500.0);
    let (_, note) = run(&["--full-size", "--octaves", "1"]);
    assert!(!note.contains("of its size"), "{note}");
}
