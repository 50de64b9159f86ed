//! Further pairs that show what people report, if their folder is at hand: that of the environment variable `HSAD_CASES`, or
//! `../shared/cases` beside the project.
//!
//! `cargo test --test cases shared -- --nocapture` prints a table: what came out when each was reported, as its `README` tells, and
//! what comes out now.

mod list;

use std::{
    env, fs,
    io::{Write, stderr},
    path::{Path, PathBuf},
};

use hsad::{dense::FILLED, disparity::NONE, image::Plane, io::disparities};

use crate::run::Run;
use list::{CALIBRATIONS, CASES, Case};

/// The folder of the cases. Without one, says so, past what keeps the output of a test that passes.
fn cases() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases");
    let root = env::var_os("HSAD_CASES").map_or_else(beside, PathBuf::from);
    if root.is_dir() {
        return Some(root);
    }
    let told = "NOT RUN: the reported cases, whose folder is absent; HSAD_CASES names another one";
    writeln!(stderr(), "{told}: {}", root.display()).expect("standard error");
    None
}

/// The files of a folder, sorted, without its `README`.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some());
    paths.sort();
    paths
}

/// The left and the right view in a folder: files of these names, or one file for both.
fn views(folder: &Path) -> [PathBuf; 2] {
    let files = files(folder);
    let named = |stem: &str| files.iter().find(|path| path.file_stem().is_some_and(|name| name == stem));
    ["left", "right"].map(|view| named(view).unwrap_or(&files[0]).clone())
}

/// What came out when a case was reported: the line 'Observed' of its `README`, without the warnings.
fn observed(folder: &Path) -> String {
    let text = fs::read_to_string(folder.join("README")).expect("a README");
    let line = text.lines().find_map(|line| line.strip_prefix("Observed: ")).unwrap_or("unknown");
    line.split(", warnings").next().unwrap_or(line).to_owned()
}

/// What comes out of a run now, in the words of [`observed`].
fn now(run: &Run, truth: Option<&Plane<f32>>) -> String {
    if !run.has("report.json") {
        return format!("exit {}", run.code);
    }
    let (range, confidence) = (run.range(), run.confidence());
    let measured = confidence.data().iter().filter(|&&confidence| confidence > FILLED).count() as f64;
    let share = 100.0 * measured / confidence.data().len() as f64;
    let start = format!("exit {}, range {}..{}, trust {:.2}", run.code, range.min, range.last(), run.trust());
    let wrong = truth.map_or(String::new(), |truth| {
        let [half, sure] = run.wrong_of_sure(truth).map(|share| 100.0 * share);
        let all = 100.0 * run.wrong(truth);
        let sure = if sure.is_nan() { "none".into() } else { format!("{sure:.1} %") };
        format!(", wrong by over 2 px: {all:.1} %, of the surer half {half:.1} %, of confidences from 192 {sure}")
    });
    format!("{start}, measured {share:.0} %{wrong}")
}

/// Number of corners of a map, 9x9 px each, without any disparity and confidence.
fn empty_corners(run: &Run) -> usize {
    let (map, confidence) = (run.disparity(), run.confidence());
    let (right, bottom) = (map.width() - 9, map.height() - 9);
    let corner = |left: u32, top: u32| (0..81).map(move |i| (left + i % 9, top + i / 9));
    let is_empty = |(x, y)| map.get(x, y) == NONE && confidence.get(x, y) == 0;
    [(0, 0), (right, 0), (0, bottom), (right, bottom)].into_iter().filter(|&(x, y)| corner(x, y).all(is_empty)).count()
}

/// What does not hold for a run.
fn faults(case: &Case, run: &Run, truth: Option<&Plane<f32>>) -> Vec<String> {
    let mut faults = Vec::new();
    let mut must = |holds: bool, fault: &str| faults.extend((!holds).then(|| fault.to_owned()));
    must(run.code == case.code, "the exit code is another");
    case.told.iter().for_each(|words| must(run.told.contains(words), &format!("'{words}' is not said")));
    case.untold.iter().for_each(|words| must(!run.told.contains(words), &format!("'{words}' is said")));
    if !run.has("report.json") {
        must(false, "there is no report");
        return faults;
    }
    let range = run.range();
    must(case.holds.is_none_or(|[low, high]| range.min <= low && high <= range.last()), "the range is too short");
    must(case.within.is_none_or(|[low, high]| low <= range.min && range.last() <= high), "the range is too long");
    must(empty_corners(run) >= case.black_corners, "something was found in a black corner");
    if let Some(truth) = truth {
        must(run.outside(truth) < 0.005, "the range does not hold the truth");
        must(run.wrong(truth) <= case.wrong, "more is wrong");
        let [_, sure] = run.wrong_of_sure(truth);
        must(sure.is_nan() || sure < 0.02, "high confidences are wrong");
        faults.extend(run.misjudgement(truth));
    }
    faults
}

#[test]
fn shared_cases_stay_as_good_as_they_are() {
    let Some(root) = cases() else { return };
    let mut found = Vec::new();
    for case in CASES {
        let folder = root.join(case.folder);
        let [left, right] = views(&folder);
        let truth = folder.join("disp_left.png");
        let truth = truth.exists().then(|| disparities::read(&truth).expect("a map"));
        // A file with both views is named once.
        let views = if left == right { &[&*left][..] } else { &[&*left, &*right] };
        let run = Run::of_files(views, case.args);
        eprintln!("{}\n  before: {}\n  now:    {}", case.folder, observed(&folder), now(&run, truth.as_ref()));
        run.told.lines().for_each(|line| eprintln!("  said:   {line}"));
        found.extend(faults(case, &run, truth.as_ref()).into_iter().map(|fault| format!("{}: {fault}", case.folder)));
    }
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn shared_calibrations_are_read_or_refused_in_words() {
    let Some(root) = cases() else { return };
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/planes");
    let [left, right] = views(&scene);
    for (file, expected) in CALIBRATIONS {
        let path = root.join("calibrations").join(file);
        let run = Run::of(&left, &right, &["--calib", path.to_str().expect("UTF-8")]);
        match expected {
            Ok(doffs) => {
                let run = run.ends(0, &[]);
                eprintln!("{file}: {}", run.report()["calibration"]);
                assert_eq!(run.report()["calibration"]["doffs_px"].as_f64(), Some(doffs), "{file}");
                assert!(run.has("cloud.ply"), "{file}");
            }
            Err(words) => {
                let run = run.ends(1, &[words]);
                eprintln!("{file}: {}", run.told.trim_end());
                assert!(!run.has("report.json"), "{file}");
            }
        }
    }
}

/// Nothing in the folder is left out.
#[test]
fn shared_cases_are_all_listed() {
    let Some(root) = cases() else { return };
    let mut folders: Vec<String> = fs::read_dir(&root)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_dir())
        .map(|path| path.file_name().expect("a name").to_string_lossy().into_owned())
        .collect();
    folders.sort();
    let mut listed: Vec<&str> = CASES.iter().map(|case| case.folder).chain(["calibrations"]).collect();
    listed.sort_unstable();
    assert_eq!(folders, listed);
    let calibrations = files(&root.join("calibrations"));
    let names: Vec<_> = calibrations.iter().map(|path| path.file_name().expect("a name").to_string_lossy()).collect();
    let mut listed = CALIBRATIONS.map(|(file, _)| file);
    listed.sort_unstable();
    assert_eq!(names, listed);
}
