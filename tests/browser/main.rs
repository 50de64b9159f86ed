//! The page in a headless Chromium: it computes the same bytes as the library does here, and says what is wrong with bad
//! input.
//!
//! Ignored unless asked for, because it needs a browser: `cargo test --test browser -- --ignored`.
#![cfg(feature = "cli")]

mod devtools;

use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, Command, Stdio},
};

use devtools::Browser;
use hsad::{
    config::Preset,
    gpu::DeviceChoice,
    io::{Picture, load},
    pair::Backend,
    pipeline,
};
use serde_json::json;

/// Puts what `files` yields into the input of a side, as if someone had chosen it there.
const CHOOSE: &str = r#"
async function choose(side, files) {
  delete document.body.dataset.state;
  const transfer = new DataTransfer();
  for (const file of await Promise.all(files)) transfer.items.add(file);
  const input = document.querySelector(`#${side} input`);
  input.files = transfer.files;
  input.dispatchEvent(new Event("change"));
}
/** A view of the example, moved down by some rows and cut to a part of its width. */
async function view(side, rows = 0, share = 1) {
  const bitmap = await createImageBitmap(await (await fetch(`example/${side}.png`)).blob());
  const canvas = new OffscreenCanvas(Math.round(share * bitmap.width), bitmap.height);
  canvas.getContext("2d").drawImage(bitmap, 0, rows);
  return new File([await canvas.convertToBlob()], `${side}.png`);
}
"#;

fn example() -> [Picture; 2] {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/planes");
    ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap())
}

/// The command that builds and serves the page.
struct Server {
    process: Child,
    url: String,
}

impl Server {
    fn start() -> Self {
        // Any port that is free.
        let arguments = ["run", "--package", "hsad-web", "--", "0"];
        let mut command = Command::new(env!("CARGO"));
        let command = command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).stderr(Stdio::piped());
        let mut process = command.spawn().expect("cargo");
        let mut lines = BufReader::new(process.stderr.take().unwrap()).lines().map_while(Result::ok);
        let mut told = Vec::new();
        let url = lines.find_map(|line| {
            let url = line.strip_prefix("serving it at ").map(String::from);
            told.push(line);
            url
        });
        Self { process, url: url.unwrap_or_else(|| panic!("the page is not served: {}", told.join("\n"))) }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // It may have gone by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// One browser and one page for all, because both are slow to begin.
#[test]
#[ignore = "needs Chromium and builds the page: cargo test --test browser -- --ignored"]
fn the_page_in_chromium() {
    let server = Server::start();
    let mut browser = Browser::start(1440, 900);
    browser.open(&server.url, "idle");
    decodes_the_bytes_of_the_file(&mut browser);
    computes_what_is_computed_here(&mut browser);
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
    if let Some(path) = std::env::var_os("HSAD_SCREENSHOT") {
        // From a little beside, where depth shows.
        browser.evaluate("cloud.look(0.24, 0.13, 1.16); new Promise((drawn) => setTimeout(drawn, 1000))");
        fs::write(path, browser.screenshot()).unwrap();
    }
    says_what_is_wrong(&mut browser);
    says_that_there_is_no_webgpu(&mut browser, &server.url);
}

fn decodes_the_bytes_of_the_file(browser: &mut Browser) {
    for (name, picture) in ["left.png", "right.png"].iter().zip(example()) {
        let decoded: Vec<u8> = browser.numbers(&format!(
            "import('./decode.js').then(async ({{ decode }}) => {{
                const file = await fetch('example/{name}');
                return (await decode(await file.blob(), '{name}')).data;
            }})"
        ));
        assert!(decoded == picture.rgba(), "{name} is not decoded to the bytes of the file");
    }
}

fn computes_what_is_computed_here(browser: &mut Browser) {
    let backend = Backend::open(&DeviceChoice::Best).unwrap_or(Backend::Cpu);
    let [left, right] = example();
    browser.evaluate("document.getElementById('example').click()");
    for (name, preset) in [("balanced", Preset::Balanced), ("fast", Preset::Fast), ("quality", Preset::Quality)] {
        if name != "balanced" {
            browser.evaluate(&format!(
                "delete document.body.dataset.state; document.querySelector('input[value={name}]').click()"
            ));
        }
        browser.wait_for("done");
        assert_eq!(browser.evaluate("result.preset"), name);
        let expected = pipeline::run(&backend, (&left, &right), &preset.config(), |_| ()).unwrap();
        assert_eq!(browser.evaluate("result.first"), expected.range.min, "{name}");
        assert_eq!(browser.evaluate("result.last"), expected.range.last(), "{name}");
        let disparities: Vec<i32> = browser.numbers("result.disparities");
        let confidences: Vec<u8> = browser.numbers("result.confidences");
        let differ = |count: usize| format!("{name}: {count} pixels differ from {}", backend.name());
        let other = disparities.iter().zip(expected.dense.disparity.data()).filter(|(a, b)| a != b).count();
        assert!(disparities.len() == expected.dense.disparity.data().len() && other == 0, "{}", differ(other));
        let other = confidences.iter().zip(expected.dense.confidence.data()).filter(|(a, b)| a != b).count();
        assert!(confidences.len() == expected.dense.confidence.data().len() && other == 0, "{}", differ(other));
        eprintln!(
            "{name}: the same {} disparities as on {}, in {} ms",
            disparities.len(),
            backend.name(),
            browser.evaluate("Math.round(result.milliseconds)")
        );
    }
}

fn says_what_is_wrong(browser: &mut Browser) {
    browser.evaluate(&format!("(0, eval)(`{}`)", CHOOSE.replace('`', "\\`").replace("${", "\\${")));
    let bad = [
        ("choose('left', [new File(['not at all'], 'notes.txt')])", "not a picture", "notes.txt"),
        ("choose('left', [view('left'), view('right', 0, 0.9)])", "differ in size", "306x255"),
        ("choose('left', [view('left'), view('right', 9)])", "not rectified", "9.0 px"),
        ("choose('left', [view('left'), view('right'), view('left')])", "could not be matched", "3 files"),
    ];
    for (act, headline, detail) in bad {
        browser.evaluate(act);
        browser.wait_for("failed");
        let message = browser.message();
        assert!(message.contains(headline) && message.contains(detail), "{act}: {message}");
    }
    // And after all that it still works.
    browser.evaluate("choose('right', [view('left'), view('right')])");
    browser.wait_for("done");
}

fn says_that_there_is_no_webgpu(browser: &mut Browser, url: &str) {
    let source = "Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined })";
    browser.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": source }));
    browser.call("Page.navigate", json!({ "url": url }));
    browser.wait_for("failed");
    let message = browser.message();
    assert!(message.contains("no WebGPU") && message.contains("Firefox"), "{message}");
}
