//! `hsad batch`.

use std::{
    fs,
    path::{Path, PathBuf},
};

use assert_cmd::assert::Assert;
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;

use crate::common::{folder, grey_png, hsad, names, noise, views};

/// A part of a shipped scene, from row `row` on, as two pictures in `folder`.
fn small_pair(folder: &Path, name: &str, row: u32) -> [PathBuf; 2] {
    let both = ["left", "right"].map(|side| folder.join(side).join(format!("{name}.png")));
    for (path, view) in both.iter().zip(views("planes")) {
        let picture = hsad::io::load::load(&view).expect("a shipped view").luma();
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        let size = (picture.width(), picture.height() - 40);
        grey_png(path, &hsad::image::Plane::from_fn(size, |x, y| picture.get(x, y + row)));
    }
    both
}

fn batch(arguments: &[&str], output: &Path) -> Assert {
    let mut command = hsad();
    command.arg("batch").args(arguments).arg("-o").arg(output).assert()
}

/// The records of a journal, in the order of the names.
pub fn records(journal: &Path) -> Vec<Value> {
    let text = fs::read_to_string(journal).expect("a journal");
    let mut records: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    records.sort_by_key(|record| record["name"].to_string());
    records
}

pub fn statuses(journal: &Path) -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().expect("a text").to_owned();
    records(journal).iter().map(|record| (text(&record["name"]), text(&record["status"]))).collect()
}

pub fn of(pairs: &[(&str, &str)]) -> Vec<(String, String)> {
    pairs.iter().map(|&(name, status)| (name.into(), status.into())).collect()
}

#[test]
fn every_pair_has_the_files_of_match_and_bad_ones_are_passed_over() {
    let temporary = folder();
    let root = temporary.path();
    let [left, right] = small_pair(root, "a", 0);
    small_pair(root, "b", 40);
    grey_png(&root.join("noise.png"), &noise(340, 215, 3));
    fs::write(root.join("broken.png"), "no picture").unwrap();
    let list = root.join("pairs.csv");
    let rows = "left,right,name\nleft/a.png,right/a.png,\nbroken.png,right/a.png,broken\nleft/b.png,right/b.png,deep/b\n\
                left/a.png,gone.png,gone\nnoise.png,right/a.png,unrelated\n";
    fs::write(&list, rows).unwrap();
    let (list, out) = (list.to_str().unwrap(), root.join("out"));
    let told =
        batch(&[list, "--disparities", "64", "--jobs", "2"], &out).code(1).stderr(contains("2 of 5 pairs failed"));
    // Standard output, which is no terminal, has the records as they come.
    let printed = String::from_utf8(told.get_output().stdout.clone()).unwrap();
    assert_eq!(printed, fs::read_to_string(out.join("report.jsonl")).unwrap());
    let journal = out.join("report.jsonl");
    let expected =
        [("a", "done"), ("broken", "failed"), ("deep/b", "done"), ("gone", "failed"), ("unrelated", "doubtful")];
    assert_eq!(statuses(&journal), of(&expected));
    let all = records(&journal);
    assert_eq!((&all[1]["exit_code"], &all[4]["exit_code"]), (&1.into(), &4.into()));
    assert!(all[3]["reason"].as_str().unwrap().contains("gone.png: No such file"), "{}", all[3]);
    assert!(!out.join("broken").exists() && !out.join("gone").exists());

    let single = root.join("single");
    hsad().arg("match").args([&left, &right]).args(["--disparities", "64", "-o"]).arg(&single).assert().success();
    assert_eq!(names(&single), names(&out.join("a")));
    for file in names(&single).iter().filter(|name| *name != "report.json") {
        assert_eq!(fs::read(single.join(file)).unwrap(), fs::read(out.join("a").join(file)).unwrap(), "{file}");
    }
}

