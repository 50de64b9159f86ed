//! The options of matching, described.

use hsad::{Options, options::Kind};
use wasm_bindgen::prelude::*;

/// The options of a task, as the command line has them: an array of objects with `name`, `heading`, `kind` (`flag`, `whole`, `number` or
/// `choice`), `unit`, `help`, and `choices`, an array of objects with `name` and `help`.
#[wasm_bindgen]
pub fn options() -> js_sys::Array {
    let object = |entries: &[(&str, JsValue)]| {
        let entries = entries.iter().map(|(name, value)| js_sys::Array::of2(&(*name).into(), value));
        let entries = entries.collect::<js_sys::Array>();
        js_sys::Object::from_entries(&entries).map_or(JsValue::UNDEFINED, JsValue::from)
    };
    let described = Options::ALL.iter().map(|option| {
        let (kind, choices) = match option.kind() {
            Kind::Flag => ("flag", Vec::new()),
            Kind::Whole => ("whole", Vec::new()),
            Kind::Number => ("number", Vec::new()),
            Kind::Choice(choices) => ("choice", choices),
        };
        let choices =
            choices.iter().map(|choice| object(&[("name", choice.name.into()), ("help", choice.help.into())]));
        object(&[
            ("name", option.name.into()),
            ("heading", option.group.heading().into()),
            ("kind", kind.into()),
            ("unit", option.unit.into()),
            ("help", option.help().into()),
            ("choices", choices.collect::<js_sys::Array>().into()),
        ])
    });
    described.collect()
}
