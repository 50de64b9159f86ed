//! Bad input ends with one line on stderr, an exit code, and no file.

use std::{fs, path::Path};

use assert_cmd::Command;
use hsad::image::Plane;

use crate::{
    common::{fails, folder, grey_png, hsad, hsad_without_driver, match_on_cpu, names, noise, scene, views},
    pictures::cmyk_tiff,
};

/// Runs `hsad match` on two files, which must fail and write nothing.
#[track_caller]
fn pair_fails(left: &Path, right: &Path, args: &[&str], code: i32, expected: &str) {
    let temporary = folder();
    let mut command = match_on_cpu(left, right, &temporary.path().join("new/out"));
    command.args(args);
    fails(command, code, expected);
    assert_eq!(names(temporary.path()), [""; 0]);
}

#[test]
fn files_that_are_no_pictures() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let bytes = fs::read(&left).unwrap();
    let contents: [(&str, &[u8], &str); 7] = [
        ("empty.png", b"", "the file is empty"),
        ("cut.png", &bytes[..bytes.len() / 2], "cut.png: "),
        ("text.png", b"this is text, and long enough to be looked at", "PNG, JPEG, PNM, BMP, TIFF and WebP"),
        (
            "photo.heic",
            b"\0\0\0\x18ftypheic\0\0\0\0mif1heic",
            "the format HEIC, which is not read: convert it to PNG or JPEG",
        ),
        ("photo.avif", b"\0\0\0\x1cftypavif\0\0\0\0avifmif1miaf", "the format AVIF, which is not read: convert it"),
        ("cmyk.tiff", &cmyk_tiff(), "CMYK: convert it"),
        ("line\nfeed.png", b"text", r"line\nfeed.png: "),
    ];
    for (name, content, expected) in contents {
        let path = temporary.path().join(name);
        fs::write(&path, content).unwrap();
        pair_fails(&path, &right, &[], 1, expected);
        pair_fails(&left, &path, &[], 1, expected);
        let mut command = hsad();
        command.arg("features").arg(&path).args(["--device", "cpu"]);
        fails(command, 1, expected);
    }
    pair_fails(&temporary.path().join("missing.png"), &right, &[], 1, "missing.png");
    pair_fails(temporary.path(), &right, &[], 1, "directory");
}

#[test]
fn sizes_that_do_not_fit() {
    let temporary = folder();
    let [small, tiny] = ["small.png", "tiny.png"].map(|name| temporary.path().join(name));
    grey_png(&small, &noise(40, 9, 1));
    grey_png(&tiny, &Plane::filled((1, 1), 7));
    pair_fails(&scene("planes", "left.png"), &small, &[], 3, "340x255 and the right view 40x9");
    pair_fails(&tiny, &tiny, &[], 1, "1x1 pixels is too small for a window of 5x5");
    pair_fails(&small, &small, &["--window", "11"], 1, "40x9 pixels is too small for a window of 11x11");
    let out = temporary.path().join("out");
    match_on_cpu(&small, &small, &out).args(["--window", "9", "--force"]).assert().success();
}

#[test]
fn values_out_of_range() {
    let [left, right] = views("planes");
    for (args, expected) in [
        (&["--window", "8"][..], "window is 8, but it must be odd and 3 to 31"),
        (&["--window", "33"], "window is 33"),
        (&["--cost-window", "8"], "--cost-window is 8, but it must be odd and 1 to 31"),
        (&["--cost-window", "33"], "--cost-window is 33"),
        (&["--cost-window", "3", "--preset", "fast"], "preset is fast, but --paths and --cost-window need balanced"),
        (&["--paths", "0", "--preset", "paper"], "preset is paper"),
        (
            &["--search-both-views", "--preset", "fast"],
            "--search-both-views is given, but these options make no left-right check: add --max-lr-difference, or leave it out",
        ),
        (&["--compare", "luma"], "--preset is balanced, but --compare needs blocks: --window"),
        (&["--agreement", "10"], "--agreement is 10"),
        (&["--disparities", "0"], "--disparities is 0"),
        (&["--disparities", "4000000000"], "the disparity range is 0 to 3999999999"),
        (&["--min-disparity", "-2000000000"], "the disparity range is -2000000000"),
        (&["--min-disparity", "5000", "--disparities", "9"], "no pixel of a picture 340 px wide"),
        (&["--uniqueness", "101"], "uniqueness is 101"),
        (&["--max-lr-difference", "NaN"], "max-lr-difference is NaN"),
        (&["--max-lr-difference", "-1"], "max-lr-difference is -1"),
        (&["--octaves", "6"], "octaves is 6"),
        (&["--step", "0"], "step is 0"),
        (&["--threshold", "NaN"], "threshold is NaN"),
        (&["--ratio", "0"], "ratio is 0"),
        (&["--figures", "--strongest", "0"], "strongest is 0"),
        (&["--max-features", "0"], "--max-features is 0"),
        (&["--focal", "NaN", "--baseline", "1"], "the focal length is NaN"),
        (&["--focal", "9", "--baseline", "-1"], "the baseline is -1"),
        (&["--focal", "9", "--baseline", "1", "--doffs", "inf"], "doffs is inf"),
    ] {
        pair_fails(&left, &right, args, 2, expected);
    }
}

