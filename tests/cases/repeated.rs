//! Patterns that repeat: each matches itself at many disparities.

use hsad::image::Plane;

use crate::{
    pair::Pair,
    scene::{Layer, layered, object, wall},
    texture::texture,
};

/// `scene` behind bars at a disparity of 66 px, every `period` px, `width` px wide and lit from one side.
fn fence(scene: &str, period: u32, width: u32) -> Pair {
    let place = |x: u32, eye: u32| (x + 66 * eye) % period;
    let mut pair = Pair::shipped(scene).with(|view, eye| {
        Plane::from_fn(view.size(), |x, y| {
            let bar = place(x, eye);
            if bar < width { [40 + 12 * bar as u8; 4] } else { view.get(x, y) }
        })
    });
    let columns = (0..pair.size().width).cycle();
    pair.truth.data_mut().iter_mut().zip(columns).filter(|&(_, x)| place(x, 0) < width).for_each(|(d, _)| *d = 66.0);
    pair
}

/// Bars repeat: each bar matches every other, as do points beside the bars.
#[test]
fn a_fence_does_not_stretch_the_range() {
    for (scene, period, width) in [("planes", 40, 6), ("planes", 26, 4), ("curved", 26, 6)] {
        let pair = fence(scene, period, width);
        pair.matched(&[]).holds(&pair.truth, 100).judges(&pair.truth);
    }
}

/// Grout every 30x18 px of a wall without any other texture, with objects before the wall.
#[test]
fn a_tiled_wall_lies_in_the_range() {
    let tiles = |x: f32, y: f32| if x.rem_euclid(30.0) < 2.0 || y.rem_euclid(18.0) < 2.0 { 90.0 } else { 190.0 };
    let shelf = |x, y| (30.0..280.0).contains(&x) && (190.0..230.0).contains(&y);
    let shelf = Layer { disparity: 36.0, grey: |x, y| texture(x + 300.0, y + 90.0), covers: shelf };
    let pair = layered((320, 240), &[shelf, object(28.0), wall(8.0, tiles)]);
    pair.matched(&[]).holds(&pair.truth, 160).judges(&pair.truth);
}
