//! What the page calls: two pictures and a preset in, a map and what is known of it out.

use std::path::Path;

use hsad::{
    Error,
    backend::Backend,
    config::{Config, Preset},
    disparity::{NONE, SCALE, coverage},
    gpu::DeviceChoice,
    io::{Picture, color, load},
    pipeline::{self, Outcome, RangeSource},
};
use wasm_bindgen::{Clamped, prelude::*};
use web_time::Instant;

/// Panics are told on the console, not only that there was one.
#[wasm_bindgen(start)]
fn start() {
    console_error_panic_hook::set_once();
}

/// A picture.
#[wasm_bindgen]
pub struct View(Picture);

#[wasm_bindgen]
impl View {
    /// Takes red, green, blue and alpha of `width` x `height` pixels, row by row.
    #[wasm_bindgen(constructor)]
    pub fn new(width: u32, height: u32, rgba: &[u8]) -> Result<Self, JsValue> {
        let (pixels, _) = rgba.as_chunks();
        Picture::new(width, height, pixels.to_vec()).map(Self).map_err(thrown)
    }

    /// The picture in a file's bytes, as the command line reads it; the browser's own decoder would give other colours
    /// where there is transparency. `name` is named in errors.
    pub fn decode(bytes: &[u8], name: &str) -> Result<Self, JsValue> {
        load::decode(bytes, Path::new(name)).map(Self).map_err(thrown)
    }

    /// Pixels in a row.
    #[wasm_bindgen(getter)]
    pub fn width(&self) -> u32 {
        self.0.width()
    }

    /// Rows.
    #[wasm_bindgen(getter)]
    pub fn height(&self) -> u32 {
        self.0.height()
    }

    /// Its bytes, as [`View::new`] takes them and a canvas does.
    pub fn rgba(&self) -> Clamped<Vec<u8>> {
        Clamped(self.0.rgba().to_vec())
    }
}

/// The browser's GPU, ready for work.
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

    /// Matches a pair. `preset` is `fast`, `balanced`, `quality` or `paper`; with `force` a pair that is not rectified is
    /// matched as well; `begin` is called with the name of each step.
    #[wasm_bindgen(js_name = matchPair)]
    pub async fn match_pair(
        &self,
        left: View,
        right: View,
        preset: String,
        force: bool,
        begin: js_sys::Function,
    ) -> Result<Matched, JsValue> {
        let config = Config { force, ..named(&preset).map_err(thrown)?.config() };
        let start = Instant::now();
        let outcome = pipeline::run_async(&self.backend, (&left.0, &right.0), &config, |step| {
            // What the page makes of it is its own concern.
            let _ = begin.call1(&JsValue::NULL, &step.name().into());
        })
        .await
        .map_err(thrown)?;
        Ok(Matched { outcome, milliseconds: 1e3 * start.elapsed().as_secs_f64() })
    }
}

fn named(preset: &str) -> hsad::Result<Preset> {
    Ok(match preset {
        "fast" => Preset::Fast,
        "balanced" => Preset::Balanced,
        "quality" => Preset::Quality,
        "paper" => Preset::Paper,
        _ => {
            return Err(Error::Parameter {
                name: "the preset",
                value: preset.into(),
                expected: "there are fast, balanced, quality and paper".into(),
            });
        }
    })
}

/// A JavaScript `Error` whose name tells what kind of error it is.
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

/// What came of a pair.
#[wasm_bindgen]
pub struct Matched {
    outcome: Outcome,
    milliseconds: f64,
}

#[wasm_bindgen]
impl Matched {
    /// A disparity for each pixel of the reference view, in 1/`scale` px, or `none`.
    pub fn disparities(&self) -> Vec<i32> {
        self.outcome.dense.disparity.data().to_vec()
    }

    /// How far each can be trusted, 1 to 255; 0 where there is none, or where it was filled in.
    pub fn confidences(&self) -> Vec<u8> {
        self.outcome.dense.confidence.data().to_vec()
    }

    /// The map in colour, as RGBA.
    pub fn colors(&self) -> Vec<u8> {
        let colors = color::disparity_colors(&self.outcome.dense.disparity, self.told_apart());
        colors.data().iter().flat_map(|&[red, green, blue]| [red, green, blue, 255]).collect()
    }

    /// The disparities in pixels between which colours change: the far end and the near one.
    #[wasm_bindgen(js_name = colorRange)]
    pub fn color_range(&self) -> Vec<f32> {
        let (far, near) = self.told_apart();
        [far, near].map(|disparity| disparity as f32 / SCALE as f32).to_vec()
    }

    /// Steps of a disparity in a pixel.
    #[wasm_bindgen(getter)]
    pub fn scale(&self) -> i32 {
        SCALE
    }

    /// What says 'no disparity'.
    #[wasm_bindgen(getter)]
    pub fn none(&self) -> i32 {
        NONE
    }

    /// The smallest disparity that was searched, in pixels.
    #[wasm_bindgen(getter)]
    pub fn first(&self) -> i32 {
        self.outcome.range.min
    }

    /// The largest disparity that was searched, in pixels.
    #[wasm_bindgen(getter)]
    pub fn last(&self) -> i32 {
        self.outcome.range.last()
    }

    /// Whether that range was found from the matches and not assumed.
    #[wasm_bindgen(getter)]
    pub fn found(&self) -> bool {
        self.outcome.range_source == RangeSource::Seeds
    }

    /// How many interest points were found in both views.
    #[wasm_bindgen(getter)]
    pub fn matches(&self) -> usize {
        self.outcome.seeding.seeds.len()
    }

    /// How well rows correspond, in words.
    #[wasm_bindgen(getter)]
    pub fn rectification(&self) -> String {
        self.outcome.seeding.rectification.to_string()
    }

    /// How far the map can be trusted, 0 to 1.
    #[wasm_bindgen(getter)]
    pub fn trust(&self) -> f32 {
        self.outcome.seeding.trust
    }

    /// The share of pixels with a disparity, 0 to 1.
    #[wasm_bindgen(getter)]
    pub fn coverage(&self) -> f64 {
        coverage(&self.outcome.dense.disparity)
    }

    /// The share of pixels whose disparity was measured and not filled in, 0 to 1.
    #[wasm_bindgen(getter)]
    pub fn measured(&self) -> f64 {
        self.outcome.dense.measured()
    }

    /// What it took, building the kernels included.
    #[wasm_bindgen(getter)]
    pub fn milliseconds(&self) -> f64 {
        self.milliseconds
    }

    /// What each step took, in milliseconds, in their order.
    pub fn times(&self) -> Vec<f64> {
        self.outcome.times.iter().map(|(_, time)| 1e3 * time.as_secs_f64()).collect()
    }
}

impl Matched {
    fn told_apart(&self) -> (i32, i32) {
        color::disparity_range(&self.outcome.dense.disparity).unwrap_or((0, 0))
    }
}