#[test]
fn calibrations_that_are_none() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let calib = temporary.path().join("calib.txt");
    let calib_text = calib.to_str().unwrap();
    pair_fails(&left, &right, &["--calib", calib_text], 1, "calib.txt");
    for (content, code, expected) in [
        (
            "nonsense",
            1,
            "the file has no calibration that hsad knows: calibrations are read from Middlebury's calib.txt",
        ),
        ("left\ncam0=[9 0 1; 0 9 1; 0 0 1]\n", 1, "line 1: 'left' is not of the form key=value"),
        ("cam0=[9 0 1; 0 9 1; 0 0 1]\ndoffs=0\nbaseline=0.1\n", 1, "for metres write baseline=100"),
        ("cam0=[9 0 1; 0 8 1; 0 0 1]\ndoffs=0\nbaseline=1\n", 1, "rectify the pair by the calibration first"),
        ("9 0 1 0 9 1 0 0 1\n70\n", 1, "name the unit of length with --calib-unit (0.001 for millimetres)"),
        ("cam0=[1 2 3]\ndoffs=0\nbaseline=1\n", 1, "line 1: cam0"),
        ("cam0=[9 0 1; 0 9 1; 0 0 1]\ndoffs=NaN\nbaseline=1\n", 1, "line 2: doffs is 'NaN'"),
        ("cam0=[9 0 1; 0 9 1; 0 0 1]\ndoffs=0\nbaseline=1\nwidth=9\nheight=9\n", 1, "for pictures of 9x9 pixels"),
    ] {
        fs::write(&calib, content).unwrap();
        pair_fails(&left, &right, &["--calib", calib_text, "--rectify", "never"], code, expected);
    }
    fs::write(&calib, "cam0=[9 0 1; 0 9 1; 0 0 1]\ndoffs=-1000\nbaseline=1\n").unwrap();
    let mut command = match_on_cpu(&left, &right, &temporary.path().join("out"));
    // All points lie behind the cameras.
    let told = predicates::str::contains("behind the cameras by the calibration");
    command.args(["--calib", calib_text, "-q"]).assert().code(4).stdout("").stderr(told);
    let written = crate::common::report(&temporary.path().join("out"));
    assert!(written["no_depth"].as_str().unwrap().starts_with("no pixel has a depth"), "{}", written["no_depth"]);
    command.arg("--force").assert().success().stderr("");
}

#[test]
fn folders_that_cannot_be_written() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let file = temporary.path().join("file");
    fs::write(&file, "mine").unwrap();
    // The output folder is checked before the pictures, which do not exist.
    let missing = temporary.path().join("missing.png");
    fails(match_on_cpu(&missing, &missing, &file), 1, "the results need a folder");
    fails(match_on_cpu(&missing, &missing, &file.join("below")), 1, "the folder cannot be created");
    let mut command = hsad();
    command.arg("demo").arg("-o").arg(&file);
    fails(command, 1, "the results need a folder");
    let mut command = hsad();
    command.arg("features").arg(&missing).arg("-o").arg(&file);
    fails(command, 1, "the results need a folder");
    if cfg!(target_os = "linux") {
        fails(match_on_cpu(&missing, &missing, Path::new("/proc")), 1, "/proc: no file can be written in this folder");
    }
    assert_eq!(names(temporary.path()), ["file"]);
    assert_eq!(fs::read(&file).unwrap(), b"mine");

    // One file cannot be replaced: no new file appears, and the older files stay.
    let out = temporary.path().join("out");
    fs::create_dir_all(out.join("report.json")).unwrap();
    fs::write(out.join("disparity.pfm"), "old").unwrap();
    fails(match_on_cpu(&left, &right, &out), 1, "report.json");
    assert_eq!(names(&out), ["disparity.pfm", "report.json"]);
    assert_eq!(fs::read(out.join("disparity.pfm")).unwrap(), b"old");
}

