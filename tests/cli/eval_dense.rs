//! `hsad eval dense`.

use std::{
    fs,
    path::{Path, PathBuf},
};

use assert_cmd::Command;
use hsad::{
    disparity::{DisparityMap, NONE},
    image::{Plane, Size},
    io::{disparity_png, load, pfm},
};
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;

use crate::common::{fails, folder, grey_png, hsad, names, noise, scene as shipped};
#[cfg(unix)]
use crate::interruption::Run;

const SIZE: Size = Size::new(64, 48);

/// Shift of a scene's right view, in pixels.
const SHIFT: u32 = 4;

/// `hsad eval dense` on the CPU, over few disparities.
fn eval(scenes: &[&Path]) -> Command {
    let mut command = hsad();
    command.args(["eval", "dense"]).args(scenes);
    command.args(["--device", "cpu", "--preset", "fast", "--disparities", "8"]);
    command
}

/// `hsad eval dense --given-only`, which matches nothing.
fn given_only(scenes: &[&Path]) -> Command {
    let mut command = hsad();
    command.args(["eval", "dense", "--given-only"]).args(scenes);
    command
}

/// Writes two views of noise, shifted by [`SHIFT`].
fn views(left: &Path, right: &Path, seed: u32) {
    let picture = noise(SIZE.width + SHIFT, SIZE.height, seed);
    let part = |start: u32| Plane::from_fn(SIZE, |x, y| picture.get(x + start, y));
    for path in [left, right] {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
    }
    grey_png(left, &part(0));
    grey_png(right, &part(SHIFT));
}

/// The true map: [`SHIFT`] everywhere.
fn truth() -> DisparityMap {
    Plane::filled(SIZE, 256 * SHIFT as i32)
}

