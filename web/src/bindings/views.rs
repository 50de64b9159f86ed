//! Pictures: decoded from files, and given by the page.

use std::path::Path;

use hsad::io::{
    Picture,
    load::{self, Halves, LoadedPair, Stretch, Unseen},
};
use wasm_bindgen::{Clamped, prelude::*};

use super::errors::{named, thrown};

/// A picture.
#[wasm_bindgen]
#[derive(Clone)]
pub struct View(pub(super) Picture);

#[wasm_bindgen]
impl View {
    /// A picture from red, green, blue and alpha bytes of `width` x `height` pixels, row by row.
    #[wasm_bindgen(constructor)]
    pub fn new(width: u32, height: u32, rgba: &[u8]) -> Result<Self, JsValue> {
        let (pixels, _) = rgba.as_chunks();
        Picture::new((width, height), pixels.to_vec()).map(Self).map_err(thrown)
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

/// One view, or both views of a pair, from files.
///
/// They are decoded as on the command line; the browser's own decoder changes the colours of transparent pixels.
#[wasm_bindgen]
pub struct Loaded {
    views: Vec<Picture>,
    stretch: Option<Stretch>,
    warnings: Vec<String>,
}

#[wasm_bindgen]
impl Loaded {
    /// Decodes a file with one view, or one that tells of both: an MPO, or a JPS with a descriptor. `halves` tells where both views lie in a picture:
    /// `left-right`, `right-left`, `left-on-top` or `right-on-top`; empty if it has one. `name` is named in errors.
    pub fn one(bytes: &[u8], name: &str, halves: &str) -> Result<Self, JsValue> {
        let path = Path::new(name);
        let halves = match halves {
            "" => None,
            "left-right" => Some(Halves::LeftRight),
            "right-left" => Some(Halves::RightLeft),
            "left-on-top" => Some(Halves::LeftOnTop),
            "right-on-top" => Some(Halves::RightOnTop),
            other => return Err(named("Error", &format!("'{other}' is no order of two views in a picture"))),
        };
        let unseen = Unseen::default();
        let both = match halves {
            Some(halves) => load::decode_halves(bytes, path, halves, &unseen).map(Some),
            None => match load::decode_both(bytes, path, &unseen) {
                // Phones write such lists with a picture and its brightness, which are no pair.
                Err(_) if !is_of_pairs(path) => Ok(None),
                both => both,
            },
        };
        match both.map_err(thrown)? {
            Some(pair) => Ok(pair.into()),
            None => {
                let (view, doubt) = load::decode_with_doubt(bytes, path).map_err(thrown)?;
                Ok(Self { views: vec![view], stretch: None, warnings: doubt.into_iter().collect() })
            }
        }
    }

    /// Decodes the files of the left and of the right view, with one stretch where they have more than 8 bits.
    pub fn pair(left: &[u8], left_name: &str, right: &[u8], right_name: &str) -> Result<Self, JsValue> {
        let views = [(left, Path::new(left_name)), (right, Path::new(right_name))];
        let loaded = load::decode_pair(views[0], views[1], &Unseen::default());
        loaded.map(Self::from).map_err(thrown)
    }

    /// Takes the next view, left before right; `undefined` when all are taken.
    pub fn take(&mut self) -> Option<View> {
        (!self.views.is_empty()).then(|| View(self.views.remove(0)))
    }

    /// The samples of the files that became 0 and 255; empty without a stretch.
    pub fn stretch(&self) -> Vec<f32> {
        self.stretch.map_or(Vec::new(), |Stretch { low, high }| vec![low, high])
    }

    /// Doubts about the files.
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}

impl From<LoadedPair> for Loaded {
    fn from(LoadedPair { left, right, stretch, warnings }: LoadedPair) -> Self {
        Self { views: vec![left, right], stretch, warnings }
    }
}

/// Whether a file has both views by its name.
fn is_of_pairs(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| ["mpo", "jps"].iter().any(|of_pairs| extension.eq_ignore_ascii_case(of_pairs)))
}