#[test]
fn a_batch_goes_on_where_it_ended() {
    let temporary = folder();
    let root = temporary.path();
    for (number, name) in ["9", "10", "11"].into_iter().enumerate() {
        small_pair(root, name, 10 * number as u32);
    }
    let patterns = ["left", "right"].map(|side| root.join(side).join("*.png").display().to_string());
    let out = root.join("out");
    let run = |more: &[&str]| {
        let arguments = ["--left", &patterns[0], "--right", &patterns[1], "--preset", "fast", "-q", "--jobs", "1"];
        batch(&[&arguments[..], more].concat(), &out)
    };
    run(&[]).success().stdout("").stderr("");
    let journal = out.join("report.jsonl");
    let whole = fs::read_to_string(&journal).unwrap();
    // In the order of the numbers.
    let order: Vec<String> =
        whole.lines().map(|line| serde_json::from_str::<Value>(line).unwrap()["name"].to_string()).collect();
    assert_eq!(order, ["\"9\"", "\"10\"", "\"11\""]);

    // Killed while the second record was written: the second pair's files are in their place, the third pair has not begun.
    let line = whole.find('\n').unwrap() + 1;
    fs::write(&journal, &whole[..line + 30]).unwrap();
    fs::remove_dir_all(out.join("11")).unwrap();
    let written = |name: &str| fs::metadata(out.join(name).join("disparity.pfm")).unwrap().modified().unwrap();
    let before = ["9", "10"].map(written);
    run(&[]).code(1).stderr(contains("--resume"));
    fs::write(out.join(".hsad-kiLLed"), "half").unwrap();
    run(&["--resume"]).success();
    assert_eq!(out.join(".hsad-kiLLed").exists(), cfg!(not(unix)), "what the killed run left is removed");
    assert_eq!(["9", "10"].map(written), before, "nothing is redone");
    assert_eq!(statuses(&journal), of(&[("10", "done"), ("11", "done"), ("9", "done")]));
    assert_eq!(
        records(&journal)[0]["trust"],
        serde_json::from_str::<Value>(whole.lines().nth(1).unwrap()).unwrap()["trust"]
    );
    run(&["--resume", "--uniqueness", "30"]).code(1).stderr(contains("with other options"));
    let finished = fs::read(&journal).unwrap();
    run(&["--resume"]).success();
    assert_eq!(fs::read(&journal).unwrap(), finished);
    // What was removed since is made again, whole or in part.
    fs::remove_dir_all(out.join("9")).unwrap();
    fs::remove_file(out.join("10/confidence.png")).unwrap();
    fs::remove_file(out.join("11/report.json")).unwrap();
    fs::remove_file(out.join("11/confidence.png")).unwrap();
    // Not among the files of such a pair.
    fs::write(out.join("11/cloud.ply"), "mine").unwrap();
    let before = written("11");
    run(&["--resume"]).success();
    assert!(out.join("9/disparity.pfm").exists() && out.join("10/confidence.png").exists());
    assert!(written("11") > before && out.join("11/report.json").exists(), "one set");
    assert_eq!(fs::read_to_string(out.join("11/cloud.ply")).unwrap(), "mine");
    fs::remove_file(out.join("11/report.json")).unwrap();
    fs::rename(&journal, root.join("journal")).unwrap();
    run(&["--resume"]).code(1).stderr(contains("1 of 3 pairs failed"));
    fs::rename(root.join("journal"), &journal).unwrap();
    run(&["--resume"]).success();

    // The same name for other pictures.
    let list = root.join("others.csv");
    fs::write(&list, "name,left,right\n9,left/10.png,right/10.png\n").unwrap();
    batch(&[list.to_str().unwrap(), "--preset", "fast", "-q", "--resume"], &out)
        .code(1)
        .stderr(contains("'9' of this folder are of other inputs"));

    // What failed is tried again.
    fs::rename(root.join("left/9.png"), root.join("9.png")).unwrap();
    fs::write(root.join("left/9.png"), "no picture").unwrap();
    let other = root.join("other");
    let again = |code: i32| {
        let arguments = ["--left", &patterns[0], "--right", &patterns[1], "--preset", "fast", "-q", "--resume"];
        batch(&arguments, &other).code(code);
    };
    again(1);
    fs::rename(root.join("9.png"), root.join("left/9.png")).unwrap();
    again(0);
    let last = fs::read_to_string(other.join("report.jsonl")).unwrap();
    assert!(last.lines().last().unwrap().starts_with("{\"name\":\"9\",\"status\":\"done\""), "{last}");
}

