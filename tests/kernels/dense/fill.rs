//! Filling of holes along rays.

use hsad::{
    dense::{Dense, FILLED, View},
    disparity::{DisparityMap, DisparityRange, NONE},
    image::{Luma, Plane, Size},
    luma::unpack,
    verify::{Values, trials::FillTrial},
};

use crate::common::*;

fn dense(disparity: DisparityMap) -> Dense {
    let confidence = disparity.map(|&disparity| if disparity == NONE { 0 } else { 200 });
    Dense { disparity, confidence }
}

/// A trial of a grey picture of one brightness.
fn plain(disparity: DisparityMap) -> FillTrial {
    let picture = Plane::filled(disparity.size(), [90, 90, 90, 255]);
    let range = DisparityRange::new(0, 60).unwrap();
    FillTrial { dense: dense(disparity), picture, view: View::Left, range, own: None }
}

/// Disparities and confidences of the filled map.
fn filled(trial: &FillTrial) -> (Vec<i32>, Vec<u8>) {
    let found = leaves(trial);
    let [Values::I32(disparities), Values::U32(confidences)] = &found[..] else { panic!("a map") };
    (disparities.clone(), unpack(trial.dense.disparity.size(), confidences).into_data())
}

#[test]
fn the_twin_fills_the_same() {
    let range = DisparityRange::new(-12, 41).unwrap();
    for Size { width, height } in SIZES {
        for (holes, slope, view) in
            [(0, 0, View::Left), (60, 30, View::Right), (200, -70, View::Left), (255, 9, View::Left)]
        {
            let (coarse, fine) = (picture((width.div_ceil(40), height), 101), picture((width, height), 102));
            let gaps = picture((width.div_ceil(7), height.div_ceil(7)), 103);
            let disparities = Plane::from_fn((width, height), |x, y| match fine.get(x, y) {
                value if gaps.get(x / 7, y / 7) < holes && (holes > 250 || value > 3) => NONE,
                value => i32::from(coarse.get(x / 40, y)) * 40 - 3000 + slope * x as i32 + i32::from(value % 64),
            });
            let channels = [1, 2, 3, 4].map(|seed| picture((width, height), seed));
            let picture = Plane::from_fn((width, height), |x, y| channels.each_ref().map(|channel| channel.get(x, y)));
            let trial = FillTrial { dense: dense(disparities), picture, view, range, own: None };
            assert_twin(&format!("{width}x{height}, {holes} {slope} {view:?}"), &trial);
        }
    }
}

#[test]
fn a_slope_goes_on_into_the_hole() {
    // A slope of 16/256 px per pixel along the row, up to the edge of the picture, which the other view does not show.
    let slanted = Plane::from_fn((50, 40), |x, _| if (5..45).contains(&x) { 256 * 20 + 16 * x as i32 } else { NONE });
    let (disparities, confidences) = filled(&plain(slanted));
    for x in 0..50 {
        assert_eq!(disparities[20 * 50 + x], 256 * 20 + 16 * x as i32, "column {x}");
    }
    // The confidence of measured pixels stays, and filled ones have less, the farther the less.
    assert_eq!(confidences[20 * 50 + 5..20 * 50 + 45], [200; 40]);
    assert_eq!((confidences[20 * 50 + 4], confidences[20 * 50]), (FILLED, FILLED));
    let wide = Plane::from_fn((300, 3), |x, _| if x < 30 { 512 } else { NONE });
    let (_, confidences) = filled(&plain(wide));
    assert_eq!([30, 99, 299].map(|x| confidences[300 + x]), [FILLED - 2, FILLED - 6, 1]);
}

#[test]
fn colour_tells_the_surface() {
    // Between two surfaces, a hole of the colours of one of them, pixel by pixel.
    let map = Plane::from_fn((64, 3), |x, _| match x {
        0..24 => 2560,
        40.. => 2304,
        _ => NONE,
    });
    let colour = |x: u32| if x < 35 { [200, 30, 30, 255] } else { [30, 30, 200, 255] };
    let trial = FillTrial { picture: Plane::from_fn((64, 3), |x, _| colour(x)), ..plain(map) };
    let (disparities, _) = filled(&trial);
    assert_eq!(disparities[64 + 24..64 + 40], [[2560; 11].as_slice(), &[2304; 5]].concat());
}

#[test]
fn what_the_other_view_shows_is_not_hidden() {
    // A foreground of 20 px and a background of 4 px; the hole between them is hidden in the right view by the foreground. The
    // foreground's disparity would hide the background's pixels there, and the background wins although it is farther away.
    let map = Plane::from_fn((90, 3), |x, _| match x {
        0..40 => 4 * 256,
        56.. => 20 * 256,
        _ => NONE,
    });
    let (disparities, _) = filled(&plain(map));
    assert_eq!(disparities[90 + 40..90 + 56], [4 * 256; 16]);
}

