//! Errors of the library as JavaScript's.

use hsad::Error;
use wasm_bindgen::JsValue;

/// A JavaScript `Error` whose name is the kind of the error.
pub fn thrown(error: Error) -> JsValue {
    let name = match error {
        Error::Format { .. } => "BadPicture",
        Error::SizesDiffer { .. } => "SizesDiffer",
        Error::NotRectified { .. } | Error::NotRectifiable { .. } => "NotRectified",
        Error::NoAdapter => "NoAdapter",
        Error::DeviceLost(_) => "DeviceLost",
        Error::OutOfMemory(_) | Error::TooLarge { .. } => "TooLarge",
        _ => "Error",
    };
    named(name, &error.to_string())
}

/// A JavaScript `Error` of this name.
pub fn named(name: &str, message: &str) -> JsValue {
    let error = js_sys::Error::new(message);
    error.set_name(name);
    error.into()
}
