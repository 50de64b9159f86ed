//! `hsad eval features`.

use std::{
    fs,
    path::{Path, PathBuf},
};

use assert_cmd::Command;
use hsad::{
    disparity::{DisparityMap, fixed_point},
    eval::conditions::Changed,
    glam::{DMat3, DVec2},
    image::Plane,
    io::{Picture, disparity_png, homography, load, pfm, png},
};
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;

use crate::common::{fails, folder, grey_png, hsad, names};

fn scene(name: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "data", name].iter().collect()
}

/// `hsad eval features FOLDER... --device cpu`.
fn evaluate(folders: &[&Path]) -> Command {
    let mut command = hsad();
    command.args(["eval", "features", "--device", "cpu"]).args(folders);
    command
}

/// `hsad eval features FOLDER --matches FILE`.
fn judge(folder: &Path, matches: &Path) -> Command {
    let mut command = hsad();
    command.args(["eval", "features"]).arg(folder).arg("--matches").arg(matches);
    command
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// Runs `command` and returns the figures of its only pair.
fn figures(mut command: Command, json_file: &Path) -> Value {
    command.arg("--json").arg(json_file).arg("-q").assert().success().stdout("").stderr("");
    json(json_file)["pairs"][0].clone()
}

/// Matches of the shipped scene, each `off` px to the right of its true position, as lines of CSV without a header.
fn matches(off: f32) -> Vec<String> {
    let truth = pfm::read(&scene("planes").join("disp_left.pfm")).unwrap();
    let shown = load::load(&scene("planes").join("nonocc.png")).unwrap().luma();
    let places = (20..240).step_by(12).flat_map(|y| (80..320).step_by(12).map(move |x| (x, y)));
    places
        .filter(|&(x, y)| shown.get(x, y) == 255)
        .map(|(x, y)| format!("{x},{y},{},{y}", x as f32 - truth.get(x, y) + off))
        .collect()
}

fn write_lines(path: &Path, header: &str, lines: &[String]) {
    fs::write(path, format!("{header}\n{}\n", lines.join("\n"))).unwrap();
}

#[test]
fn own_matches_are_good_on_a_shipped_scene_also_where_it_is_turned() {
    let temporary = folder();
    let [csv, json_file] = ["t.csv", "t.json"].map(|name| temporary.path().join(name));
    let mut command = evaluate(&[&scene("planes")]);
    command.args(["--condition", "none", "--condition", "rotation=90", "--first", "10,100", "--csv"]);
    command.arg(&csv).arg("--json").arg(&json_file);
    let told = contains("none\n").and(contains("rotation=90\n")).and(contains("of 100")).and(contains("\nmean "));
    command.assert().success().stdout(told).stderr("");

    let report = json(&json_file);
    assert_eq!((&report["tolerance_px"], &report["matches_of"]), (&1.5.into(), &"hsad".into()));
    let pairs = report["pairs"].as_array().unwrap();
    assert_eq!((pairs.len(), report["means"].as_array().unwrap().len()), (2, 2));
    let text = fs::read_to_string(&csv).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    for (pair, line) in pairs.iter().zip(lines) {
        assert!(
            pair["precision_of_100"].as_f64().unwrap() >= 0.97 && pair["matches"].as_f64().unwrap() > 200.0,
            "{pair}"
        );
        for name in ["precision", "recall", "f_measure", "coverage", "repeatability", "matching_score"] {
            let figure = pair[name].as_f64().unwrap();
            assert!(figure > 0.2 && figure <= 1.0, "{name}: {figure}");
            let column = header.iter().position(|column| *column == name).unwrap();
            assert_eq!(line.split(',').nth(column).unwrap().parse::<f64>().unwrap(), figure);
        }
    }
    assert_eq!(report["means"][1]["precision"], pairs[1]["precision"]);
}

#[test]
fn plain_matching_is_lost_where_the_view_is_turned() {
    let temporary = folder();
    let mut command = evaluate(&[&scene("planes")]);
    command.args(["--plain", "--condition", "rotation=90"]);
    let plain = figures(command, &temporary.path().join("t.json"));
    assert!(plain["recall"].as_f64().unwrap() < 0.05, "{plain}");
}

#[test]
fn right_matches_of_another_program_score_1_and_wrong_ones_0() {
    let temporary = folder();
    let file = |name: &str| temporary.path().join(name);
    for (off, expected) in [(0.0, 1.0), (1.25, 1.0), (5.0, 0.0)] {
        write_lines(&file("m.csv"), "x1,y1,x2,y2", &matches(off));
        let command = judge(&scene("planes"), &file("m.csv"));
        let found = figures(command, &file("t.json"));
        assert_eq!((&found["precision"], &found["precision_of_100"]), (&expected.into(), &expected.into()));
        assert!(found["matches"].as_f64().unwrap() > 200.0);
        for unknown in ["points", "recall", "f_measure", "coverage", "repeatability", "matching_score"] {
            assert_eq!(found[unknown], Value::Null, "{unknown} without points");
        }
    }

    // The more confident half is right, with points in both views.
    let [right, wrong] = [matches(0.0), matches(9.0)];
    let lines = right.iter().map(|line| format!("{line},0.9")).chain(wrong.iter().map(|line| format!("{line},0.1")));
    write_lines(&file("m.csv"), "x1,y1,x2,y2,confidence", &lines.collect::<Vec<_>>());
    let column = |i: usize| -> Vec<String> {
        let place = |line: &String| line.split(',').map(String::from).collect::<Vec<_>>()[i..i + 2].join(",") + ",2";
        right.iter().map(place).collect()
    };
    write_lines(&file("left.csv"), "x,y,scale", &column(0));
    write_lines(&file("right.csv"), "x,y,scale", &column(2));
    let mut command = judge(&scene("planes"), &file("m.csv"));
    command.arg("--points").args([file("left.csv"), file("right.csv")]);
    let found = figures(command, &file("t.json"));
    assert_eq!((&found["precision"], &found["precision_of_100"]), (&0.5.into(), &1.0.into()));
    for name in ["recall", "coverage", "repeatability", "matching_score"] {
        assert_eq!(found[name], 1.0, "{name}");
    }
    assert_eq!(found["f_measure"], 2.0 / 3.0);
}

#[test]
fn a_homography_set_has_a_pair_for_each_view() {
    let temporary = folder();
    let set = temporary.path().join("set");
    fs::create_dir(&set).unwrap();
    let picture = load::load(&scene("curved").join("left.png")).unwrap();
    let write = |name: &str, picture: &Picture| {
        let mut bytes = Vec::new();
        png::write_rgb8(&mut bytes, &picture.map(|&[r, g, b, _]| [r, g, b])).unwrap();
        fs::write(set.join(name), bytes).unwrap();
    };
    write("img1.png", &picture);
    for (k, condition) in [(2, "rotation=20"), (4, "scale=0.8")] {
        let changed = Changed::by(&[condition.parse().unwrap()], &picture, 1);
        write(&format!("img{k}.png"), &changed.picture);
        let (m, t) = (changed.map.matrix2, changed.map.translation);
        let rows = [m.x_axis.x, m.y_axis.x, t.x, m.x_axis.y, m.y_axis.y, t.y, 0.0, 0.0, 1.0];
        fs::write(set.join(format!("H1to{k}p")), rows.map(|n| n.to_string()).join(" \n")).unwrap();
    }
    let json_file = temporary.path().join("t.json");
    evaluate(&[&set])
        .arg("--json")
        .arg(&json_file)
        .assert()
        .success()
        .stdout(contains("set 1-2").and(contains("set 1-4")));
    for pair in json(&json_file)["pairs"].as_array().unwrap() {
        assert!(pair["precision"].as_f64().unwrap() > 0.97 && pair["repeatability"].as_f64().unwrap() > 0.5, "{pair}");
    }
    evaluate(&[&set])
        .args(["--view", "4"])
        .assert()
        .success()
        .stdout(contains("set 1-4").and(contains("set 1-2").not()));

    // A folder of sets, one of them with the names of HPatches.
    let patches = temporary.path().join("patches");
    fs::create_dir(&patches).unwrap();
    for (from, to) in [("img1.png", "1.ppm"), ("img2.png", "2.ppm"), ("H1to2p", "H_1_2")] {
        fs::copy(set.join(from), patches.join(to)).unwrap();
    }
    let mut command = evaluate(&[temporary.path()]);
    command.args(["--view", "2"]).assert().success().stdout(contains("set 1-2").and(contains("patches 1-2")));
    let mut command = evaluate(&[&patches]);
    command.args(["--truth-scale", "2"]);
    fails(command, 1, "--truth-scale is for disparities");

    let of_view = |k: &str| {
        let mut command = evaluate(&[&set]);
        command.args(["--view", k]);
        command
    };
    fails(of_view("3"), 1, "there is no H1to3p");

    // Homographies from the second view to the first, and by columns.
    let matrix = homography::read(&set.join("H1to4p")).unwrap();
    let write = |matrix: DMat3| {
        let rows = matrix.transpose().to_cols_array();
        fs::write(set.join("H1to4p"), rows.map(|n| n.to_string()).join(" ")).unwrap();
    };
    for (other, told) in [(matrix.inverse(), "inverted"), (matrix.transpose(), "transposed")] {
        write(other);
        fails(of_view("4"), 1, "set 1-4, none: the homography is in another form");
        fails(of_view("4"), 1, &format!("% if it is {told}: write it {told}"));
    }
    let supplied = temporary.path().join("supplied.csv");
    let places = (20..200).step_by(9).map(|x| DVec2::new(f64::from(x), 60.0));
    let line = |first: DVec2| {
        let second = (matrix * first.extend(1.0)).truncate();
        format!("{},{},{},{}", second.x, second.y, first.x, first.y)
    };
    write_lines(&supplied, "x1,y1,x2,y2", &places.map(line).collect::<Vec<_>>());
    write(matrix);
    let mut exchanged = judge(&set, &supplied);
    exchanged.args(["--view", "4"]);
    fails(exchanged, 1, "or exchange the columns of the first and the second view in the matches");
    fs::write(set.join("H1to4p"), "1 0 0 0 1 0 0 0").unwrap();
    fails(of_view("4"), 1, "a homography is nine numbers");
    evaluate(&[&set]).assert().code(1).stdout(contains("set 1-2"));
    fs::write(set.join("H1to4p"), "1 0 0 0 1 0 0 0 0").unwrap();
    fails(of_view("4"), 1, "have an inverse");
}

#[test]
fn changed_views_are_written_for_other_programs() {
    let temporary = folder();
    let out = temporary.path().join("views");
    let mut command = hsad();
    command.args(["eval", "features"]).arg(scene("weak"));
    command.args(["--condition", "none", "--condition", "gain=0.5+noise", "--write-views"]).arg(&out);
    command.assert().success().stdout("");
    assert_eq!(names(&out), ["weak gain=0.5+noise=10.png", "weak none.png"]);
    let right = load::load(&scene("weak").join("right.png")).unwrap();
    assert!(load::load(&out.join("weak none.png")).unwrap() == right);
    let conditions = ["gain=0.5", "noise"].map(|text| text.parse().unwrap());
    assert!(
        load::load(&out.join("weak gain=0.5+noise=10.png")).unwrap() == Changed::by(&conditions, &right, 1).picture
    );
}

#[test]
fn what_fails_does_not_lose_the_rest() {
    let missing = Path::new("nowhere");
    let output = evaluate(&[missing, &scene("weak")]).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stdout).unwrap().contains("\nweak "));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.starts_with("error: nowhere: ") && stderr.lines().count() == 1, "{stderr}");
    let output = evaluate(&[missing, Path::new("neither")]).output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    let lines: Vec<_> = stderr.lines().map(|line| &line[..15]).collect();
    assert_eq!((output.status.code(), &lines[..]), (Some(1), &["error: nowhere:", "error: neither:"][..]));
    let empty = folder();
    fails(evaluate(&[empty.path()]), 1, "a homography set holds img1.png");
    fails(evaluate(&[&scene("weak"), &scene("weak")]), 2, "the name of two scenes, 'weak'");
}