#[test]
fn a_row_without_disparities_is_filled_from_others_within_reach() {
    let map = |rows: u32| Plane::from_fn((5, rows), |x, y| if y == 0 && x < 4 { 512 } else { NONE });
    let (disparities, confidences) = filled(&plain(map(130)));
    assert_eq!((disparities[128 * 5 + 1], disparities[129 * 5 + 1]), (512, NONE));
    assert_eq!(confidences[129 * 5 + 1], 0);
    // Along the row there is no limit.
    let (disparities, _) = filled(&plain(Plane::from_fn((400, 1), |x, _| if x == 0 { 512 } else { NONE })));
    assert_eq!(disparities, [512; 400]);
    let nothing = Plane::filled((4, 2), NONE);
    assert_eq!(filled(&plain(nothing.clone())), (nothing.into_data(), vec![0; 8]));
}

#[test]
fn hidden_pixels_stay_holes() {
    // A hole from column 20 on, of which the mask hides some words and parts of words.
    let map = Plane::from_fn((99, 3), |x, _| if x < 20 { 512 } else { NONE });
    let is_hidden = |x: u32, y: u32| y != 1 && (x == 21 || (30..66).contains(&x) || x == 98);
    let mask = Luma::from_fn((99, 3), |x, y| if is_hidden(x, y) { 0 } else { 255 });
    let (disparities, confidences) = filled(&FillTrial { own: Some(mask), ..plain(map) });
    for (index, (disparity, confidence)) in disparities.into_iter().zip(confidences).enumerate() {
        let (x, y) = (index as u32 % 99, index as u32 / 99);
        assert_eq!(disparity, if is_hidden(x, y) { NONE } else { 512 }, "{x}, {y}");
        assert_eq!(confidence == 0, is_hidden(x, y), "{x}, {y}");
    }
}

#[test]
fn filled_disparities_lie_in_the_range() {
    let steep = Plane::from_fn((60, 40), |x, _| if x < 30 { 3 * 256 - 40 * (29 - x as i32) } else { NONE });
    let trial = FillTrial { range: DisparityRange::new(0, 5).unwrap(), ..plain(steep) };
    let (disparities, _) = filled(&trial);
    assert_eq!(disparities[20 * 60 + 35], 3 * 256 + 40 * 6);
    assert_eq!(disparities[20 * 60 + 59], 4 * 256);
}

#[test]
fn a_speck_is_not_drawn_out() {
    // A speck that is nearer to these pixels of the hole than the surface beside.
    let map = Plane::from_fn((120, 60), |x, y| match x {
        0..40 => 9 * 256,
        70..74 if (28..32).contains(&y) => 5 * 256,
        _ => NONE,
    });
    let (disparities, _) = filled(&plain(map));
    for (x, y) in [(60, 30), (69, 30), (72, 20), (80, 22)] {
        assert_eq!(disparities[y * 120 + x], 9 * 256, "column {x}, row {y}");
    }
}

#[test]
fn rays_pass_what_is_doubtful() {
    // Two specks between a hole and a surface, and one beside the picture's edge, farther from the surface than the hole.
    let speck =
        |x: u32, y: u32| [20, 50, 80].iter().any(|&first| (first..first + 4).contains(&x)) && (28..32).contains(&y);
    let specks = Plane::from_fn((120, 60), |x, y| match x {
        100.. => 9 * 256,
        _ if speck(x, y) => 5 * 256,
        _ => NONE,
    });
    let (disparities, _) = filled(&plain(specks.clone()));
    for x in [0, 30, 49, 60, 79, 90] {
        assert_eq!(disparities[30 * 120 + x], 9 * 256, "column {x}");
    }
    // Where nothing else is known, a speck is what is known.
    let alone = specks.map(|&disparity| if disparity == 9 * 256 { NONE } else { disparity });
    let (disparities, confidences) = filled(&plain(alone));
    assert_eq!((disparities[30 * 120 + 30], confidences[30 * 120 + 30]), (5 * 256, 1));
    // Bars at the end of the range that was searched, before a surface that is not.
    let end = Plane::from_fn((120, 60), |x, _| match x {
        30..38 => 58 * 256,
        60..68 => 59 * 256,
        100.. => 9 * 256,
        _ => NONE,
    });
    let (disparities, _) = filled(&FillTrial { range: DisparityRange::new(0, 60).unwrap(), ..plain(end.clone()) });
    assert_eq!([45, 95].map(|x| disparities[30 * 120 + x]), [9 * 256; 2]);
    let (disparities, _) = filled(&FillTrial { range: DisparityRange::new(0, 99).unwrap(), ..plain(end) });
    assert_eq!([45, 95].map(|x| disparities[30 * 120 + x]), [58 * 256, 9 * 256]);
}