fn write_pfm(path: &Path, map: &DisparityMap) {
    let mut bytes = Vec::new();
    pfm::write_disparities(&mut bytes, map).unwrap();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

fn write_png(path: &Path, map: &DisparityMap) {
    let mut bytes = Vec::new();
    disparity_png::write(&mut bytes, map).unwrap();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

/// A scene in the layout of data/. The right view does not show the first columns.
fn scene(parent: &Path, name: &str) -> PathBuf {
    let path = parent.join(name);
    views(&path.join("left.png"), &path.join("right.png"), name.len() as u32);
    write_pfm(&path.join("disp_left.pfm"), &truth());
    grey_png(&path.join("nonocc.png"), &Plane::from_fn(SIZE, |x, _| if x < SHIFT { 0 } else { 255 }));
    path
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// The rows of a CSV by the names of their columns.
fn column(csv: &Path, name: &str) -> Vec<String> {
    let text = fs::read_to_string(csv).unwrap();
    let mut lines = text.lines();
    let index = lines.next().unwrap().split(',').position(|heading| heading == name).unwrap();
    lines.map(|line| line.split(',').nth(index).unwrap().to_owned()).collect()
}

#[test]
fn scores_a_folder_of_scenes_in_every_form() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    for name in ["b", "aa"] {
        scene(&path("scenes"), name);
    }
    let (out, csv, report) = (path("out"), path("all.csv"), path("all.json"));
    let mut command = eval(&[&path("scenes")]);
    command.arg("-o").arg(&out).arg("--csv").arg(&csv).arg("--json").arg(&report);
    let told = contains("Non-occluded pixels").and(contains("All pixels")).and(contains("\n  mean of 2 "));
    command.assert().success().stdout(told.and(contains("bad-0.5")).and(contains("density")));

    // Standard output has the table alone.
    let mut command = eval(&[&path("scenes")]);
    let printed = command.args(["--csv", "-"]).assert().success().stderr("").get_output().stdout.clone();
    let (printed, written) = (String::from_utf8(printed).unwrap(), fs::read_to_string(&csv).unwrap());
    assert_eq!(printed.lines().next(), written.lines().next());
    assert_eq!(printed.lines().count(), 5, "{printed}");

    assert_eq!(column(&csv, "scene"), ["aa", "aa", "b", "b"]);
    assert_eq!(column(&csv, "region"), ["non-occluded", "all", "non-occluded", "all"]);
    assert_eq!(column(&csv, "pixels"), ["2880", "3072", "2880", "3072"]);
    for (wrong, density) in column(&csv, "bad_1_est").iter().zip(column(&csv, "density")) {
        assert!(wrong.parse::<f64>().unwrap() < 0.01 && density.parse::<f64>().unwrap() > 0.5, "{wrong}, {density}");
    }

    let report = json(&report);
    assert_eq!((&report["device"]["name"], report["failed"].as_array().unwrap().len()), (&"CPU twins".into(), 0));
    assert_eq!(report["parameters"]["window"], 9);
    assert_eq!((&report["results"][1]["scene"], &report["results"][1]["range"]["count"]), (&"b".into(), &8.into()));
    let [first, second] = [0, 1].map(|i| report["results"][i]["all"]["density"].as_f64().unwrap());
    assert_eq!(report["means"][1]["region"], "all");
    assert_eq!(report["means"][1]["density"].as_f64().unwrap(), (first + second) / 2.0);

    assert_eq!(names(&out), ["aa", "b"]);
    assert_eq!(names(&out.join("b")), ["disparity.pfm", "error.png", "figure.png", "result.json"]);
    let map = pfm::read_disparities(&out.join("b/disparity.pfm")).unwrap();
    let found = map.data().iter().filter(|&&d| d != NONE).count();
    assert_eq!(report["results"][1]["all"]["estimated"], found);
    assert_eq!(load::load(&out.join("b/figure.png")).unwrap().size(), (4 * SIZE.width + 3 * 8, SIZE.height));
    // Occluded pixels without an estimate are a third of white.
    let errors = load::load(&out.join("b/error.png")).unwrap();
    assert_eq!((map.get(0, 0), errors.rgb(0, 0)), (NONE, [85; 3]));
    assert_eq!(errors.rgb(SIZE.width / 2, SIZE.height / 2), [44, 123, 182]);
}

#[test]
fn a_truth_in_another_unit_or_of_another_sign_is_told() {
    let temporary = folder();
    let path = scene(temporary.path(), "scene");
    let disparities = Plane::filled(SIZE, SHIFT as f32);
    let write = |name: &str, scale: f32| {
        let mut bytes = Vec::new();
        pfm::write(&mut bytes, &disparities.map(|d| d * scale)).unwrap();
        fs::write(path.join(name), bytes).unwrap();
    };
    for (scale, option) in [(-1.0, "-1"), (16.0, "1/16"), (1.0 / 256.0, "256")] {
        write("disp_left.pfm", scale);
        fails(eval(&[&path]), 1, &format!("give --truth-scale {option}, or 1"));
        let mut told = eval(&[&path]);
        told.args(["--truth-scale", option, "--csv", "-"]);
        let printed = String::from_utf8(told.assert().success().stderr("").get_output().stdout.clone()).unwrap();
        let wrong: f64 = printed.lines().nth(1).unwrap().split(',').nth(6).unwrap().parse().unwrap();
        assert!(wrong < 0.2, "{printed}");
        // As it is, without any scale: all pixels are wrong.
        let mut forced = eval(&[&path]);
        forced.args(["--truth-scale", "1"]).assert().success().stdout(contains("100.00"));
    }
    // A map of another program in another unit.
    write("disp_left.pfm", 1.0);
    write("theirs.pfm", 16.0);
    let mut command = given_only(&[&path]);
    command.arg("--disparity").arg(format!("theirs={}", path.join("theirs.pfm").display()));
    command.assert().success().stderr(contains("another unit").and(contains("times 1/16 it agrees at 100 %")));
    let mut command = eval(&[&path]);
    command.args(["--truth-scale", "0"]);
    command.assert().code(2).stderr(contains("a number other than 0 or a fraction"));
}

#[test]
fn a_turned_or_scaled_right_view_is_scored_where_it_shows_the_pixel() {
    let temporary = folder();
    let scored = |condition: &[&str]| {
        let csv = temporary.path().join("errors.csv");
        let mut command = hsad();
        command.args(["eval", "dense", "--device", "cpu", "-q"]).arg(shipped("planes", ""));
        command.args(condition).arg("--csv").arg(&csv).assert().success();
        let of = |name: &str| column(&csv, name)[0].parse::<f64>().unwrap();
        (of("pixels"), of("bad_1"))
    };
    let (all, level) = scored(&[]);
    assert_eq!(scored(&["--condition", "none"]), (all, level));
    for (condition, shown) in [("rotation=90", 0.4..0.95), ("rotation=180", 0.99..1.01), ("scale=0.8", 0.99..1.01)] {
        let (pixels, wrong) = scored(&["--condition", condition]);
        assert!(shown.contains(&(pixels / all)), "{condition}: {pixels} of {all}");
        assert!(wrong < level + 0.03, "{condition}: {wrong} and {level}");
    }
    let mut right = hsad();
    right.args(["eval", "dense", "--condition", "blur", "--reference", "right"]).arg(shipped("planes", ""));
    fails(right, 2, "since --condition changes the right view");
}

#[test]
fn knows_the_layouts_of_middlebury_and_kitti() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    views(&path("Piano/im0.png"), &path("Piano/im1.png"), 1);
    write_pfm(&path("Piano/disp0GT.pfm"), &truth());
    grey_png(&path("Piano/mask0nocc.png"), &Plane::from_fn(SIZE, |x, _| if x < 8 { 128 } else { 255 }));
    for frame in ["000000_10", "000001_10", "000002_10"] {
        let file = |folder: &str| path("training").join(folder).join(frame).with_extension("png");
        views(&file("image_2"), &file("image_3"), 2);
        let known = |from: u32| Plane::from_fn(SIZE, |x, _| if x < from { NONE } else { 1024 });
        write_png(&file("disp_occ_0"), &known(1));
        write_png(&file("disp_noc_0"), &known(16));
    }
    let csv = path("all.csv");
    let frame = path("training/image_2/000002_10.png");
    eval(&[&path("Piano"), &frame]).arg("--csv").arg(&csv).assert().success();
    assert_eq!(column(&csv, "scene"), ["Piano", "Piano", "000002_10", "000002_10"]);
    let pixels = [56, 64, 48, 63].map(|columns| (columns * SIZE.height).to_string());
    assert_eq!(column(&csv, "pixels"), pixels);
    assert!(column(&csv, "d1_est").iter().all(|share| share.parse::<f64>().unwrap() < 0.01));
    eval(&[&path("training")]).arg("--csv").arg(&csv).assert().success();
    assert_eq!(column(&csv, "scene").len(), 6);

    // KITTI has no ground truth for the right view.
    let mut command = eval(&[&frame]);
    command.args(["--reference", "right"]);
    fails(command, 1, "no truth for the right view");
}

#[test]
fn the_right_view_has_its_own_truth() {
    let temporary = folder();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/planes");
    let report = temporary.path().join("report.json");
    let mut command = hsad();
    command.args(["eval", "dense"]).arg(data).args(["--preset", "paper", "--device", "cpu", "--json"]).arg(&report);
    command.assert().success();
    let all = &json(&report)["results"][0]["all"];
    assert!(all["bad"][1]["of_estimated"].as_f64().unwrap() < 0.4, "{all}");
}

#[test]
fn maps_of_other_programs_are_scored_beside_ours() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    let scenes = ["a", "bb"].map(|name| scene(&path("scenes"), name));
    for name in ["a", "bb"] {
        write_pfm(&path("maps").join(name).join("perfect.pfm"), &truth());
        // Off by 5 px on the left half, and empty in one row.
        let off = |x: u32, y: u32| if y == 0 { NONE } else { 1024 + if x < SIZE.width / 2 { 1280 } else { 0 } };
        write_png(&path("maps").join(name).join("off.png"), &Plane::from_fn(SIZE, off));
        write_pfm(&path("maps").join(name).join("empty.pfm"), &Plane::filled(SIZE, NONE));
    }
    let option = |name: &str, file: &str| format!("--disparity={name}={}/{{scene}}/{file}", path("maps").display());
    let others = [option("perfect", "perfect.pfm"), option("off", "off.png"), option("empty", "empty.pfm")];
    let (csv, out) = (path("all.csv"), path("out"));
    let mut command = eval(&[&scenes[0], &scenes[1]]);
    command.args(&others).arg("--csv").arg(&csv).arg("-o").arg(&out);
    let told = contains("Estimated of all").and(contains("  mean of 2             perfect"));
    command.assert().success().stdout(told);
    let methods: Vec<_> = column(&csv, "method").into_iter().skip(1).step_by(2).collect();
    assert_eq!(methods, ["hsad", "perfect", "off", "empty", "hsad", "perfect", "off", "empty"]);
    let all = |name: &str| column(&csv, name).into_iter().skip(1).step_by(2).skip(1).take(3).collect::<Vec<_>>();
    let rows = f64::from(SIZE.height);
    assert_eq!(all("bad_4"), ["0".into(), (0.5 + 0.5 / rows).to_string(), "1".to_owned()]);
    assert_eq!(all("bad_4_est"), ["0", "0.5", ""]);
    assert_eq!(all("d1_est"), ["0", "0.5", ""]);
    assert_eq!(all("average_px"), ["0", "2.5", ""]);
    assert_eq!(all("a99_px"), ["0", "5", ""]);
    assert_eq!(names(&out.join("a/off")), ["disparity.pfm", "error.png", "figure.png", "result.json"]);

    // With --given-only, nothing is matched.
    let report = path("all.json");
    let mut command = given_only(&[&scenes[0]]);
    command.arg(&others[0]).arg("--json").arg(&report).assert().success();
    let report = json(&report);
    assert_eq!((report["results"].as_array().unwrap().len(), &report["device"]), (1, &Value::Null));
}

