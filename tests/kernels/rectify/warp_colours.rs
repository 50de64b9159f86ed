//! Resampling of a picture in colour by a map.

use hsad::{
    glam::DVec2,
    image::Size,
    io::Picture,
    rectify::WarpMap,
    verify::{Values, trials::WarpColoursTrial},
};

use crate::common::{SIZES, assert_twin, leaves, photographs, picture};

fn coloured(size: Size) -> Picture {
    let [red, green, blue] = [11, 12, 13].map(|seed| picture(size, seed));
    Picture::from_fn(size, |x, y| [red.get(x, y), green.get(x, y), blue.get(x, y), (x + y) as u8])
}

#[test]
fn whole_pixels_are_kept_but_for_alpha_and_nothing_is_shown_beyond_the_edge() {
    let source = coloured(Size::new(33, 21));
    let map = WarpMap::new((33, 21), (33, 21), |p| p + DVec2::new(-3.0, 2.0)).unwrap();
    let outputs = leaves(&WarpColoursTrial { source: source.clone(), map, cut: 8 });
    let [Values::U32(words)] = &outputs[..] else { panic!("one array of words, not {outputs:?}") };
    for (x, y) in (0..21).flat_map(|y| (0..33).map(move |x| (x, y))) {
        let [red, green, blue, _] = source.get_clamped(i64::from(x) - 3, i64::from(y) + 2);
        let expected = if x < 3 || y >= 19 { [0; 4] } else { [red, green, blue, 255] };
        assert_eq!(words[(y * 33 + x) as usize].to_le_bytes(), expected, "({x}, {y})");
    }
}

#[test]
fn half_a_pixel_has_the_weights_of_keys() {
    let light = |x, y| if (x, y) == (4, 0) { [164, 255, 0, 0] } else { [100, 0, 255, 0] };
    let source = Picture::from_fn((9, 1), light);
    let map = WarpMap::new((9, 1), (9, 1), |p| p + DVec2::new(0.5, 0.0)).unwrap();
    let outputs = leaves(&WarpColoursTrial { source, map, cut: 0 });
    let [Values::U32(words)] = &outputs[..] else { panic!("one array of words, not {outputs:?}") };
    // 100 + 64 * (-1/16, 9/16, 9/16, -1/16); 255 and 0 with the same weights, clamped.
    let expected = [[96, 0, 255], [136, 143, 112], [136, 143, 112], [96, 0, 255]];
    for (word, [red, green, blue]) in words[2..6].iter().zip(expected) {
        assert_eq!(word.to_le_bytes(), [red, green, blue, 255]);
    }
}

#[test]
fn equals_the_twin_at_every_size() {
    for (size, source_size) in SIZES.into_iter().flat_map(|size| SIZES.map(|source_size| (size, source_size))) {
        let of = |p: DVec2| DVec2::new(0.9 * p.x - 0.2 * p.y + 1.3, 0.2 * p.x + 1.1 * p.y - 5.7);
        let map = WarpMap::new(size, source_size, of).unwrap();
        let trial = WarpColoursTrial { source: coloured(source_size), map, cut: size.height / 3 };
        assert_twin(&format!("{size} from {source_size}"), &trial);
    }
}

#[test]
fn equals_the_twin_on_photographs() {
    for (name, source) in photographs() {
        let of = |p: DVec2| p + DVec2::new(0.002 * p.y, 0.7 - 0.003 * p.x);
        let map = WarpMap::new(source.size(), source.size(), of).unwrap();
        assert_twin(&name, &WarpColoursTrial { source, map, cut: 0 });
    }
}