#[test]
fn devices_that_do_not_exist() {
    let [left, _] = views("planes");
    let with_device = |mut command: Command, device: &str| {
        command.arg("features").arg(&left).args(["--device", device]);
        command
    };
    fails(with_device(hsad(), "no such device"), 1, "no device matches 'no such device'; there are: ");
    fails(with_device(hsad(), "99"), 1, ", cpu");
    fails(with_device(hsad_without_driver(), "0"), 1, "mesa-vulkan-drivers");
}

#[test]
fn a_pair_that_is_not_rectified_is_diagnosed() {
    let temporary = folder();
    let picture = hsad::io::load::load(&scene("planes", "left.png")).unwrap().luma();
    let [left, lower] = ["left.png", "lower.png"].map(|name| temporary.path().join(name));
    grey_png(&left, &picture);
    grey_png(&lower, &Plane::from_fn((340, 255), |x, y| picture.get_clamped(i64::from(x), i64::from(y) - 40)));
    let words =
        "points agree); --rectify never keeps the pair from being rectified; --force searches along rows all the same";
    pair_fails(&left, &lower, &["--rectify", "never"], 3, words);
    pair_fails(&left, &lower, &["--no-align"], 3, "--no-align keeps the pair from being rectified");
    // One picture twice shows no depth by which it could be rectified.
    pair_fails(&left, &lower, &[], 3, "no warp that matches tell helps, since the views show a plane");

    // A rotation by 90 degrees, which only features with orientations match.
    let [square, turned] = ["square.png", "turned.png"].map(|name| temporary.path().join(name));
    grey_png(&square, &Plane::from_fn((255, 255), |x, y| picture.get(x, y)));
    grey_png(&turned, &Plane::from_fn((255, 255), |x, y| picture.get(y, 254 - x)));
    pair_fails(&square, &turned, &[], 3, "is turned 90.0");
    pair_fails(&square, &turned, &[], 3, "; --force searches along rows all the same");

    let upside_down = temporary.path().join("upside_down.png");
    grey_png(&upside_down, &Plane::from_fn((340, 255), |x, y| picture.get(339 - x, 254 - y)));
    pair_fails(&left, &upside_down, &[], 3, "turn the right view by 180 degrees");

    let out = temporary.path().join("out");
    let mut command = match_on_cpu(&left, &lower, &out);
    command
        .arg("--force")
        .assert()
        .success()
        .stdout(predicates::str::contains("rectified  no: the right view lies 40.0 px lower"));
}

/// A name that breaks lines, colours a terminal, or turns the direction of writing is told apart from any other.
#[cfg(unix)]
#[test]
fn paths_in_messages_are_escaped() {
    let temporary = folder();
    let name = "a\nb\x1b[31m\u{202e}c.png";
    let shown = r"a\nb\u{1b}[31m\u{202e}c.png: ";
    let out = temporary.path().join("out\t1");
    let [left, right] = views("weak");
    fails(match_on_cpu(&temporary.path().join(name), &right, &out), 1, shown);
    let mut command = match_on_cpu(&left, &right, &out);
    command.args(["--disparities", "16", "--preset", "fast", "--force"]);
    command.assert().success().stdout(predicates::str::contains(r"out\t1: disparity.pfm"));
    fs::write(temporary.path().join(name), "").unwrap();
    let mut command = match_on_cpu(&left, &right, &out);
    command.arg("--calib").arg(temporary.path().join(name));
    fails(command, 1, &format!("{shown}the file is empty"));
}