#[test]
fn results_belong_to_inputs_and_not_to_their_names() {
    let temporary = folder();
    let root = temporary.path();
    let calibration = |focal: u32| {
        let camera = format!("[{focal} 0 170; 0 {focal} 107; 0 0 1]");
        format!("cam0={camera}\ncam1={camera}\ndoffs=0\nbaseline=100\nwidth=340\nheight=215\n")
    };
    for (place, row) in [("one", 0), ("two", 30)] {
        small_pair(&root.join(place), "a", row);
        fs::write(root.join(place).join("calib.txt"), calibration(300)).unwrap();
        fs::write(root.join(place).join("pairs.csv"), "left,right,calib\nleft/a.png,right/a.png,calib.txt\n").unwrap();
    }
    let out = root.join("out");
    let run = |list: &str, more: &[&str]| {
        let list = root.join(list);
        batch(&[&[list.to_str().unwrap(), "--preset", "fast", "--rectify", "never", "-q"], more].concat(), &out)
    };
    run("one/pairs.csv", &[]).success();
    let map = || fs::read(out.join("a/depth.pfm")).unwrap();
    let first = map();
    let written = || fs::metadata(out.join("a/report.json")).unwrap().modified().unwrap();
    let before = written();
    let record = &records(&out.join("report.jsonl"))[0];
    assert!(Path::new(record["inputs"]["calib"]["path"].as_str().unwrap()).is_absolute(), "{record}");

    // The same inputs by other paths, and a file that was written again.
    let spelled =
        format!("left,right,calib\n./two/../one/left/a.png,{0}/one/right/a.png,one/calib.txt\n", root.display());
    fs::write(root.join("spelled.csv"), spelled).unwrap();
    fs::write(root.join("one/calib.txt"), calibration(300)).unwrap();
    run("spelled.csv", &["--resume"]).success();
    assert!(written() == before, "nothing is redone");
    // Other ones by the same words.
    run("two/pairs.csv", &["--resume"]).code(1).stderr(contains("two/left/a.png has changed or is another one"));
    fs::write(root.join("one/calib.txt"), calibration(600)).unwrap();
    run("one/pairs.csv", &["--resume"]).code(1).stderr(contains("one/calib.txt has changed").and(contains("out/a")));
    assert!(written() == before, "nothing is replaced");
    fs::remove_dir_all(out.join("a")).unwrap();
    run("one/pairs.csv", &["--resume"]).success();
    assert!(map() != first, "depths are those of the other calibration");
    // What another journal has recorded, or a run that was killed before it could, is not replaced either.
    fs::write(root.join("one/calib.txt"), calibration(300)).unwrap();
    let told = || contains("one/calib.txt has changed").and(contains("out/a"));
    run("one/pairs.csv", &["--shard", "0/1"]).code(1).stderr(told());
    fs::write(out.join("report.jsonl"), "").unwrap();
    run("one/pairs.csv", &["--resume"]).code(1).stderr(told());
    let report = fs::read_to_string(out.join("a/report.json")).unwrap();
    fs::write(out.join("a/report.json"), report.replace("\"inputs\"", "\"other\"")).unwrap();
    run("one/pairs.csv", &["--resume"]).code(1).stderr(contains("'a' of this folder do not tell their inputs"));
    fs::write(out.join("a/report.json"), report).unwrap();
    #[cfg(unix)]
    {
        let link = root.join("link.png");
        std::os::unix::fs::symlink("gone.png", &link).unwrap();
        fs::write(root.join("link.csv"), "name,left,right\na,link.png,link.png\n").unwrap();
        run("link.csv", &["--resume"]).code(1).stderr(contains("link.png is gone. Bring it back"));
    }
    assert!(map() != first, "nothing is replaced");
    fs::remove_dir_all(out.join("a")).unwrap();
    run("one/pairs.csv", &["--resume"]).success();
    assert!(map() == first);

    // What the options name belongs to the batch.
    let (list, out) = (root.join("gone.csv"), root.join("gone"));
    fs::write(&list, "left,right\ngone.png,gone.png\n").unwrap();
    let run = |more: &[&str]| batch(&[&[list.to_str().unwrap(), "-q", "--device", "cpu"], more].concat(), &out).code(1);
    let path = root.join("one/calib.txt").display().to_string();
    run(&["--calib", &path]).stderr(contains("1 of 1 pairs failed"));
    let other = path.replace("/one/", "/./one/");
    run(&["--calib", &other, "--resume"]).stderr(contains("1 of 1 pairs failed"));
    fs::write(&path, calibration(600)).unwrap();
    run(&["--calib", &path, "--resume"]).stderr(contains("with other options"));
}

