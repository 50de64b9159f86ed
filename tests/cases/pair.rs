//! Pairs with known disparities.

use std::{fs::File, path::Path};

use hsad::{
    eval::conditions::{Condition, Kind},
    image::{Plane, Size},
    io::{Picture, load, pfm, png},
};

use crate::run::Run;

/// Two views and the true disparities of the left one, in pixels, not finite where unknown.
#[derive(Clone)]
pub struct Pair {
    pub left: Picture,
    pub right: Picture,
    pub truth: Plane<f32>,
}

impl Pair {
    /// A scene of `data/`.
    pub fn shipped(scene: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(scene);
        let [left, right] = ["left.png", "right.png"].map(|file| load::load(&folder.join(file)).expect("a picture"));
        Self { left, right, truth: pfm::read(&folder.join("disp_left.pfm")).expect("a map") }
    }

    /// The pair with the right view for the left one.
    pub fn exchanged(scene: &str) -> Self {
        let Self { left, right, .. } = Self::shipped(scene);
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(scene);
        let truth = pfm::read(&folder.join("disp_right.pfm")).expect("a map").map(|disparity| -disparity);
        Self { left: right, right: left, truth }
    }

    pub fn size(&self) -> Size {
        self.left.size()
    }

    /// Both views, each changed by `change`, which is told 0 for the left and 1 for the right view.
    pub fn with(self, change: impl Fn(Picture, u32) -> Picture) -> Self {
        Self { left: change(self.left, 0), right: change(self.right, 1), ..self }
    }

    /// The pair with another right view.
    pub fn with_right(self, change: impl FnOnce(&Picture) -> Picture) -> Self {
        Self { right: change(&self.right), ..self }
    }

    /// `hsad match` of the pair as PNG files.
    pub fn matched(&self, args: &[&str]) -> Run {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let paths = ["left.png", "right.png"].map(|file| folder.path().join(file));
        for (picture, path) in [&self.left, &self.right].into_iter().zip(&paths) {
            png::write_rgba8(&mut File::create(path).expect("a file"), picture).expect("a PNG");
        }
        Run::of(&paths[0], &paths[1], args)
    }
}

/// The picture with content `rows` px lower.
pub fn lowered(picture: &Picture, rows: u32) -> Picture {
    Picture::from_fn(picture.size(), |x, y| picture.get(x, y.saturating_sub(rows)))
}

/// The picture turned by 180 degrees.
pub fn upside_down(picture: &Picture) -> Picture {
    let Size { width, height } = picture.size();
    Picture::from_fn(picture.size(), |x, y| picture.get(width - 1 - x, height - 1 - y))
}

/// The picture with rows and columns exchanged.
pub fn transposed<T: Copy>(plane: &Plane<T>) -> Plane<T> {
    Plane::from_fn((plane.height(), plane.width()), |x, y| plane.get(y, x))
}

/// A picture whose pixel `(x, y)` is the bilinear value of `picture` at `place(x, y)`, with the edge's value beyond the
/// edge.
pub fn resampled(picture: &Picture, place: impl Fn(f64, f64) -> (f64, f64)) -> Picture {
    Picture::from_fn(picture.size(), |x, y| {
        let (u, v) = place(f64::from(x), f64::from(y));
        let (i, j) = (u.floor(), v.floor());
        let at = |i: f64, j: f64, channel: usize| f64::from(picture.get_clamped(i as i64, j as i64)[channel]);
        let (s, t) = (u - i, v - j);
        [0, 1, 2, 3].map(|channel| {
            let row = |j: f64| at(i, j, channel) * (1.0 - s) + at(i + 1.0, j, channel) * s;
            (row(j) * (1.0 - t) + row(j + 1.0) * t).round() as u8
        })
    })
}

/// The picture under a synthetic condition: noise, blur, ... of `strength`; noise differs for each `seed`.
pub fn changed(picture: &Picture, kind: Kind, strength: f64, seed: u64) -> Picture {
    Condition::new(kind, strength).expect("a strength in its range").apply(picture, seed).picture
}
