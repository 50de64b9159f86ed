//! The bindings that the page calls: pictures in, a disparity map with its figures and files out.

mod cancel;
mod errors;
mod files;
mod matched;
mod options;
mod session;
mod task;
mod views;

use wasm_bindgen::prelude::*;

/// Installs the hook that writes the message of a panic to the browser's console.
#[wasm_bindgen(start)]
fn start() {
    console_error_panic_hook::set_once();
}
