//! A headless Chromium, driven by the DevTools protocol over pipes.

use std::{
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, Command, Stdio},
    sync::mpsc::{self, Receiver},
    thread,
    time::{Duration, Instant},
};

use serde_json::{Value, json};
use tempfile::TempDir;

/// Timeout of an answer or a state of the page; a software GPU on a busy machine is slow.
const PATIENCE: Duration = Duration::from_secs(240);

/// A browser with one page.
pub struct Browser {
    process: Child,
    commands: ChildStdin,
    messages: Receiver<Value>,
    last_id: u64,
    session: Option<String>,
    /// Errors on the console of the page.
    pub complaints: Vec<String>,
    /// The browser's profile, removed with it.
    _profile: TempDir,
}

impl Browser {
    /// Starts the browser with an empty page of `width` x `height` pixels; `HSAD_CHROMIUM` names another browser than
    /// Debian's.
    pub fn start(width: u32, height: u32) -> Self {
        let chromium = std::env::var("HSAD_CHROMIUM").unwrap_or("chromium".into());
        let profile = tempfile::tempdir().unwrap();
        // The protocol uses the file descriptors 3 and 4 as pipes.
        let mut process = Command::new("sh")
            .args(["-c", r#"exec "$0" "$@" 3<&0 4>&1 </dev/null >/dev/null 2>&1"#, &chromium])
            .args(["--headless=new", "--no-sandbox", "--no-first-run", "--remote-debugging-pipe"])
            // WebGPU and WebGL run on Chromium's own software driver.
            .args(["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-unsafe-swiftshader"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a shell");
        let output = process.stdout.take().unwrap();
        let (send, messages) = mpsc::channel();
        thread::spawn(move || {
            for message in BufReader::new(output).split(0).map_while(Result::ok) {
                let message = serde_json::from_slice(&message).expect("the protocol speaks JSON");
                if send.send(message).is_err() {
                    break;
                }
            }
        });
        let commands = process.stdin.take().unwrap();
        let mut browser =
            Self { process, commands, messages, last_id: 0, session: None, complaints: Vec::new(), _profile: profile };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }))["targetId"].clone();
        let attached = browser.call("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        browser.session = Some(attached["sessionId"].as_str().unwrap().into());
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, json!({}));
        }
        browser.resize(width, height, false);
        browser
    }

    /// Gives the page `width` x `height` pixels, of a phone's screen with `fingers` or of a desktop's window.
    pub fn resize(&mut self, width: u32, height: u32, fingers: bool) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": fingers });
        self.call("Emulation.setDeviceMetricsOverride", size);
        self.call("Emulation.setTouchEmulationEnabled", json!({ "enabled": fingers }));
    }

    /// Calls a method of the protocol.
    pub fn call(&mut self, method: &str, params: Value) -> Value {
        self.last_id += 1;
        let mut message = json!({ "id": self.last_id, "method": method, "params": params });
        if let Some(session) = &self.session {
            message["sessionId"] = session.as_str().into();
        }
        self.commands.write_all(format!("{message}\0").as_bytes()).expect("the browser runs");
        let end = Instant::now() + PATIENCE;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let mut message = self.messages.recv_timeout(left).unwrap_or_else(|e| panic!("no answer to {method}: {e}"));
            if message["id"] == self.last_id {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].take();
            }
            self.listen(&message);
        }
    }

    fn listen(&mut self, event: &Value) {
        let complaint = match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => true,
            Some("Runtime.consoleAPICalled") => event["params"]["type"] == "error",
            Some("Log.entryAdded") => event["params"]["entry"]["level"] == "error",
            _ => false,
        };
        if complaint {
            self.complaints.push(event["params"].to_string());
        }
    }

    /// The value of an expression, after its promise is resolved.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let params = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let mut answer = self.call("Runtime.evaluate", params);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].take()
    }

    /// The numbers in the array of an expression, or of its promise.
    pub fn numbers<T: TryFrom<i64>>(&mut self, expression: &str) -> Vec<T> {
        let text = self.evaluate(&format!("Promise.resolve({expression}).then((numbers) => numbers.join())"));
        let number = |text: &str| text.parse::<i64>().ok().and_then(|number| number.try_into().ok()).expect("a number");
        text.as_str().expect("an array").split(',').map(number).collect()
    }

    /// Opens a page and waits for `state`.
    pub fn open(&mut self, url: &str, state: &str) {
        self.call("Page.navigate", json!({ "url": url }));
        self.wait_for(state);
    }

    /// Chooses files for an input, as in the file dialog.
    pub fn choose(&mut self, selector: &str, files: &[PathBuf]) {
        let document = self.call("DOM.getDocument", json!({}))["root"]["nodeId"].clone();
        let selector = json!({ "nodeId": document, "selector": selector });
        let input = self.call("DOM.querySelector", selector)["nodeId"].clone();
        self.call("DOM.setFileInputFiles", json!({ "files": files, "nodeId": input }));
    }

    /// Ends the browser's GPU process, as a driver's crash does. The browser starts it again.
    pub fn crash_gpu(&mut self) {
        self.call_browser("Browser.crashGpuProcess", json!({}));
    }

    /// Saves what is downloaded in `folder`.
    pub fn download_to(&mut self, folder: &Path) {
        self.call_browser("Browser.setDownloadBehavior", json!({ "behavior": "allow", "downloadPath": folder }));
    }

    /// Calls a method of the browser, not of the page.
    fn call_browser(&mut self, method: &str, params: Value) {
        let session = self.session.take();
        self.call(method, params);
        self.session = session;
    }

    /// Presses a key, without a character.
    pub fn press(&mut self, key: &str) {
        for kind in ["rawKeyDown", "keyUp"] {
            let code = if key == "Tab" { 9 } else { 0 };
            let event = json!({ "type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code });
            self.call("Input.dispatchKeyEvent", event);
        }
    }

    /// Waits until the page is in `state`; panics if the page ends in another state.
    pub fn wait_for(&mut self, state: &str) {
        let start = Instant::now();
        loop {
            let now = self.evaluate("document.body?.dataset.state ?? ''");
            if now == state {
                return;
            }
            let ended = ["done", "failed"].iter().any(|end| now == *end);
            let waiting = !ended && start.elapsed() < PATIENCE;
            assert!(waiting, "{now} instead of {state}: {} {:?}", self.message(), self.complaints);
            thread::sleep(Duration::from_millis(100));
        }
    }

    /// The message in the middle of the page.
    pub fn message(&mut self) -> String {
        self.evaluate("document.getElementById('message').innerText").as_str().unwrap_or_default().into()
    }

    /// A screenshot, as PNG.
    pub fn screenshot(&mut self) -> Vec<u8> {
        let answer = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        from_base64(answer["data"].as_str().expect("base64"))
    }
}

fn from_base64(text: &str) -> Vec<u8> {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = text.bytes().filter_map(|byte| DIGITS.iter().position(|&digit| digit == byte));
    let (mut bytes, mut bits, mut count) = (Vec::new(), 0_usize, 0);
    for digit in digits {
        bits = bits << 6 | digit;
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
            bits &= (1 << count) - 1;
        }
    }
    bytes
}

impl Drop for Browser {
    fn drop(&mut self) {
        // The browser may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