#[test]
fn what_fails_is_told_and_loses_nothing_else() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    let [good, cut, small, nothing] = ["good", "cut", "small", "nothing"].map(|name| scene(&path(""), name));
    fs::write(cut.join("right.png"), b"no picture").unwrap();
    write_pfm(&small.join("disp_left.pfm"), &Plane::filled((3, 2), 0));
    for file in names(&nothing) {
        fs::remove_file(nothing.join(file)).unwrap();
    }
    let maps = format!("--disparity=theirs={}/{{scene}}/theirs.pfm", path("").display());
    let (csv, report) = (path("all.csv"), path("all.json"));
    let mut command = eval(&[&cut, &nothing, &good, &small, &path("missing")]);
    let output = command.arg(maps).arg("--csv").arg(&csv).arg("--json").arg(&report).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8(output.stderr).unwrap();
    let errors: Vec<_> = told.lines().filter(|line| line.starts_with("error: ")).collect();
    assert_eq!(errors.len(), 5, "{told}");
    let expected =
        ["cut/right.png", "disp_left.pfm: its size is 3x2", "theirs.pfm", "a folder without a scene", "missing"];
    for text in expected {
        assert_eq!(errors.iter().filter(|line| line.contains(text)).count(), 1, "{text}: {told}");
    }
    assert!(String::from_utf8(output.stdout).unwrap().contains("\n  good "));
    assert_eq!(column(&csv, "scene"), ["good", "good"]);
    assert_eq!(json(&report)["failed"].as_array().unwrap().len(), 5);
}

