//! Further pairs that show what people report, if their folder lies beside the project.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hsad::{disparity::NONE, image::Plane, io::disparities};

use crate::run::Run;

/// A folder with a left and a right view, and what must hold for their run.
struct Case {
    folder: &'static str,
    args: &'static [&'static str],
    code: i32,
    /// What the program must say, and what it must not.
    told: &'static [&'static str],
    untold: &'static [&'static str],
    /// Smallest and largest disparity that the range must hold, and ends within which it must lie.
    holds: Option<[i32; 2]>,
    within: Option<[i32; 2]>,
    /// Number of black corners of the left view, where nothing may be found.
    black_corners: usize,
    /// Largest share of the pixels that may be wrong by over 2 px, 0 to 1.
    wrong: f64,
}

const MATCHED: Case = Case {
    folder: "",
    args: &[],
    code: 0,
    told: &[],
    untold: &[],
    holds: None,
    within: None,
    black_corners: 0,
    wrong: 1.0,
};
const DOUBTED: Case = Case { code: 4, ..MATCHED };

const CASES: &[Case] = &[
    Case {
        folder: "bayer",
        told: &["both views are raw Bayer mosaics"],
        within: Some([0, 70]),
        wrong: 0.13,
        ..MATCHED
    },
    Case { folder: "black-borders", black_corners: 2, within: Some([-24, 36]), ..MATCHED },
    Case {
        folder: "cloud-25-km",
        args: &["--focal", "721.54", "--baseline", "0.54"],
        holds: Some([5, 41]),
        within: Some([0, 60]),
        ..MATCHED
    },
    Case { folder: "fence-bars", within: Some([-8, 90]), ..DOUBTED },
    Case {
        folder: "lens-distortion",
        told: &["the lens distorts the pictures", "rectified from its matches"],
        holds: Some([7, 53]),
        within: Some([0, 80]),
        ..MATCHED
    },
    Case { folder: "no-parallax", told: &["the views show no parallax"], ..DOUBTED },
    Case { folder: "one-row-off", untold: &["warning"], within: Some([0, 78]), wrong: 0.05, ..MATCHED },
    Case { folder: "photo-refused", holds: Some([-19, 8]), within: Some([-40, 32]), ..MATCHED },
    Case { folder: "plain-wall", holds: Some([20, 20]), ..DOUBTED },
    Case { folder: "range-defocus-curved", within: Some([0, 80]), ..DOUBTED },
    Case { folder: "range-own-scene-weak", within: Some([8, 70]), wrong: 0.07, ..MATCHED },
    Case { folder: "range-tiled-wall", ..DOUBTED },
    Case { folder: "round-mask", black_corners: 4, holds: Some([25, 66]), within: Some([0, 90]), ..DOUBTED },
    Case { folder: "satellite-16-bit", holds: Some([-31, -4]), within: Some([-40, 8]), ..MATCHED },
    Case { folder: "thermal-16-bit", untold: &["warning"], holds: Some([14, 51]), within: Some([0, 70]), ..MATCHED },
    Case {
        folder: "upside-down-right",
        told: &["turn the right view by 180 degrees", "rectified from its matches"],
        ..MATCHED
    },
    Case {
        folder: "vertical-stereo",
        told: &["the cameras stand above each other: turn both views by 90 degrees", "rectified from its matches"],
        untold: &["clockwise", "larger", "smaller"],
        ..MATCHED
    },
    Case { folder: "wrong-advice", untold: &["lower --min-disparity", "an end of the range"], ..DOUBTED },
];

/// The file of a folder with the name `stem`, whatever its extension.
fn file(folder: &Path, stem: &str) -> Option<PathBuf> {
    let paths = fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    paths.into_iter().find(|path| path.file_stem().is_some_and(|name| name == stem))
}

/// Range, trust and wrong pixels of a finished run, as columns of the table.
fn row(run: &Run, truth: Option<&Plane<f32>>) -> String {
    let range = run.range();
    let range = format!("{}..{}", range.min, range.last());
    let wrong = truth.map_or("unknown".into(), |truth| format!("{:.1} %", 100.0 * run.wrong(truth)));
    format!("{range:<9} {:<5.2} {wrong:<8}", run.trust())
}

/// Number of corners of a map, 9x9 px each, without any disparity and confidence.
fn empty_corners(run: &Run) -> usize {
    let (map, confidence) = (run.disparity(), run.confidence());
    let (right, bottom) = (map.width() - 9, map.height() - 9);
    let corner = |left: u32, top: u32| (0..81).map(move |i| (left + i % 9, top + i / 9));
    let is_empty = |(x, y)| map.get(x, y) == NONE && confidence.get(x, y) == 0;
    [(0, 0), (right, 0), (0, bottom), (right, bottom)].into_iter().filter(|&(x, y)| corner(x, y).all(is_empty)).count()
}

/// What does not hold for a finished run.
fn faults(case: &Case, run: &Run, truth: Option<&Plane<f32>>) -> Vec<String> {
    let mut faults = Vec::new();
    let mut must = |holds: bool, fault: &str| faults.extend((!holds).then(|| fault.to_owned()));
    let range = run.range();
    must(case.holds.is_none_or(|[low, high]| range.min <= low && high <= range.last()), "the range is too short");
    must(empty_corners(run) >= case.black_corners, "something was found in a black corner");
    must(case.within.is_none_or(|[low, high]| low <= range.min && range.last() <= high), "the range is too long");
    if let Some(truth) = truth {
        must(run.outside(truth) < 0.005, "the range does not hold the truth");
        must(run.wrong(truth) <= case.wrong, "more is wrong");
        faults.extend(run.misjudgement(truth));
    }
    faults
}

#[test]
fn shared_cases_stay_as_good_as_they_are() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases");
    if !root.is_dir() {
        eprintln!("skipped: {} is absent", root.display());
        return;
    }
    eprintln!("{:<21} exit {:<9} {:<5} {:<8} said", "case", "range", "trust", "wrong");
    let mut found = Vec::new();
    for case in CASES {
        let folder = root.join(case.folder);
        let [left, right] = ["left", "right"].map(|view| file(&folder, view).expect(case.folder));
        let truth = file(&folder, "disp_left").map(|path| disparities::read(&path).expect("a map"));
        let run = Run::of(&left, &right, case.args);
        let finished = run.has("report.json");
        let row = if finished { row(&run, truth.as_ref()) } else { String::new() };
        eprintln!("{:<21} {:<4} {row:<24} {}", case.folder, run.code, run.told.trim_end().replace('\n', " | "));

        let mut fault = |what: String| found.push(format!("{}: {what}", case.folder));
        if run.code != case.code {
            fault(format!("exit {}, not {}", run.code, case.code));
        }
        case.told
            .iter()
            .filter(|words| !run.told.contains(*words))
            .for_each(|words| fault(format!("'{words}' is not said")));
        case.untold
            .iter()
            .filter(|words| run.told.contains(*words))
            .for_each(|words| fault(format!("'{words}' is said")));
        if finished {
            faults(case, &run, truth.as_ref()).into_iter().for_each(fault);
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}
