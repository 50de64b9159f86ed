//! Rendered pairs: layers of constant disparity, one before the other.

use hsad::image::{Plane, Size};

use crate::{pair::Pair, texture::texture};

/// A flat surface parallel to the picture.
pub struct Layer {
    /// Disparity, in pixels.
    pub disparity: f32,
    /// Grey value at a place of the left view.
    pub grey: fn(f32, f32) -> f32,
    /// Whether the surface covers a place of the left view.
    pub covers: fn(f32, f32) -> bool,
}

/// The pair that shows `layers`, the nearest first; the last one covers what the others leave.
pub fn layered(size: impl Into<Size>, layers: &[Layer]) -> Pair {
    let size = size.into();
    let seen = |eye: f32, x: u32, y: u32| {
        let (x, y) = (x as f32, y as f32);
        let (last, others) = layers.split_last().expect("a layer");
        let layer = others.iter().find(|layer| (layer.covers)(x + eye * layer.disparity, y)).unwrap_or(last);
        (layer.disparity, (layer.grey)(x + eye * layer.disparity, y))
    };
    let view = |eye: f32| {
        Plane::from_fn(size, |x, y| {
            let grey = seen(eye, x, y).1.round() as u8;
            [grey, grey, grey, 255]
        })
    };
    Pair { left: view(0.0), right: view(1.0), truth: Plane::from_fn(size, |x, y| seen(0.0, x, y).0) }
}

/// A layer that covers everything.
pub fn wall(disparity: f32, grey: fn(f32, f32) -> f32) -> Layer {
    Layer { disparity, grey, covers: |_, _| true }
}

/// A textured object between columns 110 and 210, rows 70 and 170.
pub fn object(disparity: f32) -> Layer {
    let covers = |x, y| (110.0..210.0).contains(&x) && (70.0..170.0).contains(&y);
    Layer { disparity, grey: |x, y| texture(x + 700.0, y), covers }
}