#[test]
fn bad_options_are_named() {
    for (args, expected) in [
        (&["--condition", "fog"][..], "condition is 'fog', but there are only: gain, gamma, ramp"),
        (&["--condition", "rotation=30+scale=9"], "scale is 9, but its strength must be 0.5 to 2"),
        (&["--condition", "noise=-1"], "noise is -1, but its strength must be 0 to 100"),
        (&["--condition", "blur="], "its strength must be a number"),
        (&["--tolerance", "-1"], "tolerance is -1"),
        (&["--first", "10,0"], "first is 0"),
        (&["--threshold", "2"], "threshold is 2"),
        (&["--ratio", "0"], "ratio is 0"),
    ] {
        let mut command = evaluate(&[&scene("weak")]);
        command.args(args);
        fails(command, 2, expected);
    }
    let mut command = judge(&scene("weak"), Path::new("m.csv"));
    command.args(["--condition", "none", "--condition", "gain"]);
    fails(command, 2, "they belong to one pair");
    for args in [
        &["--matches", "m.csv", "--plain"][..],
        &["--matches", "m.csv", "--octaves", "2"],
        &["--write-views", "out", "--first", "3"],
    ] {
        let mut command = hsad();
        command.args(["eval", "features"]).arg(scene("weak")).args(args);
        command.assert().code(2).stderr(contains("cannot be used with"));
    }
    hsad().args(["eval", "features"]).assert().code(2);
    hsad().arg("eval").assert().code(2);
}

