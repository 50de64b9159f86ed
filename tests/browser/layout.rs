//! What lies where on the page, with a result on it: on a desktop and on a phone.

use serde_json::json;

use super::Browser;

/// Everything is inside a desktop's window of 1280x800 and across a phone's of 390x844; fingers scroll and turn.
pub fn fits_desktops_and_phones(browser: &mut Browser) {
    browser.resize(1280, 800, false);
    assert_eq!(browser.evaluate(ACROSS), "", "wider than a desktop");
    for id in ["left", "right", "preset", "disparity", "scale", "cloud", "tools", "help"] {
        let inside = format!(
            "{{ const {{ left, top, right, bottom, width }} = document.getElementById('{id}').getBoundingClientRect();
            width > 0 && left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight }}"
        );
        assert_eq!(browser.evaluate(&inside), true, "#{id} is not inside a desktop's window");
    }
    assert_eq!(words(browser, "wheel"), [true, false], "words for a mouse");
    assert_eq!(browser.evaluate(CAMERAS), "", "a camera on a desktop");

    browser.resize(390, 844, true);
    assert_eq!(browser.evaluate(ACROSS), "", "wider than a phone");
    assert_eq!(words(browser, "wheel"), [false, true], "words for fingers");
    assert_eq!(browser.evaluate(CAMERAS), "environment,environment", "cameras of a phone");
    swipes(browser);
    browser.resize(1440, 900, false);
}

/// What sticks out of the page to the right, as ids and tags.
const ACROSS: &str = "[document.documentElement, ...document.querySelectorAll('body *')]
    .filter((part) => part.scrollWidth > innerWidth || part.getBoundingClientRect().right > innerWidth + 0.5)
    .map(({ id, tagName }) => id || tagName).join()";

/// The cameras that take pictures, of the inputs that are seen.
const CAMERAS: &str = "[...document.querySelectorAll('.take input')]
    .filter((input) => input.parentElement.clientWidth > 0).map((input) => input.getAttribute('capture')).join()";

/// Whether the page shows a word of those for a mouse, and 'pinch', one of those for fingers.
fn words(browser: &mut Browser, word: &str) -> [bool; 2] {
    let shown = browser.evaluate("document.body.innerText");
    let shown = shown.as_str().unwrap();
    [word, "pinch"].map(|word| shown.contains(word))
}

/// A finger that moves up over the cloud scrolls the page and turns nothing; one that moves sideways turns the cloud.
fn swipes(browser: &mut Browser) {
    let mut after = |step: [i32; 2]| {
        browser.evaluate("scrollTo(0, 0); cloud.look(0, 0, 1)");
        let place = browser.numbers::<i32>(
            "[...(({ left, top, width, height }) => [left + width / 2, top + height / 2])(cloud.canvas.getBoundingClientRect())].map(Math.round)",
        );
        for count in 0..12 {
            let [x, y] = [0, 1].map(|axis| place[axis] + count * step[axis]);
            let kind = if count == 0 { "touchStart" } else { "touchMove" };
            browser.call("Input.dispatchTouchEvent", json!({ "type": kind, "touchPoints": [{ "x": x, "y": y }] }));
        }
        browser.call("Input.dispatchTouchEvent", json!({ "type": "touchEnd", "touchPoints": [] }));
        browser.evaluate(
            "new Promise((next) => requestAnimationFrame(() => requestAnimationFrame(() =>
                next([scrollY > 50, cloud.yaw !== 0, cloud.pitch !== 0].join()))))",
        )
    };
    assert_eq!(after([0, -12]), "true,false,false", "a swipe up: scrolled, turned, tilted");
    assert_eq!(after([10, 0]), "false,true,false", "a swipe to the side: scrolled, turned, tilted");
}
