//! Resampling by a map.

use hsad::{
    glam::{DVec2, Vec2Swizzles as _},
    image::{Luma, Size},
    luma::{pack, unpack},
    rectify::WarpMap,
    verify::{Dice, Values, trials::WarpTrial},
};

use crate::common::{SIZES, assert_twin, leaves, photographs, picture};

/// The picture that the device makes of `source`.
#[track_caller]
fn warped(source: &Luma, size: impl Into<Size>, source_of: impl Fn(DVec2) -> DVec2) -> Luma {
    let map = WarpMap::new(size, source.size(), source_of).unwrap();
    let size = map.size();
    let outputs = leaves(&WarpTrial { source: source.clone(), map });
    let [Values::U32(words)] = &outputs[..] else { panic!("one array of words, not {outputs:?}") };
    let warped = unpack(size, words);
    assert_eq!(words, &pack(&warped), "bytes beyond the width are 0");
    warped
}

#[test]
fn whole_pixels_are_kept() {
    for size in [(1, 1), (3, 5), (17, 33), (70, 41)].map(Size::from) {
        let source = picture(size, 3);
        for (dx, dy) in [(0, 0), (1, 0), (0, -1), (-3, 2), (18, 0), (0, 1000), (-200_000, 500_000)] {
            let shown = warped(&source, size, |p| p + DVec2::new(dx.into(), dy.into()));
            let expected = Luma::from_fn(size, |x, y| {
                source.get_clamped(i64::from(x) + i64::from(dx), i64::from(y) + i64::from(dy))
            });
            assert_eq!(shown, expected, "{size} by ({dx}, {dy})");
        }
    }
}

#[test]
fn half_a_pixel_of_a_ramp_is_halfway() {
    // Steps of 4 along x and of 2 along y; from the second to the last but second pixel the edge plays no part.
    let ramp = Luma::from_fn((33, 21), |x, y| (10 + 4 * x + 2 * y) as u8);
    let shown = warped(&ramp, (33, 21), |p| p + 0.5);
    for (x, y) in (1..19).flat_map(|y| (1..31).map(move |x| (x, y))) {
        assert_eq!(u32::from(shown.get(x, y)), 10 + 4 * x + 2 * y + 3, "({x}, {y})");
    }
}

#[test]
fn half_a_pixel_of_an_impulse_has_the_weights_of_keys() {
    let impulse = |grey, light| Luma::from_fn((9, 9), |x, y| if (x, y) == (4, 4) { light } else { grey });
    let [one, two] = [DVec2::new(0.5, 0.0), DVec2::splat(0.5)];
    // 100 + 64 * (-1/16, 9/16, 9/16, -1/16) = 96, 136, 136, 96: at x + 1/2 pixel 4 is the fourth of x = 2.
    let row = [100, 100, 96, 136, 136, 96, 100, 100, 100];
    let light = impulse(100, 164);
    assert_eq!(
        warped(&light, (9, 9), |p| p + one),
        Luma::from_fn((9, 9), |x, y| if y == 4 { row[x as usize] } else { 100 })
    );
    let turned = warped(&light, (9, 9), |p| p + DVec2::new(0.0, 0.5));
    assert_eq!(turned, Luma::from_fn((9, 9), |x, y| if x == 4 { row[y as usize] } else { 100 }));
    // 128 * 81/256 = 40.5, up; 128 * -9/256 = -4.5, up; 128 / 256 = 0.5, up.
    let both = warped(&impulse(100, 228), (9, 9), |p| p + two);
    assert_eq!(
        [(3, 3), (2, 3), (3, 5), (2, 2), (5, 2), (6, 3)].map(|(x, y)| both.get(x, y)),
        [141, 96, 96, 101, 101, 100]
    );
    // Overshoots are clamped: 0 - 255/16, and 255 + 255/16.
    assert_eq!(warped(&impulse(0, 255), (9, 9), |p| p + one).row(4)[1..7], [0, 0, 143, 143, 0, 0]);
    assert_eq!(warped(&impulse(255, 0), (9, 9), |p| p + one).row(4)[1..7], [255, 255, 112, 112, 255, 255]);
}