#[test]
fn what_cannot_be_kept_is_told() {
    let temporary = folder();
    // A file stands in place of the pair's output folder.
    fs::create_dir(temporary.path().join("out")).unwrap();
    fs::write(temporary.path().join("out/weak"), "mine").unwrap();
    let mut command = evaluate(&[&scene("weak")]);
    let output = command.args(["--first", "50,10,50", "-o"]).arg(temporary.path().join("out")).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(
        told.contains("weak") && told.matches("of 10").count() == 1 && told.matches("of 50").count() == 1,
        "{told}"
    );
    assert!(String::from_utf8(output.stderr).unwrap().contains("out/weak/none: "));
}

/// The check comes before any work, whose result would be lost.
#[test]
fn a_file_that_cannot_be_written_is_named_first() {
    for option in ["--csv", "--json"] {
        let mut command = evaluate(&[&scene("weak")]);
        let output = command.args([option, "/nowhere/figures"]).output().unwrap();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
        assert!(String::from_utf8(output.stderr).unwrap().contains("/nowhere/figures"));
    }
}

#[test]
fn bad_tables_are_named_with_their_line() {
    let temporary = folder();
    let [m, left, right] = ["m.csv", "left.csv", "right.csv"].map(|name| temporary.path().join(name));
    for (text, expected) in [
        ("", "the file is empty"),
        ("x1,y1,x2\n1,2,3\n", "no column 'y2'"),
        ("x1,y1,x2,y2\n1,2,3,4\n1,2,c,4\n", "m.csv: line 3: x2 is 'c', but it must be a number"),
        ("x1,y1,x2,y2\n1,2,3\n", "line 2: it has no y2"),
        ("x1,y1,x2,y2\n287,2,3,4\n", "line 2: x1 is 287, but the picture is 287 px wide"),
        ("x1,y1,x2,y2\n1,2,3,4\n1,2,3,-7\n", "line 3: y2 is -7, but the picture is 215 px high"),
        ("x1,y1,x2,y2,confidence\n1,2,3,4,NaN\n", "line 2: confidence is 'NaN'"),
    ] {
        fs::write(&m, text).unwrap();
        fails(judge(&scene("weak"), &m), 1, expected);
    }
    fs::write(&m, "x1,y1,x2,y2\n1,2,3,4\n").unwrap();
    fs::write(&right, "x,y,scale\n3,4,2\n").unwrap();
    for (text, expected) in [("x,y\n1,2\n", "no column 'scale'"), ("x,y,scale\n1,2,0\n", "line 2: scale is 0")] {
        fs::write(&left, text).unwrap();
        let mut command = judge(&scene("weak"), &m);
        command.arg("--points").args([&left, &right]);
        fails(command, 1, expected);
    }
}

