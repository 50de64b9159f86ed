//! A matched pair: its map and its figures.

use std::{rc::Rc, time::Duration};

use hsad::{
    Backend,
    dense::FILLED,
    disparity::{NONE, SCALE, coverage},
    io::{Calibration, Picture, color},
    pipeline::{self, RangeSource, TRUSTED},
};
use wasm_bindgen::prelude::*;

use super::{task::Task, views::View};

/// The result of a pair.
#[wasm_bindgen]
pub struct Matched {
    pub(super) backend: Rc<Backend>,
    pub(super) task: Task,
    /// The picture whose pixels have the disparities.
    pub(super) picture: Picture,
    /// The map, and the doubts about it.
    pub(super) matched: pipeline::Matched,
    pub(super) total: Duration,
}

#[wasm_bindgen]
impl Matched {
    /// The picture whose pixels have the disparities: the left one, rectified if the pair was.
    pub fn picture(&self) -> View {
        View(self.picture.clone())
    }

    /// Disparity of each pixel of the picture, in 1/`scale` px, or `none`.
    pub fn disparities(&self) -> Vec<i32> {
        self.matched.outcome.dense.disparity.data().to_vec()
    }

    /// Confidence of each disparity: 16 to 255 where it was measured, 1 to 15 where it was filled, 0 for none.
    pub fn confidences(&self) -> Vec<u8> {
        self.matched.outcome.dense.confidence.data().to_vec()
    }

    /// The map in false colours, as RGBA.
    pub fn colors(&self) -> Vec<u8> {
        let colors = color::disparity_colors(&self.matched.outcome.dense.disparity, self.color_limits());
        colors.data().iter().flat_map(|&[red, green, blue]| [red, green, blue, 255]).collect()
    }

    /// The disparities at the ends of the colour scale, in pixels: far, then near.
    #[wasm_bindgen(js_name = colorRange)]
    pub fn color_range(&self) -> Vec<f32> {
        let (far, near) = self.color_limits();
        [far, near].map(|disparity| disparity as f32 / SCALE as f32).to_vec()
    }

    /// The geometry of the disparities: focal length, column and row of the principal point, difference of the principal points, all in
    /// pixels, and the baseline in metres; empty if it is not known.
    pub fn camera(&self) -> Vec<f64> {
        let values = |c: &Calibration| vec![c.focal, c.cx, c.cy, c.doffs, c.baseline];
        self.matched.judgement.calibration.as_ref().map_or(Vec::new(), values)
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
        self.matched.outcome.range.min
    }

    /// Largest disparity of the searched range, in pixels.
    #[wasm_bindgen(getter)]
    pub fn last(&self) -> i32 {
        self.matched.outcome.range.last()
    }

    /// Where the range comes from: `asked`, `found` or `assumed`.
    #[wasm_bindgen(getter)]
    pub fn source(&self) -> String {
        match self.matched.outcome.range_source {
            RangeSource::Asked => "asked",
            RangeSource::Found(_) => "found",
            RangeSource::Fallback(_) => "assumed",
        }
        .into()
    }

    /// Number of interest points matched between the views.
    #[wasm_bindgen(getter)]
    pub fn matches(&self) -> usize {
        self.matched.outcome.seeding.seeds.len()
    }

    /// Diagnosis of the rectification, as text.
    #[wasm_bindgen(getter)]
    pub fn rectification(&self) -> String {
        self.matched.outcome.seeding.rectification.to_string()
    }

    /// How the pair was rectified before it was matched: `calibration`, `matches`, or empty.
    #[wasm_bindgen(getter)]
    pub fn rectified(&self) -> String {
        match &self.matched.rectified {
            None => "",
            Some(pair) if pair.rectification.calibration().is_some() => "calibration",
            Some(_) => "matches",
        }
        .into()
    }

    /// Trust in the map, 0 to 1.
    #[wasm_bindgen(getter)]
    pub fn trust(&self) -> f32 {
        self.matched.outcome.trust
    }

    /// The trust from which on a map is trusted.
    #[wasm_bindgen(getter)]
    pub fn trusted(&self) -> f32 {
        TRUSTED
    }

    /// Why the map is not to be trusted; `undefined` if it is, and where the match was forced.
    #[wasm_bindgen(getter, js_name = notTrusted)]
    pub fn not_trusted(&self) -> Option<String> {
        self.matched.judgement.not_trusted.clone()
    }

    /// Doubts about the map, one sentence each, with options between backticks.
    pub fn warnings(&self) -> Vec<String> {
        self.matched.judgement.warnings.clone()
    }

    /// Share of pixels with a disparity, 0 to 1.
    #[wasm_bindgen(getter)]
    pub fn coverage(&self) -> f64 {
        coverage(&self.matched.outcome.dense.disparity)
    }

    /// Share of pixels with a measured, not filled, disparity, 0 to 1.
    #[wasm_bindgen(getter)]
    pub fn measured(&self) -> f64 {
        self.matched.outcome.dense.measured()
    }

    /// The largest confidence of a filled pixel.
    #[wasm_bindgen(getter)]
    pub fn filled(&self) -> u8 {
        FILLED
    }

    /// Wall-clock time of the match, including building the kernels, in milliseconds.
    #[wasm_bindgen(getter)]
    pub fn milliseconds(&self) -> f64 {
        1e3 * self.total.as_secs_f64()
    }

    /// Wall-clock time of each step, in order, in milliseconds.
    pub fn times(&self) -> Vec<f64> {
        self.matched.outcome.times.iter().map(|(_, time)| 1e3 * time.as_secs_f64()).collect()
    }
}

impl Matched {
    fn color_limits(&self) -> (i32, i32) {
        color::disparity_range(&self.matched.outcome.dense.disparity).unwrap_or((0, 0))
    }
}