/// A scene without its left view fails, too, and the others are scored.
#[test]
fn a_truth_without_a_known_pixel_is_an_error() {
    let temporary = folder();
    let [known, unknown] = ["known", "unknown"].map(|name| scene(temporary.path(), name));
    write_pfm(&unknown.join("disp_left.pfm"), &Plane::filled(SIZE, NONE));
    let output = eval(&[temporary.path()]).output().unwrap();
    let [told, error] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(told.contains("\n  known ") && !told.contains("\n  unknown "), "{told}");
    assert!(error.contains("unknown/disp_left.pfm: no pixel has a known disparity"), "{error}");
    assert_eq!(output.status.code(), Some(1));
    fs::remove_dir_all(known).unwrap();
    fails(eval(&[temporary.path()]), 1, "no pixel has a known disparity");
}

#[test]
fn half_a_scene_is_named() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    scene(&path("all"), "good");
    let half = scene(&path("all"), "half");
    fs::remove_file(half.join("left.png")).unwrap();
    let output = eval(&[&path("all")]).output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(told.contains("half/left.png"), "{told}");
    assert!(String::from_utf8(output.stdout).unwrap().contains("\n  good "));
}

#[test]
fn bad_input_is_one_line_and_a_code() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    let good = scene(&path(""), "good");
    fs::create_dir(path("empty")).unwrap();
    write_pfm(&path("small.pfm"), &Plane::filled((3, 2), 0));
    fs::write(path("text.pfm"), "this is text").unwrap();

    let bad = |scenes: &[&Path], args: &[&str], code: i32, expected: &str| {
        let mut command = given_only(scenes);
        command.args(args).current_dir(temporary.path());
        fails(command, code, expected);
    };
    bad(&[&path("empty")], &["--disparity", "x=small.pfm"], 1, "empty: a folder without a scene");
    bad(&[&path("small.pfm")], &["--disparity", "x=small.pfm"], 1, "a file: a scene is a folder with left.png");
    bad(&[&good], &["--disparity", "x=small.pfm"], 1, "64x48");
    bad(&[&good], &["--disparity", "x=text.pfm"], 1, "text.pfm: neither a PNG nor a PFM");
    bad(&[&good], &["--disparity", "x={scene}.pfm"], 1, "good.pfm");
    bad(&[&good], &["--disparity", "x=a", "--disparity", "x=b"], 2, "another 'x'");
    bad(&[&good, &scene(&path("other"), "next")], &["--disparity", "x=a"], 2, "by {scene}, as in x=maps/{scene}.pfm");
    bad(&[&good, &scene(&path("other"), "good")], &["--disparity", "x=a"], 2, "the name of two scenes, 'good'");
    bad(&[&good], &["--disparity", "x=a", "--csv", "no/such/folder.csv"], 1, "there is no folder 'no/such'");
    bad(&[&good], &["--disparity", "x=a", "-o", "small.pfm"], 1, "the results need a folder");
    bad(&[&good], &["--disparity", "x=a", "--window", "8"], 2, "window is 8");
    bad(&[&good], &["--disparity", "x=a", "--window", "7"], 2, "nothing is matched: leave --window out");
    let [truth, table] = ["good/disp_left.pfm", "table"];
    bad(&[&good], &["--disparity", "x=a", "--csv", truth], 1, "it would replace a file that is read");
    bad(&[&good], &["--disparity", "x=text.pfm", "--csv", table, "--json", "./text.pfm"], 1, "a file that is read");
    bad(&[&good], &["--disparity", "x=a", "--csv", table, "--json", "./table"], 1, "two tables cannot have one place");
    bad(&[&good], &["--disparity", "x=a", "--csv", "-", "--json", "-"], 1, "two tables cannot have one place");
    bad(&[&good], &["--disparity", "x=good/disparity.pfm", "-o", "."], 1, "good/disparity.pfm: No such file");
    // In a scene's own folder, results replace nothing that is read.
    fs::copy(good.join("disp_left.pfm"), good.join("disparity.pfm")).unwrap();
    let kept = fs::read(good.join("disparity.pfm")).unwrap();
    let mut command = eval(&[&good]);
    command.args(["--disparity", "x=good/disparity.pfm", "-o", ".", "-q"]).current_dir(temporary.path());
    fails(command, 1, "good/disparity.pfm: a result of this name would replace a file that was read");
    assert_eq!(fs::read(good.join("disparity.pfm")).unwrap(), kept);
    assert_eq!(names(temporary.path()), ["empty", "good", "other", "small.pfm", "text.pfm"]);

    for args in [
        &[][..],
        &["a", "--given-only"],
        &["a", "--fresh"],
        &["a", "--disparity", "b"],
        &["a", "--disparity", "hsad=b"],
    ] {
        hsad().args(["eval", "dense"]).args(args).assert().code(2).stderr(contains("error: ").or(contains("Usage:")));
    }
}