#[test]
fn shares_of_a_batch_meet_in_one_folder() {
    let temporary = folder();
    let root = temporary.path();
    for (number, name) in ["1", "2", "3"].into_iter().enumerate() {
        small_pair(root, name, 10 * number as u32);
    }
    let (tree, out) = (root.to_str().unwrap(), root.join("out"));
    for share in ["0/2", "1/2"] {
        batch(&[tree, "--disparities", "64", "--shard", share], &out).success();
    }
    assert_eq!(statuses(&out.join("report-0-of-2.jsonl")), of(&[("1", "done"), ("3", "done")]));
    assert_eq!(statuses(&out.join("report-1-of-2.jsonl")), of(&[("2", "done")]));
    assert_eq!(names(&out), ["1", "2", "3", "batch.json", "report-0-of-2.jsonl", "report-1-of-2.jsonl"]);
}

#[test]
fn what_is_no_batch_is_told() {
    let temporary = folder();
    let root = temporary.path();
    let out = root.join("out");
    let [left, _] = views("planes");
    let fails = |arguments: &[&str], code: i32, told: &str| {
        batch(arguments, &out).code(code).stdout("").stderr(contains(told));
        assert!(!out.exists(), "{arguments:?}");
    };
    fails(&[], 2, "required");
    fails(&["--left", "a*.png"], 2, "--right");
    fails(&[left.to_str().unwrap()], 1, "neither a folder nor a list of pairs");
    fails(&[root.to_str().unwrap()], 1, "no pairs: expected folders image_2");
    for gone in ["gone.csv", "gone", "gone.y4m", "gone.mcap"] {
        fails(&[gone], 1, &format!("{gone}: no such file or folder"));
    }
    fails(&[root.to_str().unwrap(), "--no-camera-info"], 1, "--no-camera-info is about a recording");
    fails(&["gone.csv", "--shard", "2/2"], 2, "I from 0 to N-1");
    fails(&["gone.csv", "--window", "4"], 2, "window");
    let list = root.join("pairs.csv");
    fs::write(&list, "left,right,name\na.png,b.png,x\nc.png,d.png,x\n").unwrap();
    fails(&[list.to_str().unwrap()], 1, "have the same name 'x'");
    fs::write(&list, "left,right,name\na.png,b.png,x\n").unwrap();
    let pairs = list.to_str().unwrap();
    for (arguments, told) in [
        (&["--mesh"][..], "--mesh is given, but without a calibration there is no point cloud"),
        (&["--filled"], "--filled is given, but without a calibration"),
        (&["--max-depth", "9"], "--max-depth is 9, but without a calibration"),
        (&["--rectify", "calibrated"], "--rectify is calibrated, but it needs the calibration"),
        (
            &["--rectify", "calibrated", "--focal", "300", "--baseline", "0.1"],
            "needs the calibration of the pair as it was taken",
        ),
        (&["--max-depth", "0", "--focal", "300", "--baseline", "0.1"], "the largest depth is 0, but"),
        (&["--rectify", "uncalibrated", "--focal", "300", "--baseline", "0.1"], "leave the calibration out"),
    ] {
        fails(&[&[pairs], arguments].concat(), 2, told);
    }
    let junk = root.join("junk").display().to_string();
    fs::write(&junk, "junk").unwrap();
    for (arguments, told) in [
        (["--calib", "gone.txt"], "gone.txt: No such file"),
        (["--mask", "gone.png"], "gone.png: No such file"),
        (["--calib", &junk], "junk: the file has no calibration that hsad knows"),
        (["--mask", &junk], "junk: "),
        (["--side-by-side", "left-right"], "every pair has a right view of its own"),
    ] {
        fails(&[&[pairs], &arguments[..]].concat(), 1, told);
    }
    fs::write(&list, "left,right,name\na.png,b.png,../x\n").unwrap();
    fails(&[list.to_str().unwrap()], 1, "is no folder in the output folder");
    fs::write(&list, "left,right\n").unwrap();
    fails(&[list.to_str().unwrap()], 1, "no pairs");
    // Names are told as they can be shown, and stand in records as they are.
    fs::write(&list, "left,right,name\na.png,b.png,\"x\x1b[2J\"\n").unwrap();
    let told = batch(&[list.to_str().unwrap(), "--device", "cpu"], &out).code(1);
    assert!(String::from_utf8_lossy(&told.get_output().stderr).contains("failed x\\u{1b}[2J: "), "{told:?}");
    assert_eq!(records(&out.join("report.jsonl"))[0]["name"], "x\x1b[2J");
}

