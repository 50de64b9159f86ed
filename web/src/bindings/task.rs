//! What the page asks for besides two pictures, as JSON.

use std::path::Path;

use hsad::{
    Error, Options, Result, Size,
    config::Config,
    io::{
        Calibration,
        calibration::{self, Hints},
        load::Stretch,
    },
    pipeline::{Geometry, Way},
    report::Value,
};

/// A task: how to match a pair, and what its report tells of the files.
pub struct Task {
    /// The parameters.
    pub config: Config,
    /// Names of the left and of the right view.
    pub names: [String; 2],
    /// How the views' samples became 8 bits.
    pub stretch: Option<Stretch>,
    /// Doubts about the files.
    pub warnings: Vec<String>,
    /// How the rows of the pair come to correspond.
    pub way: Way,
    /// The geometry of the pair if its pictures are rectified.
    pub calibration: Option<Calibration>,
}

impl Task {
    /// Reads a task for pictures of these sizes, an object with
    /// - `options`, an object of options by name: texts, numbers and booleans;
    /// - `names`, both views' names;
    /// - `stretch`, both ends of the stretch, or nothing;
    /// - `warnings`, texts;
    /// - `calibration`: nothing, or `focal` (px), `baseline` (m) and perhaps `doffs` (px), or `files`, one or two objects with `name` and
    ///   `text`, and perhaps the `unit` of their lengths (m).
    pub fn read(text: &str, sizes: [Size; 2]) -> Result<Self> {
        let task: Value = text.parse().map_err(|error| Error::Parameter {
            name: "the task",
            value: format!("unreadable ({error})"),
            expected: "it must be JSON".into(),
        })?;
        let texts = |list: &Value| -> Vec<String> { list.as_array().into_iter().flatten().map(text_of).collect() };
        let names = texts(&task["names"]).try_into().unwrap_or_else(|_| ["left".into(), "right".into()]);
        let mut warnings = texts(&task["warnings"]);
        let Geometry { way, calibration, notes } = cameras(&task["calibration"], &names, sizes)?;
        warnings.extend(notes);
        Ok(Self {
            config: options(&task["options"])?.config()?,
            names,
            stretch: stretch(&task["stretch"]),
            warnings,
            way,
            calibration,
        })
    }
}

fn text_of(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), String::from)
}

fn options(given: &Value) -> Result<Options> {
    let mut options = Options::default();
    for (name, value) in given.as_object().into_iter().flatten() {
        options.set(name, &text_of(value))?;
    }
    Ok(options)
}

fn stretch(ends: &Value) -> Option<Stretch> {
    let [low, high] = [0, 1].map(|end| ends[end].as_f64().map(|sample| sample as f32));
    Some(Stretch { low: low?, high: high? })
}

fn cameras(given: &Value, names: &[String; 2], sizes: [Size; 2]) -> Result<Geometry> {
    if let Some(files) = given["files"].as_array() {
        let files: Vec<[String; 2]> =
            files.iter().map(|file| [text_of(&file["name"]), text_of(&file["text"])]).collect();
        let texts: Vec<(&Path, &str)> = files.iter().map(|[name, text]| (Path::new(name), text.as_str())).collect();
        let pictures = names.each_ref().map(Path::new);
        let hints = Hints { pictures: Some(pictures), sizes: Some(sizes), unit: given["unit"].as_f64() };
        let loaded = calibration::parse(&texts, &hints)?;
        return Geometry::of_files(&loaded, sizes)
            .map_err(|error| Error::Format { path: texts[0].0.into(), reason: error.to_string() });
    }
    let Some((focal, baseline)) = given["focal"].as_f64().zip(given["baseline"].as_f64()) else {
        return Ok(Geometry::new(Way::AsNeeded, None));
    };
    let doffs = given["doffs"].as_f64().unwrap_or(0.0);
    Ok(Geometry::new(Way::AsNeeded, Some(Calibration::centred(focal, baseline, doffs, sizes[0])?)))
}
