//! The position of a match, made as exact as the dense half would make it.
//!
//! A feature is located within its own scale, and differently so in the two views; a window of the picture around it is
//! located to a fraction of a pixel. So the window around the left feature is sought again near the right one (paper,
//! step 5: blocks of 7x7, 'interpolation is performed between the nearest matching window and its neighbors').

use rayon::prelude::*;

use super::Match;
use crate::{features::Feature, image::Luma};

/// Half the side of the 7x7 window.
const HALF: i64 = 3;
/// Pixels in the window.
const AREA: i32 = ((2 * HALF + 1) * (2 * HALF + 1)) as i32;
/// How far from the match the window is sought, along the row and across rows.
const REACH: (i64, i64) = (3, 1);

/// A point of the left view with its disparity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seed {
    /// Column in the left view, in pixels.
    pub x: f32,
    /// Row in the left view, in pixels.
    pub y: f32,
    /// Left column minus right column, in pixels.
    pub disparity: f32,
    /// Right row minus left row, in pixels: 0 everywhere in a rectified pair.
    pub dy: f32,
    /// Confidence of the match, 0 to 1.
    pub confidence: f32,
}

impl Seed {
    /// The match as the features have it.
    pub fn from_match(left: &[Feature], right: &[Feature], found: &Match) -> Self {
        let (l, r) = (&left[found.left], &right[found.right]);
        Self { x: l.x, y: l.y, disparity: l.x - r.x, dy: r.y - l.y, confidence: found.confidence }
    }

    /// Column in the right view.
    pub fn right_x(&self) -> f32 {
        self.x - self.disparity
    }

    /// Row in the right view.
    pub fn right_y(&self) -> f32 {
        self.y + self.dy
    }
}

/// Finds every match's place with the window, in the order of `matches`.
pub fn refine(views: (&Luma, &Luma), features: (&[Feature], &[Feature]), matches: &[Match]) -> Vec<Seed> {
    matches
        .par_iter()
        .filter_map(|found| {
            let seed = Seed::from_match(features.0, features.1, found);
            search(views, &seed)
        })
        .collect()
}

fn search((left, right): (&Luma, &Luma), seed: &Seed) -> Option<Seed> {
    let (x, y) = (seed.x.round() as i64, seed.y.round() as i64);
    let window = Window::at(left, x, y);
    let (disparity, dy) = (seed.disparity.round() as i64, seed.dy.round() as i64);
    let cost = |d: i64, dy: i64| window.difference(&Window::at(right, x - d, y + dy));
    let (_, dy, d) = (dy - REACH.1..=dy + REACH.1)
        .flat_map(|dy| (disparity - REACH.0..=disparity + REACH.0).map(move |d| (cost(d, dy), dy, d)))
        .min()?;
    let row = vertex(cost(d - 1, dy), cost(d, dy), cost(d + 1, dy))?;
    let column = vertex(cost(d, dy - 1), cost(d, dy), cost(d, dy + 1))?;
    Some(Seed { x: x as f32, y: y as f32, disparity: d as f32 + row, dy: dy as f32 + column, ..*seed })
}

/// Where the parabola through three costs at -1, 0 and 1 is lowest; none where the middle one is not the least.
fn vertex(before: i32, at: i32, after: i32) -> Option<f32> {
    let curvature = before - 2 * at + after;
    (at <= before && at <= after && curvature > 0).then(|| (before - after) as f32 / (2 * curvature) as f32)
}

/// A window's pixels times its area, less their sum: the mean of the window plays no part.
struct Window([i32; AREA as usize]);

impl Window {
    fn at(view: &Luma, x: i64, y: i64) -> Self {
        let side = 2 * HALF + 1;
        let mut values = [0; AREA as usize];
        for (i, value) in values.iter_mut().enumerate() {
            let (i, j) = (i as i64 % side, i as i64 / side);
            *value = i32::from(view.get_clamped(x + i - HALF, y + j - HALF));
        }
        let sum: i32 = values.iter().sum();
        Self(values.map(|value| value * AREA - sum))
    }

    fn difference(&self, other: &Self) -> i32 {
        self.0.iter().zip(&other.0).map(|(a, b)| (a - b).abs()).sum()
    }
}
