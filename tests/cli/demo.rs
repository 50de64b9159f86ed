//! `hsad demo`.

use std::fs;

use hsad::{
    eval::score,
    io::{load, pfm},
};
use predicates::{prelude::PredicateBooleanExt, str::contains};

use crate::common::{folder, hsad, hsad_without_driver, names, report, scene};

#[test]
fn works_anywhere_and_tells_its_accuracy() {
    // The current folder is outside of the project.
    let temporary = folder();
    let told = contains("non-occluded").and(contains("Look at hsad-demo/demo.png"));
    hsad().arg("demo").current_dir(temporary.path()).assert().success().stdout(told);
    assert_eq!(names(temporary.path()), ["hsad-demo"]);
    let out = temporary.path().join("hsad-demo");
    let expected = "cloud.ply confidence.png demo.png depth.pfm depth.png disparity-color.png disparity.pfm disparity.png \
                    keypoints.png left.png matches.png report.json right.png";
    assert_eq!(names(&out).join(" "), expected);
    assert!(fs::read(out.join("left.png")).unwrap() == fs::read(scene("curved", "left.png")).unwrap());
    assert_eq!(load::load(&out.join("demo.png")).unwrap().size(), (3 * 340 + 2 * 8, 255));

    let map = pfm::read_disparities(&out.join("disparity.pfm")).unwrap();
    let truth = pfm::read(&scene("curved", "disp_left.pfm")).unwrap();
    let score = score(&map, &truth, None, &[1.0, 2.0]).unwrap();
    let accuracy = &report(&out)["accuracy"]["all"];
    assert_eq!(accuracy["pixels"], score.known);
    for (bad, reported) in score.bad.iter().zip(accuracy["bad"].as_array().unwrap()) {
        assert_eq!(reported["above_px"], bad.threshold);
        assert!((reported["of_all"].as_f64().unwrap() - bad.of_known).abs() < 1e-9);
        assert!((reported["of_estimated"].as_f64().unwrap() - bad.of_estimated).abs() < 1e-9);
    }
    assert!(score.bad[0].of_estimated < 0.2 && score.coverage() > 0.6, "{score:?}");
}

#[test]
fn without_a_driver_the_cpu_works_and_says_so() {
    let temporary = folder();
    let mut command = hsad_without_driver();
    command.arg("demo").arg("-o").arg(temporary.path());
    let told = contains("the CPU does the work").and(contains("mesa-vulkan-drivers"));
    command.assert().success().stdout(contains("CPU twins")).stderr(told);
}

#[test]
fn quiet_prints_nothing() {
    let temporary = folder();
    let mut command = hsad();
    command.arg("demo").arg("-o").arg(temporary.path()).args(["-q", "--device", "cpu"]);
    command.assert().success().stdout("").stderr("");
    assert!(names(temporary.path()).contains(&"demo.png".into()));
}
