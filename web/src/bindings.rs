//! The bindings that the page calls: two pictures and a preset in, a disparity map with its figures out.

use std::path::Path;

use hsad::{
    Backend, Error, Options,
    disparity::{NONE, SCALE, coverage},
    gpu::DeviceChoice,
    io::{Picture, color, load},
    options::Kind,
    pipeline::{self, Outcome, RangeSource},
};
use wasm_bindgen::{Clamped, prelude::*};
use web_time::Instant;

/// Installs the hook that writes the message of a panic to the browser's console.
#[wasm_bindgen(start)]
fn start() {
    console_error_panic_hook::set_once();
}

/// The options of [`Session::match_pair`], as the command line has them: an array of objects with `name`, `heading`, `kind` (`flag`,
/// `whole`, `number` or `choice`), `unit`, `help`, and `choices`, an array of objects with `name` and `help`.
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

/// The options in an object, by name; texts, numbers and booleans.
fn given(object: &js_sys::Object) -> Result<Options, JsValue> {
    let mut options = Options::default();
    for entry in js_sys::Object::entries(object) {
        let [name, value] = [0, 1].map(|place| js_sys::Reflect::get_u32(&entry, place));
        let [name, value] = [name?, value?].map(|part| String::from(js_sys::Object::from(part).to_string()));
        options.set(&name, &value).map_err(thrown)?;
    }
    Ok(options)
}

/// A picture.
#[wasm_bindgen]
pub struct View(Picture);

#[wasm_bindgen]
impl View {
    /// A picture from red, green, blue and alpha bytes of `width` x `height` pixels, row by row.
    #[wasm_bindgen(constructor)]
    pub fn new(width: u32, height: u32, rgba: &[u8]) -> Result<Self, JsValue> {
        let (pixels, _) = rgba.as_chunks();
        Picture::new((width, height), pixels.to_vec()).map(Self).map_err(thrown)
    }

    /// Decodes the picture in a file's bytes as the command line does; the browser's own decoder changes the colours of
    /// transparent pixels. `name` is named in errors.
    pub fn decode(bytes: &[u8], name: &str) -> Result<Self, JsValue> {
        load::decode(bytes, Path::new(name)).map(Self).map_err(thrown)
    }

    /// Width in pixels.
    #[wasm_bindgen(getter)]
    pub fn width(&self) -> u32 {
        self.0.width()
    }

    /// Height in pixels.
    #[wasm_bindgen(getter)]
    pub fn height(&self) -> u32 {
        self.0.height()
    }

    /// The RGBA bytes of the picture, as [`View::new`] and a canvas take them.
    pub fn rgba(&self) -> Clamped<Vec<u8>> {
        Clamped(self.0.rgba().to_vec())
    }
}

/// The browser's GPU, opened.
#[wasm_bindgen]
pub struct Session {
    backend: Backend,
}

#[wasm_bindgen]
impl Session {
    /// Opens the GPU that the browser offers.
    pub async fn open() -> Result<Self, JsValue> {
        let backend = Backend::open_async(&DeviceChoice::Best).await.map_err(thrown)?;
        Ok(Self { backend })
    }

    /// Matches a pair. `options` is an object of what [`options`] describes; `begin` is called with the name of each step.
    #[wasm_bindgen(js_name = matchPair)]
    pub async fn match_pair(
        &self,
        left: View,
        right: View,
        options: js_sys::Object,
        begin: js_sys::Function,
    ) -> Result<Matched, JsValue> {
        let config = given(&options)?.config().map_err(thrown)?;
        let start = Instant::now();
        let outcome = pipeline::run_async(&self.backend, (&left.0, &right.0), &config, |step| {
            // An error of the page's callback does not stop the match.
            let _ = begin.call1(&JsValue::NULL, &step.name().into());
        })
        .await
        .map_err(thrown)?;
        Ok(Matched { outcome, milliseconds: 1e3 * start.elapsed().as_secs_f64() })
    }
}

