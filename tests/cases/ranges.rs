//! Ranges of disparities, found and named.

use hsad::{
    disparity::{NONE, SCALE},
    eval::conditions::Kind,
    image::Plane,
};

use crate::{
    pair::{Pair, changed},
    scene::{layered, object, wall},
    texture::texture,
};

#[test]
fn the_range_of_weak_texture_holds_the_scene() {
    let pair = Pair::shipped("weak");
    let run = pair.matched(&[]).holds(&pair.truth, 60).judges(&pair.truth).errs_below(0.1, &pair.truth);
    assert!(run.trust() >= 0.5, "{}", run.trust());
}

/// What is far is out of focus and bears no interest points.
#[test]
fn the_range_of_a_blurred_scene_holds_the_blurred_part() {
    let pair = Pair::shipped("curved");
    let far = |disparity: f32| disparity < 30.0;
    let blurred = pair.clone().with(|view, _| changed(&view, Kind::Blur, 3.0, 0));
    let right_truth = Pair::exchanged("curved").truth.map(|disparity| -disparity);
    let defocused = Pair {
        left: Plane::from_fn(pair.size(), |x, y| {
            if far(pair.truth.get(x, y)) { blurred.left.get(x, y) } else { pair.left.get(x, y) }
        }),
        right: Plane::from_fn(pair.size(), |x, y| {
            if far(right_truth.get(x, y)) { blurred.right.get(x, y) } else { pair.right.get(x, y) }
        }),
        truth: pair.truth,
    };
    defocused.matched(&[]).holds(&defocused.truth, 80).judges(&defocused.truth);
}

/// Two pictures from one place, with the noise of a camera.
#[test]
fn no_parallax_is_no_depth() {
    let calibration = ["--focal", "500", "--baseline", "0.1"];
    let words = "the views show no parallax, as pictures from one place do: no depth follows from them";
    for (scene, sigma) in [("planes", 2.0), ("planes", 8.0), ("curved", 12.0), ("weak", 3.0)] {
        let left = Pair::shipped(scene).left;
        let truth = Plane::filled(left.size(), 0.0);
        let pair =
            Pair { left: changed(&left, Kind::Noise, sigma, 1), right: changed(&left, Kind::Noise, sigma, 2), truth };
        let run = pair.matched(&calibration).ends(4, &[words, "--force"]);
        assert!(!run.has("depth.pfm") && !run.has("cloud.ply") && run.has("disparity.pfm"), "{scene}");
        if sigma == 8.0 {
            let quiet = pair.matched(&["-q"]).ends(4, &[words]);
            assert!(quiet.told.starts_with("error: ") && quiet.told.lines().count() == 1, "{}", quiet.told);
            let forced = pair.matched(&[&calibration[..], &["--force"]].concat()).ends(0, &["warning: ", words]);
            assert!(forced.has("depth.pfm"));
        }
    }
}

/// An object on a twentieth of the picture is parallax.
#[test]
fn a_small_object_before_infinity_is_parallax() {
    let pair = layered((320, 240), &[object(6.0), wall(0.0, texture)]);
    pair.matched(&[]).ends(0, &[]).never_says(&["parallax"]).judges(&pair.truth);
}

#[test]
fn exchanged_views_are_told() {
    let pair = Pair::exchanged("planes");
    let words = "if left and right are mixed up, exchange them";
    let run = pair.matched(&[]).ends(0, &["warning: ", words]);
    run.holds(&pair.truth, 90).judges(&pair.truth).errs_below(0.1, &pair.truth);
    pair.matched(&["--min-disparity", "0"]).ends(1, &["error: the disparity range could not be found", words]);
    // By a calibration they lie behind the cameras.
    let run = pair.matched(&["--focal", "378", "--baseline", "0.1", "-q"]);
    run.ends(4, &["matched points lie behind the cameras by the calibration", "exchange left and right"]);
}

/// Near objects: the left 200 columns of the left view beside the right 200 of the right view, which lie 140 px further
/// right. Few points are seen in both.
#[test]
fn disparities_near_the_width_give_no_wrong_advice() {
    let Pair { left, right, truth } = Pair::shipped("planes");
    let size = (200, left.height());
    let near = Pair {
        left: Plane::from_fn(size, |x, y| left.get(x, y)),
        right: Plane::from_fn(size, |x, y| right.get(x + 140, y)),
        truth: Plane::from_fn(size, |x, y| truth.get(x, y) + 140.0),
    };
    let run = near.matched(&[]).ends(4, &["hardly any interest point was found in both views"]);
    run.never_says(&["lower --min-disparity", "an end of the range"]).holds(&near.truth, 200).judges(&near.truth);
}

#[test]
fn a_range_that_cuts_the_scene_is_told() {
    let pair = Pair::shipped("planes");
    for (args, end) in [
        (["--min-disparity", "0", "--disparities", "40"], " % of the disparities lie at 39 px, an end of the range"),
        (["--min-disparity", "24", "--disparities", "48"], " % of the disparities lie at 24 px, an end of the range"),
    ] {
        pair.matched(&args).ends(4, &["warning: ", end, "name a wider one"]).judges(&pair.truth);
    }
}

/// Where nothing shows a disparity below 0, none comes out, not even from noise beside a wall at infinity.
#[test]
fn nothing_lies_beyond_infinity() {
    let pair = layered((320, 240), &[object(12.0), wall(1.5, texture)])
        .with(|view, eye| changed(&view, Kind::Noise, 3.0, eye.into()));
    let run = pair.matched(&[]).ends(0, &[]).holds(&pair.truth, 30);
    assert_eq!(run.range().min, 0);
    let least = run.disparity().data().iter().copied().filter(|&disparity| disparity != NONE).min();
    assert!(least.is_some_and(|least| (0..2 * SCALE).contains(&least)), "{least:?}");
}
