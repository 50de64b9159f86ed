//! The page in a headless Chromium: it computes the same bytes as the native library, and names what is wrong with bad
//! input.
//!
//! Ignored by default, because it needs a browser: `cargo test --test browser -- --ignored`.
#![cfg(feature = "cli")]

mod devtools;
mod files;
mod keyboard;
mod layout;
mod results;
mod settings;

use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::Duration,
};

use devtools::Browser;
use hsad::{
    Backend, Options,
    config::{Config, Preset},
    gpu::DeviceChoice,
    io::{Picture, load},
    options::Kind,
    pipeline,
};
use serde_json::json;

/// Helper functions in the page; `choose` puts `files` (promises of files) into the input of a side, as the file dialog
/// does.
const HELPERS: &str = r#"
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
/** The pixels of the cloud's canvas. */
function pixels() {
  const { gl } = cloud;
  const bytes = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  return bytes;
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
        // Port 0 stands for any free port.
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
        // The server may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// All tests share one browser and one page, because both are slow to start.
#[test]
#[ignore = "needs Chromium and builds the page: cargo test --test browser -- --ignored"]
fn the_page_in_chromium() {
    let server = Server::start();
    let mut browser = Browser::start(1440, 900);
    browser.open(&server.url, "idle");
    has_the_options_of_the_library(&mut browser);
    decodes_what_is_decoded_here(&mut browser);
    computes_what_is_computed_here(&mut browser);
    if let Some(path) = std::env::var_os("HSAD_SCREENSHOT") {
        // The view is a little to the side, where depth is visible.
        browser.evaluate("cloud.look(0.24, 0.13, 1.16); new Promise((drawn) => setTimeout(drawn, 1000))");
        fs::write(path, browser.screenshot()).unwrap();
    }
    takes_files_as_the_command_line_does(&mut browser);
    layout::fits_desktops_and_phones(&mut browser);
    browser.evaluate(&format!("(0, eval)(`{}`)", HELPERS.replace('`', "\\`").replace("${", "\\${")));
    settings::take_both_views_from_one_file(&mut browser);
    settings::limit_the_range(&mut browser);
    settings::know_the_camera(&mut browser);
    settings::rectify_by_a_calibration(&mut browser);
    results::are_saved_as_the_command_saves_them(&mut browser);
    results::show_confidences(&mut browser);
    results::explain_trust(&mut browser);
    results::rectify_what_is_not(&mut browser);
    keyboard::everything_has_a_name_and_an_order(&mut browser);
    keyboard::arrows_read_the_map_and_turn_the_cloud(&mut browser);
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
    says_what_is_wrong(&mut browser);
    keeps_an_error_that_came_meanwhile(&mut browser);
    settings::cancel_a_match(&mut browser);
    survives_the_loss_of_the_gpu(&mut browser);
    draws_pictures_wider_than_a_texture(&mut browser);
    survives_a_panic(&mut browser, &server.url);
    says_that_there_is_no_webgpu(&mut browser, &server.url);
}

fn has_the_options_of_the_library(browser: &mut Browser) {
    let told = browser.evaluate(
        "import('./library.js').then(({ options }) => options()).then((options) =>
            options.map(({ name, choices }) => [name, ...choices.map(({ name }) => name)].join(' ')).join(', '))",
    );
    let described = Options::ALL.iter().map(|option| match option.kind() {
        Kind::Choice(choices) => {
            [option.name].into_iter().chain(choices.iter().map(|choice| choice.name)).collect::<Vec<_>>().join(" ")
        }
        _ => option.name.into(),
    });
    assert_eq!(told, described.collect::<Vec<_>>().join(", "));
    let offered = "[...document.querySelectorAll('input[name=preset]')].map(({ value }) => value).join()";
    assert_eq!(browser.evaluate(offered), "fast,balanced,quality");
}

fn decodes_what_is_decoded_here(browser: &mut Browser) {
    for (name, bytes) in files::all() {
        let decoded: Vec<u8> = browser.numbers(&format!(
            "import('./library.js').then(async ({{ decode }}) =>
                (await decode([{{ file: new Blob([new Uint8Array({bytes:?})]), name: '{name}' }}])).views[0].data)"
        ));
        let expected = load::decode(&bytes, Path::new(name)).unwrap();
        assert!(decoded == expected.rgba(), "{name} is not decoded to the same bytes");
    }
}

fn computes_what_is_computed_here(browser: &mut Browser) {
    let [left, right] = example();
    browser.evaluate("document.getElementById('example').click()");
    for (name, preset) in [("balanced", Preset::Balanced), ("fast", Preset::Fast), ("quality", Preset::Quality)] {
        if name != "balanced" {
            choose_preset(browser, name);
        }
        browser.wait_for("done");
        assert_eq!(browser.evaluate("result.preset"), name);
        is_computed_here(browser, name, (&left, &right), &preset.config());
    }
}

/// Transparent pixels keep their colours, and a JPEG has those that the same decoder finds.
fn takes_files_as_the_command_line_does(browser: &mut Browser) {
    let folder = tempfile::tempdir().unwrap();
    let [left, right] = example();
    let paths = ["left.png", "right.jpg"].map(|name| folder.path().join(name));
    fs::write(&paths[0], files::transparent_png(&left)).unwrap();
    fs::write(&paths[1], files::jpeg(&right)).unwrap();
    let [left, right] = paths.each_ref().map(|path| load::load(path).unwrap());

    choose_preset(browser, "fast");
    browser.wait_for("done");
    browser.evaluate("delete document.body.dataset.state");
    browser.choose("#left input", &paths);
    browser.wait_for("done");
    is_computed_here(browser, "transparent PNG and JPEG", (&left, &right), &Preset::Fast.config());
}