/// A JavaScript `Error` whose name is the kind of the error.
fn thrown(error: Error) -> JsValue {
    let thrown = js_sys::Error::new(&error.to_string());
    thrown.set_name(match error {
        Error::Format { .. } => "BadPicture",
        Error::SizesDiffer { .. } => "SizesDiffer",
        Error::NotRectified { .. } => "NotRectified",
        Error::NoAdapter => "NoAdapter",
        Error::DeviceLost(_) => "DeviceLost",
        Error::OutOfMemory(_) | Error::TooLarge { .. } => "TooLarge",
        _ => "Error",
    });
    thrown.into()
}

/// The result of a pair.
#[wasm_bindgen]
pub struct Matched {
    outcome: Outcome,
    milliseconds: f64,
}

#[wasm_bindgen]
impl Matched {
    /// Disparity of each pixel of the reference view, in 1/`scale` px, or `none`.
    pub fn disparities(&self) -> Vec<i32> {
        self.outcome.dense.disparity.data().to_vec()
    }

    /// Confidence of each disparity: 16 to 255 where it was measured, 1 to 15 where it was filled, 0 for none.
    pub fn confidences(&self) -> Vec<u8> {
        self.outcome.dense.confidence.data().to_vec()
    }

    /// The map in false colours, as RGBA.
    pub fn colors(&self) -> Vec<u8> {
        let colors = color::disparity_colors(&self.outcome.dense.disparity, self.color_limits());
        colors.data().iter().flat_map(|&[red, green, blue]| [red, green, blue, 255]).collect()
    }

    /// The disparities at the ends of the colour scale, in pixels: far, then near.
    #[wasm_bindgen(js_name = colorRange)]
    pub fn color_range(&self) -> Vec<f32> {
        let (far, near) = self.color_limits();
        [far, near].map(|disparity| disparity as f32 / SCALE as f32).to_vec()
    }

    /// Number of disparity steps per pixel.
    #[wasm_bindgen(getter)]
    pub fn scale(&self) -> i32 {
        SCALE
    }

    /// Sentinel of a missing disparity.
    #[wasm_bindgen(getter)]
    pub fn none(&self) -> i32 {
        NONE
    }

    /// Smallest disparity of the searched range, in pixels.
    #[wasm_bindgen(getter)]
    pub fn first(&self) -> i32 {
        self.outcome.range.min
    }

    /// Largest disparity of the searched range, in pixels.
    #[wasm_bindgen(getter)]
    pub fn last(&self) -> i32 {
        self.outcome.range.last()
    }

    /// Whether the range was found from the matches; otherwise it was assumed.
    #[wasm_bindgen(getter)]
    pub fn found(&self) -> bool {
        matches!(self.outcome.range_source, RangeSource::Found(_))
    }

    /// Number of interest points matched between the views.
    #[wasm_bindgen(getter)]
    pub fn matches(&self) -> usize {
        self.outcome.seeding.seeds.len()
    }

    /// Diagnosis of the rectification, as text.
    #[wasm_bindgen(getter)]
    pub fn rectification(&self) -> String {
        self.outcome.seeding.rectification.to_string()
    }

    /// Trust in the map, 0 to 1.
    #[wasm_bindgen(getter)]
    pub fn trust(&self) -> f32 {
        self.outcome.trust
    }

    /// Share of pixels with a disparity, 0 to 1.
    #[wasm_bindgen(getter)]
    pub fn coverage(&self) -> f64 {
        coverage(&self.outcome.dense.disparity)
    }

    /// Share of pixels with a measured, not filled, disparity, 0 to 1.
    #[wasm_bindgen(getter)]
    pub fn measured(&self) -> f64 {
        self.outcome.dense.measured()
    }

    /// Wall-clock time of the match, including building the kernels, in milliseconds.
    #[wasm_bindgen(getter)]
    pub fn milliseconds(&self) -> f64 {
        self.milliseconds
    }

    /// Wall-clock time of each step, in order, in milliseconds.
    pub fn times(&self) -> Vec<f64> {
        self.outcome.times.iter().map(|(_, time)| 1e3 * time.as_secs_f64()).collect()
    }
}

impl Matched {
    fn color_limits(&self) -> (i32, i32) {
        color::disparity_range(&self.outcome.dense.disparity).unwrap_or((0, 0))
    }
}