#[test]
fn scenes_whose_files_do_not_fit_are_named() {
    let temporary = folder();
    let copy = temporary.path();
    for file in ["left.png", "right.png", "disp_left.pfm"] {
        fs::copy(scene("weak").join(file), copy.join(file)).unwrap();
    }
    evaluate(&[copy]).assert().success();
    grey_png(&copy.join("nonocc.png"), &Plane::filled((9, 9), 255));
    fails(evaluate(&[copy]), 1, "its size is 9x9 and that of the views 287x215");
    grey_png(&copy.join("right.png"), &Plane::filled((9, 9), 255));
    let mut twice = evaluate(&[copy]);
    twice.args(["--condition", "none", "--condition", "gain"]);
    fails(twice, 1, "287x215 and the right view 9x9");
    for file in ["left.png", "right.png"] {
        grey_png(&copy.join(file), &Plane::filled((9, 9), 255));
    }
    fails(evaluate(&[copy]), 1, "its size is 287x215 and that of the views 9x9");
}

/// One pair in the layouts of the benchmarks.
#[test]
fn scenes_have_any_layout_that_maps_are_scored_in() {
    let temporary = folder();
    let [middlebury, kitti] = ["middlebury", "kitti"].map(|name| temporary.path().join(name));
    let copy = |from: &str, to: PathBuf| {
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::copy(scene("planes").join(from), to).unwrap();
    };
    for (from, to) in [("left.png", "im0.png"), ("right.png", "im1.png"), ("disp_left.pfm", "disp0.pfm")] {
        copy(from, middlebury.join(to));
    }
    for (from, to) in [("left.png", "image_2"), ("right.png", "image_3")] {
        copy(from, kitti.join(to).join("000007_10.png"));
    }
    let truth = pfm::read(&scene("planes").join("disp_left.pfm")).unwrap();
    let truth =
        DisparityMap::new((340, 255), truth.data().iter().map(|&pixels| fixed_point(pixels)).collect()).unwrap();
    let mut png = Vec::new();
    disparity_png::write(&mut png, &truth).unwrap();
    fs::create_dir(kitti.join("disp_occ_0")).unwrap();
    fs::write(kitti.join("disp_occ_0/000007_10.png"), png).unwrap();

    let json_file = temporary.path().join("t.json");
    evaluate(&[temporary.path()]).arg("--json").arg(&json_file).assert().success();
    let found = json(&json_file)["pairs"].clone();
    let names: Vec<_> = found.as_array().unwrap().iter().map(|pair| pair["scene"].clone()).collect();
    assert_eq!(names, ["000007_10", "middlebury"]);
    for pair in found.as_array().unwrap() {
        assert!(pair["precision_of_100"].as_f64().unwrap() > 0.97, "{pair}");
    }
    let of_a_scene = |view: &[&str]| {
        let mut command = evaluate(&[&middlebury]);
        command.args(view);
        command
    };
    fails(of_a_scene(&["--view", "2"]), 1, "this is a stereo scene");
}