#[test]
fn finished_scenes_are_kept_until_something_changes() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    let scenes = [scene(&path(""), "a"), scene(&path(""), "bb")];
    write_pfm(&path("maps/a.pfm"), &truth());
    write_pfm(&path("maps/bb.pfm"), &truth());
    let (csv, out) = (path("all.csv"), path("out"));
    let given = format!("--disparity=theirs={}/{{scene}}.pfm", path("maps").display());
    let run = |args: &[&str]| {
        let mut command = eval(&[&scenes[0], &scenes[1]]);
        command.arg(&given).args(args).arg("-o").arg(&out).arg("--csv").arg(&csv);
        let output = command.output().unwrap();
        assert!(output.status.success());
        let told = String::from_utf8(output.stdout).unwrap();
        let kept = told.lines().last().unwrap().split_once("; ").map(|(_, kept)| kept[..6].to_owned());
        (kept, fs::read_to_string(&csv).unwrap())
    };
    let (kept, first) = run(&[]);
    assert_eq!(kept, None);
    assert_eq!(run(&[]), (Some("4 of 4".into()), first.clone()));
    assert_eq!(run(&["--fresh"]).0, None);
    // An option that matters only for this program's own maps.
    assert_eq!(run(&["--uniqueness", "20"]).0, Some("2 of 4".into()));
    assert_eq!(run(&["--uniqueness", "20"]).0, Some("4 of 4".into()));
    assert_eq!(run(&[]).0, Some("2 of 4".into()));
    // A changed picture invalidates all methods of its scene.
    views(&scenes[0].join("left.png"), &path("unused.png"), 77);
    assert_eq!(run(&[]).0, Some("2 of 4".into()));
    write_pfm(&path("maps/bb.pfm"), &Plane::filled(SIZE, 0));
    assert_eq!(run(&[]).0, Some("3 of 4".into()));
    // A saved result with a missing file, and one changed by hand.
    fs::remove_file(out.join("a/error.png")).unwrap();
    fs::write(out.join("bb/figure.png"), "").unwrap();
    assert_eq!(run(&[]).0, Some("2 of 4".into()));
    assert!(out.join("a/error.png").is_file());
}

