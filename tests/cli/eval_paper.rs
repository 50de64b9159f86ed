//! `hsad eval paper`.

use std::{
    fs,
    path::{Path, PathBuf},
};

use assert_cmd::Command;
use hsad::{
    disparity::fixed_point,
    image::Plane,
    io::{load, pfm},
};
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;

use crate::common::{fails, folder, grey_png, hsad, names, report, scene as shipped};

/// Writes a part of the shipped scene, small enough for quick tests.
fn part(parent: &Path, name: &str) -> PathBuf {
    let path = parent.join(name);
    fs::create_dir_all(&path).unwrap();
    let part_of = |plane: &Plane<u8>| Plane::from_fn((200, 120), |x, y| plane.get(x + 120, y + 60));
    for file in ["left.png", "right.png", "nonocc.png"] {
        grey_png(&path.join(file), &part_of(&load::load(&shipped("planes", file)).unwrap().luma()));
    }
    let truth = pfm::read(&shipped("planes", "disp_left.pfm")).unwrap();
    let truth = Plane::from_fn((200, 120), |x, y| fixed_point(truth.get(x + 120, y + 60)));
    let mut bytes = Vec::new();
    pfm::write_disparities(&mut bytes, &truth).unwrap();
    fs::write(path.join("disp_left.pfm"), bytes).unwrap();
    path
}

/// `hsad eval paper SCENE... --device cpu`.
fn evaluate(scenes: &[&Path], conditions: &[&str]) -> Command {
    let mut command = hsad();
    command.args(["eval", "paper", "--device", "cpu"]).args(scenes);
    conditions.iter().for_each(|condition| {
        command.args(["--condition", condition]);
    });
    command
}

/// The result of one method under one condition.
fn result<'r>(report: &'r Value, condition: &str, method: &str) -> &'r Value {
    let all = report["results"].as_array().unwrap();
    all.iter().find(|result| result["condition"] == condition && result["method"] == method).unwrap()
}

#[test]
fn curves_agree_with_the_table() {
    let temporary = folder();
    let scene = part(temporary.path(), "part");
    let output = temporary.path().join("out");
    let mut command = evaluate(&[&scene], &["none", "gain=0.8", "rotation=90"]);
    let told = contains("mean of 3").and(contains("mean of 2").not());
    command.arg("-o").arg(&output).assert().success().stdout(told).stderr("");

    let folder = output.join("part");
    let report = report(&folder);
    let expected = ["accuracy", "coverage", "f-measure", "recall-precision"]
        .map(|name| [".csv", ".svg"].map(|end| format!("{name}{end}")));
    let mut expected: Vec<String> = expected.concat();
    expected.extend(["none", "gain=0.8", "rotation=90", "report.json"].map(String::from));
    expected.sort();
    assert_eq!(names(&folder), expected);

    // The last line of each curve equals the table's figures of all answers.
    let columns = [
        ("recall-precision", "condition,method,k,recall,precision", &["recall", "precision"][..]),
        ("f-measure", "condition,method,k,recall,f_measure", &["recall", "f_measure"]),
        ("accuracy", "condition,method,k,accuracy", &["precision"]),
        ("coverage", "condition,method,k,coverage,precision", &["picture_coverage", "picture_precision"]),
    ];
    for (name, header, figures) in columns {
        let text = fs::read_to_string(folder.join(format!("{name}.csv"))).unwrap();
        assert_eq!(text.lines().next().unwrap(), header);
        let done = [("none", "sparse"), ("none", "kamencay"), ("gain=0.8", "balanced"), ("rotation=90", "sparse")];
        for (condition, method) in done {
            let all = result(&report, condition, method);
            let start = format!("{condition},{method},");
            let last: Vec<&str> = text.lines().rfind(|line| line.starts_with(&start)).unwrap().split(',').collect();
            for (figure, value) in figures.iter().zip(&last[3..]) {
                let difference = all[figure].as_f64().unwrap() - value.parse::<f64>().unwrap();
                assert!(difference.abs() < 1e-6, "{name}, {condition}, {method}: {difference}");
            }
            if name != "coverage" {
                assert_eq!(all["answers"].as_f64().unwrap().to_string(), last[2]);
            }
        }
        assert!(text.contains("\nmean of 3,kamencay,1,") && text.contains("\nmean of 3,sparse,1,"));
        assert!(text.contains("\nrotation=90,kamencay,1,") && text.contains("\nrotation=90,balanced,1,"));
        let plot = fs::read_to_string(folder.join(format!("{name}.svg"))).unwrap();
        assert!(plot.starts_with("<svg") && plot.contains("gain=0.8") && plot.contains("#D55E00"));
    }

    // All methods match the same points, and each is good under an easy condition.
    for condition in ["none", "gain=0.8"] {
        let points = &result(&report, condition, "sparse")["points"];
        for method in ["sparse", "kamencay", "balanced"] {
            let found = result(&report, condition, method);
            assert_eq!(&found["points"], points);
            let figure = |name: &str| found[name].as_f64().unwrap();
            assert!(figure("precision_of_10") >= 0.9 && figure("precision") > 0.7, "{method}: {found}");
            assert!(
                figure("recall") > 0.05 && figure("recall") <= 1.0 && figure("coverage") <= 1.0,
                "{method}: {found}"
            );
        }
    }
    // A turned view is rectified by its matches: as good as before, at the points that it still shows.
    let turned = result(&report, "rotation=90", "balanced");
    assert!(turned["precision_of_100"].as_f64().unwrap() > 0.9 && turned["recall"].as_f64().unwrap() > 0.5, "{turned}");
}

