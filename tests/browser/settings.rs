//! What the page is told besides two pictures: files with both views, ranges, cameras, and that it shall stop.

use std::{fs, thread, time::Duration};

use hsad::{
    Options,
    io::{Picture, png},
};

use serde_json::json;

use super::{Browser, choose_preset, example, is_computed_here};

/// Sets a field, as someone does who types.
fn fill(browser: &mut Browser, id: &str, value: &str) {
    browser.evaluate(&format!(
        "delete document.body.dataset.state;
        {{ const field = document.getElementById('{id}'); field.value = '{value}'; field.dispatchEvent(new Event('change')); }}"
    ));
}

/// Both views beside each other in one picture, the right one first.
pub fn take_both_views_from_one_file(browser: &mut Browser) {
    let [left, right] = example();
    let width = left.width();
    let both =
        Picture::from_fn(
            (2 * width, left.height()),
            |x, y| {
                if x < width { right.get(x, y) } else { left.get(x - width, y) }
            },
        );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("both.png");
    let mut bytes = Vec::new();
    png::write_rgba8(&mut bytes, &both).unwrap();
    fs::write(&path, bytes).unwrap();

    browser.evaluate("document.getElementById('halves').value = 'right-left'; delete document.body.dataset.state");
    browser.choose("#left input", &[path]);
    browser.wait_for("done");
    let config = options(&[("preset", "fast")]);
    is_computed_here(browser, "both views in one file", (&left, &right), &config);
    browser.evaluate("document.getElementById('halves').value = ''; true");
}

fn options(given: &[(&str, &str)]) -> hsad::config::Config {
    let mut options = Options::default();
    given.iter().for_each(|(name, value)| options.set(name, value).unwrap());
    options.config().unwrap()
}

/// The disparities of the fields are searched, and none that is refused.
pub fn limit_the_range(browser: &mut Browser) {
    let [left, right] = example();
    fill(browser, "first", "5");
    browser.wait_for("done");
    fill(browser, "last", "40");
    browser.wait_for("done");
    let config = options(&[("preset", "fast"), ("min_disparity", "5"), ("disparities", "36")]);
    is_computed_here(browser, "a range of 5 to 40 px", (&left, &right), &config);
    assert_eq!(browser.evaluate("result.source"), "asked");
    fill(browser, "last", "4");
    browser.wait_for("failed");
    assert!(browser.message().contains("disparities"), "{}", browser.message());
    fill(browser, "first", "");
    browser.wait_for("done");
    fill(browser, "last", "");
    browser.wait_for("done");
    assert_eq!(browser.evaluate("result.source"), "found");
}

/// Fields and files tell the camera; a file that is no calibration is refused.
pub fn know_the_camera(browser: &mut Browser) {
    assert_eq!(browser.evaluate("result.camera.length"), 0);
    browser.evaluate("document.getElementById('focal').value = 400; true");
    fill(browser, "baseline", "0.2");
    browser.wait_for("done");
    // The principal point is in the middle.
    assert_eq!(browser.evaluate("result.camera.join()"), "400,169.5,127,0,0.2");
    assert_eq!(browser.evaluate("result.files.includes('cloud.ply')"), true);
    fill(browser, "baseline", "");
    browser.wait_for("done");
    fill(browser, "focal", "");
    browser.wait_for("done");
    assert_eq!(browser.evaluate("result.files.includes('cloud.ply')"), false);

    let folder = tempfile::tempdir().unwrap();
    for (name, text, state) in [
        (
            "calib.txt",
            "cam0=[378 0 169.5; 0 378 127; 0 0 1]\ncam1=[378 0 183.5; 0 378 127; 0 0 1]\nbaseline=100\n",
            "done",
        ),
        ("notes.txt", "not at all", "failed"),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        browser.evaluate("delete document.body.dataset.state");
        browser.choose("#calibration", &[path]);
        browser.wait_for(state);
        if state == "done" {
            assert_eq!(browser.evaluate("result.camera.join()"), "378,169.5,127,14,0.1");
        }
    }
    assert!(browser.message().contains("notes.txt") && browser.message().contains("calibrations are read from"));
    browser.evaluate("delete document.body.dataset.state; document.querySelector('#message button').click()");
    browser.wait_for("done");
    assert_eq!(
        browser.evaluate("[result.camera.length, document.getElementById('calibrated').hidden].join()"),
        "0,true"
    );
}

/// The page says that a match was cancelled, and its worker has ended the matches in these ways.
fn has_ended(browser: &mut Browser, ways: &str) {
    assert_eq!(browser.evaluate("document.body.dataset.state"), "idle");
    assert!(browser.message().contains("Cancelled"), "{}", browser.message());
    while browser.evaluate("document.body.ariaBusy") == "true" {
        thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(browser.evaluate("ends.join()"), ways);
}

/// A calibration of pictures as they were taken rectifies the pair, whose depth is known then.
pub fn rectify_by_a_calibration(browser: &mut Browser) {
    let camera = |column: f64| {
        json!({
            "focal": [378, 378], "centre": [column, 127], "size": [340, 255], "model": "pinhole", "distortion": [0.01, 0, 0, 0],
        })
    };
    let rig = json!({ "left": camera(169.5), "right": camera(183.5), "translation": [-0.1, 0, 0], "unit": "m" });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rig.json");
    fs::write(&path, rig.to_string()).unwrap();
    browser.evaluate("delete document.body.dataset.state");
    browser.choose("#calibration", &[path]);
    browser.wait_for("done");
    assert_eq!(browser.evaluate("result.rectified"), "calibration");
    assert_eq!(browser.evaluate("result.camera.at(-1)"), 0.1);
    assert_eq!(browser.evaluate("result.files.includes('cloud.ply')"), true);
    browser.evaluate("delete document.body.dataset.state; document.getElementById('uncalibrate').click()");
    browser.wait_for("done");
}

/// A match that was cancelled ends before its end, and the next one is as good as ever.
pub fn cancel_a_match(browser: &mut Browser) {
    browser.evaluate(
        "window.ends = [];
        const send = Worker.prototype.postMessage;
        Worker.prototype.postMessage = function (message, transfer) {
            if (message.act === 'match') {
                this.addEventListener('message', ({ data }) => {
                    if (data.id === message.id && !data.news) ends.push(data.error?.name ?? 'done');
                });
            }
            send.call(this, message, transfer);
        };
        document.querySelector('input[value=quality]').click();
        const cancel = () => document.querySelector('#message button').click();
        cancel()",
    );
    has_ended(browser, "Cancelled");
    // In the middle of the work, too.
    browser.evaluate(
        "document.querySelector('#message button').click();
        new Promise((done) => {
            const look = () => document.querySelector('.steps li:last-child.now') ? done(cancel()) : setTimeout(look);
            look();
        })",
    );
    has_ended(browser, "Cancelled,Cancelled");
    browser.evaluate("Worker.prototype.postMessage = send; true");
    choose_preset(browser, "fast");
    browser.wait_for("done");
    assert_eq!(browser.evaluate("result.preset"), "fast");
}