#[test]
fn files_that_hsad_did_not_write_are_not_replaced() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    for name in ["a", "bb"] {
        scene(&path("ev"), name);
        fs::write(path("ev").join(name).join("disparity.pfm"), "mine").unwrap();
    }
    fs::remove_file(path("ev/bb/disparity.pfm")).unwrap();
    let output = eval(&[&path("ev")]).arg("-o").arg(path("ev")).output().unwrap();
    // The scores are shown all the same.
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(told.contains("\n  a ") && told.contains("\n  bb "), "{told}");
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(
        error.contains("a/disparity.pfm: a result of this name would replace a file that no result.json"),
        "{error}"
    );
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(fs::read(path("ev/a/disparity.pfm")).unwrap(), b"mine");
    let mut files = vec!["disp_left.pfm", "disparity.pfm", "left.png", "nonocc.png", "right.png"];
    assert_eq!(names(&path("ev/a")), files);
    files.extend(["error.png", "figure.png", "result.json"]);
    files.sort_unstable();
    assert_eq!(names(&path("ev/bb")), files);
    // What it wrote itself it writes again.
    eval(&[&path("ev/bb")]).args(["--fresh", "-o"]).arg(path("ev")).assert().success();
    fs::write(path("ev/bb/result.json"), "mine").unwrap();
    eval(&[&path("ev/bb")]).arg("-o").arg(path("ev")).assert().code(1);
}

#[test]
fn what_cannot_be_kept_is_told() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    let scene = scene(&path(""), "a");
    // A file stands in place of the scene's output folder.
    fs::create_dir(path("out")).unwrap();
    fs::write(path("out/a"), "mine").unwrap();
    let output = eval(&[&scene]).arg("-o").arg(path("out")).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stdout).unwrap().contains("\n  a "));
    assert!(String::from_utf8(output.stderr).unwrap().contains("out/a: the results need a folder"));
}

#[cfg(unix)]
#[test]
fn an_interruption_keeps_what_is_finished() {
    let temporary = folder();
    let path = |name: &str| temporary.path().join(name);
    let small = scene(&path(""), "small");
    // The CPU twins take a minute for this scene.
    let large = path("vast");
    fs::create_dir(&large).unwrap();
    for name in ["left.png", "right.png"] {
        grey_png(&large.join(name), &noise(1500, 1300, 3));
    }
    write_pfm(&large.join("disp_left.pfm"), &Plane::filled((1500, 1300), 0));
    let out = path("out");
    let options = ["eval", "dense", "-q", "--device", "cpu", "--disparities", "1000", "--force", "-o"];
    let arguments = options.iter().map(std::ffi::OsStr::new).chain([&out, &small, &large].map(|path| path.as_os_str()));
    let mut run = Run::start(arguments, &[]);
    run.wait_for(&out.join("small/result.json"));
    run.signal(libc::SIGTERM);
    assert_eq!(run.exit_code(), Some(130));
    assert_eq!(names(&out), ["small"]);
    assert_eq!(names(&out.join("small")), ["disparity.pfm", "error.png", "figure.png", "result.json"]);
}

#[test]
fn quiet_prints_nothing() {
    let temporary = folder();
    let report = temporary.path().join("report.json");
    let mut command = eval(&[shipped("planes", "").as_path()]);
    command.args(["-q", "--json"]).arg(&report).assert().success().stdout("").stderr("");
    // The range of --disparities misses the scene; the warning is in the file even with --quiet.
    assert!(!json(&report)["results"][0]["warnings"].as_array().unwrap().is_empty());
}
