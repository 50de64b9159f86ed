//! Trust in a map, and what follows from too little of it.

use hsad::{eval::conditions::Kind, image::Plane, io::Picture};

use crate::{
    pair::{Pair, changed},
    run::Run,
    scene::{Layer, layered, wall},
    texture::texture,
};

#[test]
fn good_maps_are_trusted() {
    for scene in ["planes", "curved"] {
        for preset in ["fast", "balanced"] {
            let pair = Pair::shipped(scene);
            let run = pair.matched(&["--preset", preset]).judges(&pair.truth).holds(&pair.truth, 72);
            if preset == "balanced" {
                assert!(run.code == 0 && run.trust() >= 0.5, "{scene}: {}", run.told);
            }
        }
    }
}

/// Block matching leaves more holes than semi-global matching, also in good maps.
#[test]
fn filled_maps_of_blocks_are_trusted() {
    for scene in ["planes", "weak"] {
        let pair = Pair::shipped(scene);
        pair.matched(&["--preset", "fast", "--fill"]).ends(0, &[]).judges(&pair.truth).errs_below(0.1, &pair.truth);
    }
}

/// A bare wall with a poster: most of the map is a guess.
#[test]
fn a_plain_wall_is_not_trusted() {
    let poster = Layer {
        disparity: 26.0,
        grey: |x, y| texture(x + 40.0, y),
        covers: |x, y| (40.0..110.0).contains(&x) && (40.0..120.0).contains(&y),
    };
    let picture = Layer {
        disparity: 40.0,
        grey: |x, y| texture(x + 500.0, y),
        covers: |x, y| (220.0..290.0).contains(&x) && (130.0..200.0).contains(&y),
    };
    let pair = layered((360, 240), &[poster, picture, wall(20.0, |_, _| 200.0)]);
    let pair = pair.with(|view, eye| changed(&view, Kind::Noise, 1.5, eye.into()));
    pair.matched(&[]).judges(&pair.truth);
    pair.matched(&["--preset", "fast", "--fill"]).judges(&pair.truth);
}

/// Both views blurred along rows, as when the camera moves: edges spread, and fit at the disparities of both of their sides.
#[test]
fn confidences_of_blurred_views_are_low() {
    let pair = Pair::shipped("planes");
    let sharp = pair.matched(&[]).ends(0, &[]);
    let blurred = pair.clone().with(|view, _| {
        Plane::from_fn(view.size(), |x, y| {
            let along = |channel: usize| {
                let sum: u32 = (-8..=8).map(|i| u32::from(view.get_clamped(i64::from(x) + i, y.into())[channel])).sum();
                ((2 * sum + 17) / 34) as u8
            };
            [along(0), along(1), along(2), 255]
        })
    });
    let run = blurred.matched(&[]).judges(&pair.truth);
    let sure = |run: &Run| run.confidence().data().iter().filter(|&&confidence| confidence >= 192).count();
    assert!(3 * sure(&run) < sure(&sharp), "{} of {}", sure(&run), sure(&sharp));
    let [_, wrong] = run.wrong_of_sure(&pair.truth);
    assert!(wrong.is_nan() || wrong < 0.02, "{wrong}");
}

/// Where both views are out of focus, neighbours agree on what is wrong: their costs have few independent pixels.
#[test]
fn views_out_of_focus_are_not_trusted() {
    for scene in ["planes", "curved"] {
        let pair = Pair::shipped(scene);
        let blurred = pair.clone().with(|view, eye| changed(&view, Kind::Blur, 6.0, eye.into()));
        let run = blurred.matched(&[]).ends(4, &["the map is not to be trusted"]).judges(&pair.truth);
        assert!(run.wrong(&pair.truth) > 0.2 && run.trust() < 0.4, "{scene}: {}", run.trust());
    }
}

#[test]
fn unrelated_pictures_are_not_trusted() {
    let pair = layered((320, 240), &[wall(12.0, texture)]);
    let other = layered((320, 240), &[wall(0.0, |x, y| texture(y + 5000.0, x + 3000.0))]);
    let pair = Pair { right: other.left, ..pair };
    let words = "the map is not to be trusted (trust 0.";
    let run = pair.matched(&[]).ends(4, &[words, "the files were written, and --force accepts the result"]);
    assert!(run.has("disparity.pfm") && run.has("report.json"));
    assert!(run.report()["not_trusted"].is_string(), "{}", run.report());
    let quiet = pair.matched(&["-q"]).ends(4, &[words]);
    assert!(quiet.told.starts_with("error: ") && quiet.told.lines().count() == 1, "{}", quiet.told);
    let forced = pair.matched(&["--force"]).ends(0, &["warning: ", words]);
    assert!(forced.has("disparity.pfm"));
}

/// Each pixel six times along its row and its column: disparities come in steps of 6 px.
#[test]
fn pictures_enlarged_without_interpolation_are_told() {
    let enlarged = |factor: u32| {
        Pair::shipped("planes").with(|view, _| {
            let size = view.size();
            Plane::from_fn(size, |x, y| view.get(x / factor * factor, y / factor * factor))
        })
    };
    let words = "both views were enlarged by 6 without interpolation, so that disparities come in steps of 6 px";
    enlarged(6).matched(&[]).ends(4, &[words, "the map is not to be trusted"]);
    let run = enlarged(2).matched(&[]).ends(0, &["both views were enlarged by 2 without interpolation"]);
    assert_eq!(run.report()["repetition"], 2);
    assert_eq!(Pair::shipped("planes").matched(&[]).report()["repetition"], 1);
}

#[test]
fn a_view_that_shows_nothing_is_named() {
    let pair = Pair::shipped("planes");
    let blank = |picture: &Picture| Picture::filled(picture.size(), [128, 128, 128, 255]);
    let run = pair.clone().with_right(blank).matched(&[]);
    run.ends(4, &["the right view shows no detail"]);
    pair.with(|picture, _| blank(&picture)).matched(&[]).ends(4, &["neither view shows any detail"]);
}