#[test]
fn what_is_finished_is_kept_until_something_changes() {
    let temporary = folder();
    let [output, json_file, copy] = ["out", "t.json", "copy"].map(|name| temporary.path().join(name));
    fs::create_dir(&copy).unwrap();
    for file in ["left.png", "right.png", "disp_left.pfm"] {
        fs::copy(scene("weak").join(file), copy.join(file)).unwrap();
    }
    // The number of results reused from an earlier run, and all figures.
    let run = |options: &[&str]| {
        let mut command = evaluate(&[&copy, &scene("planes")]);
        command.args(["--condition", "none", "--condition", "gain=0.5+blur=1", "-o"]).arg(&output).args(options);
        let told = command.arg("--json").arg(&json_file).output().unwrap();
        assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
        let told = String::from_utf8(told.stdout).unwrap();
        let kept = told.lines().last().unwrap().split_once("; ").map(|(_, kept)| kept[..6].to_owned());
        (kept, json(&json_file)["pairs"].clone())
    };
    let (kept, first) = run(&[]);
    assert_eq!((kept, first.as_array().unwrap().len()), (None, 4));
    assert_eq!(run(&[]), (Some("4 of 4".into()), first.clone()));
    assert_eq!(run(&["--fresh"]), (None, first.clone()));

    // A missing result, as after an interruption.
    fs::remove_dir_all(output.join("planes/gain=0.5+blur=1")).unwrap();
    assert_eq!(run(&[]), (Some("3 of 4".into()), first.clone()));
    // A saved result changed by hand.
    let saved = output.join("copy/none/result.json");
    let text = fs::read_to_string(&saved).unwrap();
    fs::write(&saved, text.replace("\"fingerprint\": \"", "\"fingerprint\": \"0")).unwrap();
    assert_eq!(run(&[]), (Some("3 of 4".into()), first.clone()));
    let stricter = run(&["--tolerance", "0.5"]);
    assert!(stricter.0.is_none() && stricter.1 != first);
    // With another picture, only the results that depend on it are computed again.
    let mut right = load::load(&copy.join("right.png")).unwrap().luma();
    right.set(0, 0, right.get(0, 0) ^ 1);
    grey_png(&copy.join("right.png"), &right);
    run(&[]);
    fs::copy(scene("weak").join("right.png"), copy.join("right.png")).unwrap();
    assert_eq!(run(&[]).0, Some("2 of 4".into()));
    evaluate(&[&copy]).arg("--fresh").assert().code(2).stderr(contains("--output"));
}