/// Catmull-Rom in `f64`, from the cubic through the two inner pixels with central differences as slopes.
fn cubic([a, b, c, d]: [f64; 4], t: f64) -> f64 {
    let (first, last) = ((c - a) / 2.0, (d - b) / 2.0);
    b + t * (first + t * (3.0 * (c - b) - 2.0 * first - last + t * (2.0 * (b - c) + first + last)))
}

#[test]
fn an_affine_map_equals_interpolation_in_floats_but_for_a_tenth_of_a_level() {
    let source = picture((61, 47), 8);
    let of = |p: DVec2| DVec2::new(0.913 * p.x - 0.237 * p.y + 6.3, 0.219 * p.x + 1.071 * p.y - 5.7);
    let shown = warped(&source, (53, 39), of);
    for (x, y) in (0..39).flat_map(|y| (0..53).map(move |x| (x, y))) {
        let at = of(DVec2::new(x.into(), y.into()));
        let (pixel, t) = (at.floor(), at - at.floor());
        let luma = |i: i64, j: i64| f64::from(source.get_clamped(pixel.x as i64 + i, pixel.y as i64 + j));
        let row = |j| cubic([-1, 0, 1, 2].map(|i| luma(i, j)), t.x);
        let exact = cubic([-1, 0, 1, 2].map(row), t.y).clamp(0.0, 255.0);
        // Half a level for rounding; a tenth for positions within 1.5/2048 px and weights in 1/2048.
        assert!((f64::from(shown.get(x, y)) - exact).abs() <= 0.6, "({x}, {y}): {} and {exact}", shown.get(x, y));
    }
}

#[test]
fn pixels_without_a_position_are_0() {
    let source = Luma::filled((40, 20), 7);
    let shown = warped(&source, (40, 20), |p| if p == DVec2::new(32.0, 0.0) { DVec2::NAN } else { p });
    assert_eq!(shown, Luma::from_fn((40, 20), |x, y| if x >= 16 && y < 16 { 0 } else { 7 }));
}

/// The largest and the smallest positions, whose difference needs all 32 bits, in one cell.
#[test]
fn extreme_positions_do_not_overflow() {
    let source = picture((19, 7), 5);
    let far = |p: DVec2| DVec2::new(p.x, p.y) % 32.0 / 16.0 * (786_430.0 + 262_144.0) - 262_144.0;
    assert_twin("extremes", &WarpTrial { map: WarpMap::new((70, 50), (19, 7), far).unwrap(), source });
}

#[test]
fn equals_the_twin_at_every_size() {
    let mut dice = Dice::new("sizes", 1);
    for (size, source_size) in SIZES.into_iter().flat_map(|size| SIZES.map(|source_size| (size, source_size))) {
        let mut part = || f64::from(dice.between(-1000, 1000)) / 1000.0;
        let scale = DVec2::new(source_size.width.into(), source_size.height.into())
            / DVec2::new(size.width.into(), size.height.into());
        let (slant, shift) = (DVec2::new(part(), part()) / 4.0, DVec2::new(part(), part()) * 4.0);
        let map = WarpMap::new(size, source_size, |p| scale * p + slant * p.yx() + shift).unwrap();
        assert_twin(&format!("{size} from {source_size}"), &WarpTrial { source: picture(source_size, 9), map });
    }
}

/// A map that bends so much that its nodes lie 8, 4 and 2 px apart.
#[test]
fn equals_the_twin_with_nodes_at_every_distance() {
    let source = picture((150, 70), 4);
    let of = |p: DVec2| DVec2::new(p.x + p.x * p.x / 200.0, p.y - p.x * p.y / 300.0);
    let maps = [0.1, 0.03, 0.001].map(|tolerance| WarpMap::within(tolerance, (70, 50), (150, 70), of).unwrap());
    assert!(maps[0] != maps[1] && maps[1] != maps[2]);
    for map in maps {
        assert_twin("bent", &WarpTrial { map, source: source.clone() });
    }
}

#[test]
fn equals_the_twin_on_photographs() {
    for (name, picture) in photographs() {
        let source = picture.luma();
        let of = |p: DVec2| p + DVec2::new(0.002 * p.y, 0.7 - 0.003 * p.x);
        assert_twin(&name, &WarpTrial { map: WarpMap::new(source.size(), source.size(), of).unwrap(), source });
    }
}