#[test]
fn frames_follow_one_another_alike_in_one_run_in_shares_and_after_an_interruption() {
    let temporary = folder();
    let root = temporary.path();
    for number in 0..6 {
        let [_, right] = small_pair(root, &number.to_string(), 4 * number);
        if number >= 2 {
            // The right camera's exposure changes.
            let view = hsad::io::load::load(&right).unwrap().luma();
            grey_png(&right, &view.map(|&level| (u16::from(level) * 3 / 4) as u8));
        }
    }
    let run = |name: &str, more: &[&str]| {
        let arguments = ["--temporal", "4", "-q"];
        batch(&[&[root.to_str().unwrap()], &arguments[..], more].concat(), &root.join(name)).success();
    };
    let maps = |name: &str| {
        let map = |number: u32| fs::read(root.join(name).join(number.to_string()).join("disparity.pfm")).unwrap();
        (0..6).map(map).collect::<Vec<_>>()
    };
    run("whole", &["--jobs", "2"]);
    let journal = root.join("whole/report.jsonl");
    let follows: Vec<Value> = records(&journal).iter().map(|record| record["follows"].clone()).collect();
    assert_eq!(
        follows,
        [false, true, false, true, false, true],
        "frames 0 and 4 begin, and frame 2 shows another exposure"
    );
    let whole = maps("whole");

    for share in ["0/2", "1/2"] {
        run("shares", &["--shard", share]);
    }
    assert_eq!(records(&root.join("shares/report-1-of-2.jsonl")).len(), 2, "frames 4 and 5");
    assert!(maps("shares") == whole);

    // Killed while frame 3 was written: frames 0 to 2 are in their place, and so is frame 4.
    let out = root.join("killed");
    run("killed", &["--jobs", "1"]);
    let text = fs::read_to_string(out.join("report.jsonl")).unwrap();
    let kept: String = text
        .lines()
        .filter(|line| !["3", "5"].iter().any(|name| line.contains(&format!("\"name\":\"{name}\""))))
        .fold(String::new(), |all, line| all + line + "\n");
    fs::write(out.join("report.jsonl"), kept).unwrap();
    for number in ["3", "5"] {
        fs::remove_dir_all(out.join(number)).unwrap();
    }
    let written = |number: &str| fs::metadata(out.join(number).join("report.json")).unwrap().modified().unwrap();
    let before = ["0", "1", "2", "4"].map(written);
    run("killed", &["--resume"]);
    assert_eq!(["0", "1", "2", "4"].map(written), before, "nothing is redone");
    assert!(maps("killed") == whole);
    let report: Value = serde_json::from_slice(&fs::read(out.join("3/report.json")).unwrap()).unwrap();
    assert_eq!((&report["follows"], &report["features"]["left"]), (&true.into(), &0.into()));
    batch(&[root.to_str().unwrap(), "--temporal", "4", "--figures"], &root.join("none")).code(2);

    // What frame 3 follows is finished, and its pictures are gone.
    fs::write(
        out.join("report.jsonl"),
        fs::read_to_string(out.join("report.jsonl")).unwrap().replace("\"3\"", "\"x\""),
    )
    .unwrap();
    fs::remove_dir_all(out.join("3")).unwrap();
    let rows = (0..6)
        .fold("left,right\n".to_owned(), |rows, number| rows + &format!("left/{number}.png,right/{number}.png\n"));
    let list = root.join("frames.csv");
    fs::write(&list, rows).unwrap();
    fs::remove_file(root.join("right/2.png")).unwrap();
    batch(&[list.to_str().unwrap(), "--temporal", "4", "-q", "--resume"], &out)
        .code(1)
        .stderr(contains("1 of 6 pairs failed"));
    let last = records(&out.join("report.jsonl")).into_iter().find(|record| record["name"] == "3").unwrap();
    let reason = last["reason"].as_str().unwrap();
    assert!(reason.starts_with("the frame '2', which this one follows, cannot be matched again: "), "{reason}");
    assert!(reason.contains("right/2.png") && !out.join("3").exists(), "{reason}");
}