#[test]
fn what_is_finished_is_kept_until_something_changes() {
    let temporary = folder();
    let scene = part(temporary.path(), "part");
    let output = temporary.path().join("out");
    let run = |args: &[&str]| -> (Option<String>, Value) {
        let mut command = evaluate(&[&scene], &["none", "rotation=90"]);
        let out = command.arg("-o").arg(&output).args(args).assert().success().get_output().stdout.clone();
        let out = String::from_utf8(out).unwrap();
        let told = out.lines().find(|line| line.starts_with("curves and plots are in ")).unwrap();
        let kept = told.split_once("; ").map(|(_, kept)| kept[..1].into());
        (kept, report(&output.join("part"))["results"].clone())
    };
    let (kept, first) = run(&[]);
    assert_eq!(kept, None);
    assert_eq!(run(&[]), (Some("6".into()), first.clone()));

    // A missing result, as after an interruption.
    fs::remove_dir_all(output.join("part/none/balanced")).unwrap();
    let file = output.join("part/rotation=90/sparse/result.json");
    let broken = fs::read_to_string(&file).unwrap().replace("\"right\"", "\"left\"");
    fs::write(&file, broken).unwrap();
    let (kept, again) = run(&[]);
    assert_eq!(kept, Some("4".into()));
    let without_times = |results: &Value| -> Vec<Value> {
        let mut results = results.as_array().unwrap().clone();
        results.iter_mut().for_each(|result| result["seconds"] = Value::Null);
        results
    };
    assert_eq!(without_times(&again), without_times(&first));

    let (kept, stricter) = run(&["--tolerance", "0.1"]);
    assert_eq!(kept, None);
    let precision = |results: &Value| results[0]["precision"].as_f64().unwrap();
    assert!(precision(&stricter) < precision(&first));
}

#[test]
fn what_fails_loses_nothing_else() {
    let temporary = folder();
    let scene = part(temporary.path(), "part");
    let output = temporary.path().join("out");
    // A file stands in place of the output folder of one result.
    fs::create_dir_all(output.join("part/none")).unwrap();
    fs::write(output.join("part/none/kamencay"), "mine").unwrap();
    let mut command = evaluate(&[Path::new("/nonexistent/scene"), &scene], &["none"]);
    let complaint = contains("error: /nonexistent/scene").and(contains("error: part, none, kamencay: "));
    let told = contains("sparse").and(contains("balanced")).and(contains("kamencay"));
    command.arg("-o").arg(&output).assert().code(1).stdout(told).stderr(complaint);
    let report = report(&output.join("part"));
    // The result that could not be saved is reported all the same.
    assert_eq!(report["results"].as_array().unwrap().len(), 3);
    assert!(report["failed"][0].as_str().unwrap().starts_with("part, none, kamencay: "));
}

#[test]
fn bad_input_is_named() {
    let temporary = folder();
    let scene = part(temporary.path(), "part");
    let with = |args: &[&str]| {
        let mut command = evaluate(&[&scene], &[]);
        command.args(args);
        command
    };
    fails(with(&["--tolerance", "-1"]), 2, "tolerance is -1, but it must be a number of pixels from 0 up");
    fails(with(&["--condition", "fog"]), 2, "there are only: gain, gamma");
    fails(with(&["--condition", "noise=101"]), 2, "its strength must be 0 to 100");
    fails(evaluate(&[&scene, &scene], &["none"]), 2, "the name of two scenes, 'part'");
    let mut elsewhere = evaluate(&[], &["none"]);
    elsewhere.current_dir(temporary.path());
    fails(elsewhere, 2, "name a scene");
    fails(evaluate(&[temporary.path().join("part/left.png").as_path()], &["none"]), 1, "a scene is a folder with");
    evaluate(&[&scene], &["none"]).arg("--fresh").assert().code(2).stderr(contains("--output"));
}
