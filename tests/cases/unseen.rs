//! Pixels that do not show the scene: no disparity, no confidence, no colour, no point, and no influence on the rest.

use std::fs::File;

use hsad::{
    eval::conditions::Kind,
    image::{Plane, Size},
    io::png,
};

use crate::{
    pair::{Pair, changed},
    run::Run,
    scene::{Layer, layered, object, wall},
    texture::texture,
};

const CALIBRATION: [&str; 8] = ["--focal", "400", "--baseline", "0.1", "--max-depth", "inf", "--min-confidence", "0"];

/// Which pixels of the left (0) and of the right view (1) show the scene: 255, or 0.
type Seen = fn(u32, u32, u32) -> bool;

/// What a rotation of the views leaves empty: wedges along the sides, mirrored in the right view.
fn wedges(view: u32, x: u32, y: u32) -> bool {
    let x = if view == 0 { x } else { 339 - x };
    x * 10 > y && y * 15 > x && (339 - x) * 10 > 254 - y && (254 - y) * 15 > 339 - x
}

fn disc(_: u32, x: u32, y: u32) -> bool {
    let (u, v) = (i64::from(x) - 170, i64::from(y) - 127);
    u * u + v * v < 120 * 120
}

/// Neither at an edge nor of one grey value.
fn inside(view: u32, x: u32, y: u32) -> bool {
    !(200 - 40 * view..260 - 40 * view).contains(&x) || !(90..150).contains(&y)
}

fn mask(seen: Seen, view: u32, size: Size) -> Plane<u8> {
    Plane::from_fn(size, |x, y| if seen(view, x, y) { 255 } else { 0 })
}

/// `planes` with the pixels that are not seen replaced by `grey`.
fn hidden(seen: Seen, grey: u8) -> Pair {
    Pair::shipped("planes").with(|picture, view| {
        Plane::from_fn(
            picture.size(),
            |x, y| {
                if seen(view, x, y) { picture.get(x, y) } else { [grey, grey, grey, 255] }
            },
        )
    })
}

/// The truth where the left view shows the scene.
fn truth_where(pair: &Pair, seen: Seen) -> Plane<f32> {
    Plane::from_fn(pair.size(), |x, y| if seen(0, x, y) { pair.truth.get(x, y) } else { f32::INFINITY })
}

/// What is asked of each: nothing where nothing is seen, and no influence on range and brightness.
#[track_caller]
fn nothing_comes_of(seen: Seen, run: Run, pair: &Pair) {
    let truth = truth_where(pair, seen);
    let run = run.leaves_out(&mask(seen, 0, pair.size())).holds(&truth, 72).judges(&truth);
    // A point per disparity; those at 0 px lie at infinity.
    let near = |&&disparity: &&i32| disparity > 0 && disparity != hsad::disparity::NONE;
    assert_eq!(run.points(), run.disparity().data().iter().filter(near).count());
    let brightness = &run.report()["brightness"];
    let [gain, offset] = ["gain", "offset"].map(|part| brightness[part].as_f64().unwrap());
    assert!((gain - 1.0).abs() < 0.03 && offset.abs() < 3.0, "{brightness}");
}

#[test]
fn borders_of_a_rectification_are_found() {
    for grey in [0, 255] {
        let pair = hidden(wedges, grey);
        nothing_comes_of(wedges, pair.matched(&CALIBRATION), &pair);
    }
}

#[test]
fn a_round_mask_is_found() {
    let pair = hidden(disc, 0);
    let run = pair.matched(&CALIBRATION).leaves_out(&mask(disc, 0, pair.size()));
    assert!(run.range().min >= 0, "{:?}", run.range());
    run.holds(&truth_where(&pair, disc), 72).judges(&truth_where(&pair, disc));
}

/// A lower right view is resampled, and so is its mask.
#[test]
fn borders_of_views_whose_rows_are_off_are_found() {
    let pair = hidden(wedges, 0).with_right(|right| crate::pair::lowered(right, 2));
    pair.matched(&[]).ends(0, &[]).leaves_out(&mask(wedges, 0, pair.size())).judges(&truth_where(&pair, wedges));
}

/// What was not seen bears a texture that fits a disparity of 150 px.
fn wrong_texture(alpha: u8) -> Pair {
    Pair::shipped("planes").with(|picture, view| {
        Plane::from_fn(picture.size(), |x, y| {
            let grey = texture((x + 150 * view) as f32 * 3.0, y as f32 * 3.0) as u8;
            if inside(view, x, y) { picture.get(x, y) } else { [grey, 255 - grey, grey, alpha] }
        })
    })
}

#[test]
fn alpha_0_is_not_seen() {
    let pair = wrong_texture(0);
    nothing_comes_of(inside, pair.matched(&CALIBRATION), &pair);
}

#[test]
fn masks_are_not_seen() {
    let (pair, folder) = (wrong_texture(255), tempfile::tempdir().unwrap());
    let paths = [0, 1].map(|view| {
        let path = folder.path().join(format!("{view}.png"));
        png::write_grey8(&mut File::create(&path).unwrap(), &mask(inside, view, pair.size())).unwrap();
        path.display().to_string()
    });
    let args = [&CALIBRATION[..], &["--mask", &paths[0], &paths[1]]].concat();
    nothing_comes_of(inside, pair.matched(&args), &pair);
}

#[test]
fn missing_data_is_not_seen() {
    let pair = hidden(inside, 255).with(|picture, view| {
        // The scene has no white of its own.
        Plane::from_fn(picture.size(), |x, y| {
            let [red, green, blue, alpha] = picture.get(x, y);
            if inside(view, x, y) { [red.min(254), green.min(254), blue.min(254), alpha] } else { [255; 4] }
        })
    });
    nothing_comes_of(inside, pair.matched(&[&CALIBRATION[..], &["--nodata", "255"]].concat()), &pair);
}

/// Black things in the picture, one inside, one at the edge, are seen, in noise as a camera has.
#[test]
fn a_black_object_is_no_border() {
    let black = |disparity, covers| Layer { disparity, grey: |_, _| 3.0, covers };
    let scene = [
        black(30.0, |x, y| (230.0..280.0).contains(&x) && (160.0..260.0).contains(&y)),
        black(24.0, |x, y| (60.0..100.0).contains(&x) && (40.0..90.0).contains(&y)),
        object(20.0),
        wall(8.0, texture),
    ];
    let pair = layered((320, 240), &scene).with(|view, eye| changed(&view, Kind::Noise, 1.0, eye.into()));
    let run = pair.matched(&[]).ends(0, &[]).holds(&pair.truth, 48).judges(&pair.truth);
    let map = run.disparity();
    // Within an object without texture, noise may decide here and there.
    for (columns, rows, disparity) in [(232..278, 162..240, 30.0), (62..98, 42..88, 24.0)] {
        let places = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
        let found: Vec<_> = places.map(|(x, y)| hsad::disparity::pixels(map.get(x, y))).collect();
        assert!(found.iter().all(Option::is_some), "{columns:?}");
        let right = found.iter().flatten().filter(|&&found| (found - disparity).abs() < 2.0).count();
        assert!(right as f32 >= 0.7 * found.len() as f32, "{right} of {}", found.len());
    }
}