/// Frames with both views side by side, grey levels as they are.
fn video(frames: &[[PathBuf; 2]]) -> Vec<u8> {
    let views: Vec<_> =
        frames.iter().map(|both| both.each_ref().map(|view| hsad::io::load::load(view).unwrap().luma())).collect();
    let (width, height) = (views[0][0].width(), views[0][0].height());
    let mut bytes = format!("YUV4MPEG2 W{} H{height} F25:1 Ip Cmono XCOLORRANGE=FULL\n", 2 * width).into_bytes();
    for [left, right] in &views {
        bytes.extend(b"FRAME\n");
        (0..height).for_each(|y| bytes.extend([left.row(y), right.row(y)].concat()));
    }
    bytes
}

#[test]
fn frames_of_a_video_are_pairs() {
    let temporary = folder();
    let root = temporary.path();
    let frames = ["a", "b"].map(|name| small_pair(root, name, if name == "a" { 0 } else { 30 }));
    let bytes = video(&frames);
    let single = root.join("single");
    hsad().arg("match").args(&frames[1]).args(["-q", "--disparities", "64", "-o"]).arg(&single).assert().success();
    let options = ["batch", "--side-by-side", "left-right", "--disparities", "64", "-o"];
    let is_second = |out: &Path| {
        fs::read(out.join("000002/disparity.pfm")).unwrap() == fs::read(single.join("disparity.pfm")).unwrap()
    };

    let piped = root.join("piped");
    hsad().args(options).arg(&piped).arg("-").write_stdin(bytes.clone()).assert().success();
    assert_eq!(statuses(&piped.join("report.jsonl")), of(&[("000001", "done"), ("000002", "done")]));
    assert!(is_second(&piped));
    let other = video(&[frames[1].clone(), frames[0].clone()]);
    let resumed = hsad().args(options).arg(&piped).args(["-", "--resume"]).write_stdin(other).assert();
    resumed.failure().stderr(contains("other inputs"));

    // What was there of a video that is cut off is matched, and goes on when the rest is there.
    let (file, out) = (root.join("video.y4m"), root.join("out"));
    fs::write(&file, &bytes[..bytes.len() - 9]).unwrap();
    let run = |more: &str| hsad().args(options).arg(&out).arg(&file).args((!more.is_empty()).then_some(more)).assert();
    run("").code(1).stderr(contains("after frame 1: the video is cut off").and(contains("1 pairs: 1 done")));
    assert_eq!(statuses(&out.join("report.jsonl")), of(&[("000001", "done")]));
    let written = || fs::metadata(out.join("000001/report.json")).unwrap().modified().unwrap();
    let before = written();
    fs::write(&file, &bytes).unwrap();
    run("--resume").success();
    assert!(written() == before && is_second(&out));
    hsad().args(["batch", "-o"]).arg(root.join("none")).arg(&file).assert().code(1).stderr(contains("--side-by-side"));
    let empty = hsad().args(options).arg(root.join("empty")).arg("-").write_stdin("YUV4MPEG2 W2 H1\n").assert();
    empty.code(1).stderr(contains("-: no pairs"));
}
