//! What the page makes of a result: files, confidences, rectified pairs.

use std::{
    fs,
    path::Path,
    process::Command,
    thread,
    time::{Duration, Instant},
};

use hsad::{Backend, config::Preset, gpu::DeviceChoice, pipeline};
use serde_json::Value;

use super::{Browser, choose_preset, example};

/// Longest time of a download.
const PATIENCE: Duration = Duration::from_secs(60);

/// Files are saved by their buttons. Those of maps, depth and points have the bytes that `hsad match` writes, and the report has the
/// same entries, of which those that times, devices and names have no part in are equal.
pub fn are_saved_as_the_command_saves_them(browser: &mut Browser) {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["command", "page"] {
        fs::create_dir(path(name)).unwrap();
    }
    command(folder.path());

    choose_preset(browser, "balanced");
    browser.wait_for("done");
    browser.evaluate("delete document.body.dataset.state; document.getElementById('example').click()");
    browser.wait_for("done");
    browser.download_to(&path("page"));
    let names = [
        "disparity.pfm",
        "disparity.png",
        "disparity-color.png",
        "confidence.png",
        "depth.pfm",
        "depth.png",
        "cloud.ply",
    ];
    for (index, name) in names.iter().chain(["report.json"].iter()).enumerate() {
        browser.evaluate(&format!("document.querySelectorAll('#save button')[{index}].click()"));
        let start = Instant::now();
        // The browser gives a file its name when all of it is there.
        while !path("page").join(name).exists() {
            assert!(start.elapsed() < PATIENCE, "{name} is not saved: {:?}", browser.complaints);
            thread::sleep(Duration::from_millis(20));
        }
    }
    let read = |place: &str, name: &str| fs::read(path(place).join(name)).unwrap();
    for name in names {
        assert!(read("page", name) == read("command", name), "{name} is not that of the command");
    }
    let [page, command] =
        ["page", "command"].map(|place| serde_json::from_slice::<Value>(&read(place, "report.json")).unwrap());
    let entries = |report: &Value| report.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(entries(&page), entries(&command));
    for entry in [
        "version",
        "width",
        "height",
        "stretch",
        "calibration",
        "depth_png",
        "cloud",
        "rectified",
        "mapped_back",
        "not_trusted",
        "disparity_png",
        "warnings",
        "repetition",
        "mosaics",
        "range",
        "levels",
        "equalised",
        "unseen",
        "no_depth",
        "coverage",
        "measured",
        "filled",
    ] {
        assert_eq!(page[entry], command[entry], "{entry}");
    }
    assert_eq!(page["parameters"]["aggregation"], command["parameters"]["aggregation"]);
    let files = |report: &Value| {
        let mut files: Vec<String> = serde_json::from_value(report["files"].clone()).unwrap();
        files.sort();
        files
    };
    assert_eq!(files(&page), files(&command));
}

/// The files of the example by the command.
fn command(folder: &Path) {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/planes");
    let meta: Value = serde_json::from_slice(&fs::read(data.join("meta.json")).unwrap()).unwrap();
    let calibration = folder.join("calib.txt");
    fs::write(&calibration, meta["calib_txt"].as_str().unwrap()).unwrap();
    let mut hsad = Command::new(env!("CARGO_BIN_EXE_hsad"));
    hsad.arg("match").args(["left.png", "right.png"].map(|name| data.join(name)));
    hsad.args(["-q", "-o"]).arg(folder.join("command")).arg("--calib").arg(calibration);
    assert!(hsad.status().unwrap().success());
}

/// The map shows confidences as grey values.
pub fn show_confidences(browser: &mut Browser) {
    let shown = "(() => {
        const map = document.getElementById('disparity');
        const { data } = map.getContext('2d').getImageData(0, 0, map.width, map.height);
        return data.every((value, index) => value === (index % 4 === 3 ? 255 : result.confidences[index >> 2]));
    })()";
    assert_eq!(browser.evaluate(shown), false, "confidences are shown unasked");
    browser.evaluate("document.querySelector('input[value=confidence]').click()");
    assert_eq!(browser.evaluate(shown), true, "confidences are not shown");
    assert_eq!(browser.evaluate("document.getElementById('near').textContent"), "255 sure");
    browser.evaluate("document.querySelector('input[value=disparity]').click()");
}

/// What trust means is told next to it.
pub fn explain_trust(browser: &mut Browser) {
    browser.evaluate("document.querySelector('.help-text summary').click()");
    let facts = browser.evaluate("document.getElementById('facts').innerText");
    let facts = facts.as_str().unwrap();
    assert!(facts.contains("How far the map can be believed") && facts.contains("255 is sure"), "{facts}");
}

/// A pair whose rows are off by 40 px is rectified from its matches, and the page says so.
pub fn rectify_what_is_not(browser: &mut Browser) {
    browser.evaluate("choose('left', [view('left'), view('right', 40)])");
    browser.wait_for("done");
    assert_eq!(browser.evaluate("result.rectified"), "matches");
    let doubts = browser.evaluate("document.getElementById('doubts').innerText");
    assert!(doubts.as_str().unwrap().contains("40.0 px"), "{doubts}");
    assert_eq!(browser.evaluate("result.files.includes('cloud.ply')"), false, "depth without a camera");
    // The first rows of the moved view show nothing, and most of the others are matched.
    let [left, right] = example();
    let backend = Backend::open(&DeviceChoice::Best).unwrap_or(Backend::Cpu);
    let level = pipeline::run(&backend, (&left, &right), &Preset::Balanced.config(), |_| ()).unwrap();
    let measured = browser.evaluate("result.measured").as_f64().unwrap();
    assert!(measured > 0.7 * level.dense.measured(), "{measured} of the pixels are measured");

    browser.evaluate("choose('left', [view('left'), view('left')])");
    browser.wait_for("done");
    let doubts = browser.evaluate("document.getElementById('doubts').innerText");
    assert!(doubts.as_str().unwrap().contains("no parallax"), "{doubts}");
}