fn choose_preset(browser: &mut Browser, name: &str) {
    browser.evaluate(&format!(
        "delete document.body.dataset.state; document.querySelector('input[value={name}]').click()"
    ));
}

/// Holds the result that the page shows against the one of the library here.
fn is_computed_here(browser: &mut Browser, name: &str, views: (&Picture, &Picture), config: &Config) {
    let backend = Backend::open(&DeviceChoice::Best).unwrap_or(Backend::Cpu);
    let expected = pipeline::run(&backend, views, config, |_| ()).unwrap();
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

fn says_what_is_wrong(browser: &mut Browser) {
    let bad = [
        ("choose('left', [new File(['not at all'], 'notes.txt')])", "cannot be used", "notes.txt: not a picture"),
        ("choose('left', [view('left', 0, 0.01), view('right', 0, 0.01)])", "could not be matched", "window of 5x5"),
        ("choose('left', [view('left'), view('right'), view('left')])", "could not be matched", "3 files"),
    ];
    for (act, headline, detail) in bad {
        browser.evaluate(act);
        browser.wait_for("failed");
        let message = browser.message();
        assert!(message.contains(headline) && message.contains(detail), "{act}: {message}");
        assert!(!message.contains("--"), "an option of the command line: {message}");
    }
    // After all errors the page still works.
    browser.evaluate("choose('right', [view('left'), view('right')])");
    browser.wait_for("done");
}

/// A match in progress must not replace the message of a later error.
fn keeps_an_error_that_came_meanwhile(browser: &mut Browser) {
    choose_preset(browser, "quality");
    browser.evaluate("choose('left', [new File(['not at all'], 'notes.txt')])");
    browser.wait_for("failed");
    assert_eq!(browser.evaluate("document.body.ariaBusy"), "true", "nothing went on meanwhile");
    while browser.evaluate("document.body.ariaBusy") == "true" {
        thread::sleep(Duration::from_millis(100));
    }
    browser.wait_for("failed");
    assert!(browser.message().contains("notes.txt"), "{}", browser.message());
    choose_preset(browser, "fast");
    browser.wait_for("done");
    assert_eq!(browser.evaluate("result.preset"), "fast");
}

fn survives_the_loss_of_the_gpu(browser: &mut Browser) {
    // The number of drawn pixels of the cloud's canvas, read before the browser clears it.
    let drawn = "cloud.look(0.24, 0.13, 1.16); cloud.drawNow(0); pixels().filter((_, i) => i % 4 === 3).reduce((a, b) => a + b)";
    let before = browser.evaluate(drawn);
    assert_ne!(before, 0);
    browser.evaluate(
        "window.restored = new Promise((restored) => cloud.canvas.addEventListener('webglcontextrestored', restored)); true",
    );
    browser.crash_gpu();
    browser.evaluate("restored.then(() => true)");
    assert_eq!(browser.evaluate(drawn), before, "the cloud is not drawn again");

    choose_preset(browser, "balanced");
    browser.wait_for("failed");
    assert!(browser.message().contains("The GPU was lost"), "{} {:?}", browser.message(), browser.complaints);
    try_again(browser);
    browser.wait_for("done");
    assert_eq!(browser.evaluate("result.preset"), "balanced");
}

fn draws_pictures_wider_than_a_texture(browser: &mut Browser) {
    let colors = |painted: bool| {
        format!(
            "{{
                const width = cloud.gl.getParameter(cloud.gl.MAX_TEXTURE_SIZE) + 1;
                const flat = (color) => new ImageData(new Uint8ClampedArray(8 * width).map((_, i) => color[i % 4]), width);
                cloud.paint({painted});
                cloud.show(flat([255, 0, 0, 255]), flat([0, 0, 255, 255]), new Float32Array(2 * width).fill(9),
                    {{ focal: width, principal: [width / 2, 1], doffs: 0 }});
                cloud.look(0, 0, 1);
                cloud.drawNow(0);
                const shown = pixels();
                const all = new Set();
                for (let i = 0; i < shown.length; i += 4) if (shown[i + 3]) all.add(shown.slice(i, i + 3).join());
                [...all].join(' and ')
            }}"
        )
    };
    assert_eq!(browser.evaluate(&colors(false)), "255,0,0");
    assert_eq!(browser.evaluate(&colors(true)), "0,0,255");
}

/// A panic ends the worker; the next worker takes over.
fn survives_a_panic(browser: &mut Browser, url: &str) {
    browser.open(url, "idle");
    browser.evaluate(
        "const post = Worker.prototype.postMessage;
        Worker.prototype.postMessage = function (message, transfer) {
            if (message.act !== 'match' || window.mended) post.call(this, message, transfer);
            else this.dispatchEvent(new ErrorEvent('error', { message: 'unreachable' }));
        };
        document.getElementById('example').click()",
    );
    browser.wait_for("failed");
    let message = browser.message();
    assert!(message.contains("broke off") && message.contains("unreachable"), "{message}");
    browser.evaluate("mended = true");
    try_again(browser);
    browser.wait_for("done");
}

fn try_again(browser: &mut Browser) {
    browser.evaluate("delete document.body.dataset.state; document.querySelector('#message button').click()");
}

fn says_that_there_is_no_webgpu(browser: &mut Browser, url: &str) {
    let source = "Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined })";
    browser.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": source }));
    browser.call("Page.navigate", json!({ "url": url }));
    browser.wait_for("failed");
    let message = browser.message();
    assert!(message.contains("no WebGPU") && message.contains("Firefox"), "{message}");
}
