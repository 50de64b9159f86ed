//! The page without a mouse: names, order and keys.

use serde_json::{Value, json};

use super::Browser;

/// Everything that takes the focus has a name, and the order is that of the page: pictures, settings, cloud, result.
pub fn everything_has_a_name_and_an_order(browser: &mut Browser) {
    let nodes = browser.call("Accessibility.getFullAXTree", json!({}))["nodes"].take();
    let mut count = 0;
    for node in nodes.as_array().unwrap() {
        let is_focusable = node["properties"].as_array().is_some_and(|properties| {
            properties.iter().any(|property| property["name"] == "focusable" && property["value"]["value"] == true)
        });
        if is_focusable && node["ignored"] == false && node["role"]["value"] != "RootWebArea" {
            let name = node["name"]["value"].as_str().unwrap_or_default();
            assert!(!name.trim().is_empty(), "{} has no name", node["role"]["value"]);
            count += 1;
        }
    }
    assert!(count > 15, "{count} parts take the focus");

    browser.evaluate(
        "document.activeElement.blur(); scrollTo(0, 0); window.focused = [];
        addEventListener('focusin', ({ target }) => focused.push(target.closest('[id]')?.id ?? '')); true",
    );
    for _ in 0..count {
        browser.press("Tab");
    }
    let order: Vec<String> = serde_json::from_value(browser.evaluate("focused")).unwrap();
    let place =
        |id: &str| order.iter().position(|found| found == id).unwrap_or_else(|| panic!("{id} is not in {order:?}"));
    let expected =
        ["left", "right", "exchange", "preset", "example", "cloud", "measured", "home", "disparity", "view", "save"];
    let places = expected.map(place);
    assert!(places.is_sorted(), "{order:?}");
}

/// Arrow keys move the marker on the map, whose values are told, and turn the cloud; the page does not scroll.
pub fn arrows_read_the_map_and_turn_the_cloud(browser: &mut Browser) {
    browser.evaluate("document.getElementById('disparity').focus(); scrollTo(0, 0)");
    browser.press("ArrowRight");
    let told = browser.evaluate("document.getElementById('probe').value");
    let expected = browser.evaluate(
        "(() => {
            const { width, height, disparities, confidences, none, scale } = result;
            const index = (height >> 1) * width + (width >> 1) + Math.round(width / 50);
            return disparities[index] === none ? 'none'
                : `${(disparities[index] / scale).toFixed(2)} px, confidence ${confidences[index]}`;
        })()",
    );
    assert!(told.as_str().unwrap().starts_with(expected.as_str().unwrap()), "{told} instead of {expected}");
    let turns: Value = browser.evaluate("cloud.look(0, 0, 1); cloud.canvas.focus(); true");
    assert_eq!(turns, true);
    browser.press("ArrowRight");
    browser.press("ArrowDown");
    assert_eq!(browser.evaluate("[cloud.yaw > 0, cloud.pitch > 0, scrollY].join()"), "true,true,0");
    browser.press("Home");
    assert_eq!(browser.evaluate("cloud.yaw"), 0);
}
