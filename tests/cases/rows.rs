//! Rows of the views that do not correspond as they are.

use crate::pair::{Pair, lowered, resampled, transposed, upside_down};

#[test]
fn one_row_off_is_matched_as_well_as_none() {
    let pair = Pair::shipped("planes");
    let level = pair.matched(&[]).ends(0, &[]).wrong(&pair.truth);
    for rows in [1, 3] {
        let lower = pair.clone().with_right(|right| lowered(right, rows)).matched(&[]).ends(0, &[]);
        lower
            .never_says(&["warning"])
            .holds(&pair.truth, 72)
            .judges(&pair.truth)
            .errs_below(level + 0.015, &pair.truth);
    }
}

/// Both halves of a 3D lens: the right view is larger by 0.4 % and lies 2 px lower.
#[test]
fn a_3d_photograph_is_matched() {
    let pair = Pair::shipped("planes");
    let (scale, centre) = (1.004, [169.5, 127.0]);
    let level = pair.matched(&[]).wrong(&pair.truth);
    let mut pair = pair.with_right(|right| {
        resampled(right, |x, y| ((x - centre[0]) / scale + centre[0], (y - centre[1] - 2.0) / scale + centre[1]))
    });
    // The point at column x of the left view lies at x - d in the right one, enlarged about the centre.
    for (i, disparity) in pair.truth.data_mut().iter_mut().enumerate() {
        let x = (i % 340) as f64;
        *disparity = (x - centre[0] - scale * (x - f64::from(*disparity) - centre[0])) as f32;
    }
    let run = pair.matched(&[]).ends(0, &[]).holds(&pair.truth, 80).judges(&pair.truth);
    assert_eq!(run.report()["rectification"]["verdict"], "alignable");
    run.errs_below(level + 0.02, &pair.truth);
}

/// The distortion r (1 + k r^2) of a lens with k = -0.2 moves corners by a tenth of their distance from the centre.
#[test]
fn a_distorted_lens_is_told() {
    let distorted = |picture: &_| {
        resampled(picture, |x, y| {
            let (u, v) = ((x - 169.5) / 240.0, (y - 127.0) / 240.0);
            let factor = 1.0 + 0.2 * (u * u + v * v);
            (169.5 + 240.0 * factor * u, 127.0 + 240.0 * factor * v)
        })
    };
    let pair = Pair::shipped("planes").with(|view, _| distorted(&view));
    let run = pair.matched(&["--force"]).ends(0, &["warning: rows are off by up to ", "remove the distortion"]);
    assert!(run.range().min >= 0, "{:?}", run.range());
    assert!(run.report()["rectification"]["unexplained_px"].as_f64().unwrap() > 0.5);
    Pair::shipped("planes").matched(&[]).ends(0, &[]).never_says(&["distort"]);
}

#[test]
fn a_right_view_upside_down_is_named_and_turned_back() {
    let pair = Pair::shipped("planes");
    let turned = pair.clone().with_right(upside_down);
    let run =
        turned.matched(&[]).ends(3, &["the right view is upside down: turn the right view by 180 degrees", "--force"]);
    assert!(!run.has("report.json"));
    turned.with_right(upside_down).matched(&[]).ends(0, &[]).judges(&pair.truth);
}

#[test]
fn cameras_above_each_other_are_named() {
    let Pair { left, right, truth } = Pair::shipped("planes");
    let above = Pair { left: transposed(&left), right: transposed(&right), truth: transposed(&truth) };
    let words = "the cameras stand above each other: turn both views by 90 degrees";
    // A fit of rows has no meaning there.
    above.matched(&[]).ends(3, &[words]).never_says(&["clockwise", "larger", "smaller", "higher", "lower"]);
}

#[test]
fn figures_of_a_refusal_are_right() {
    let far = Pair::shipped("planes").with_right(|right| lowered(right, 40));
    let run = far.matched(&[]).ends(3, &["the right view lies ", " px lower", "rectify both views first"]);
    let figure = run.told.split("lies ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert!((figure.parse::<f64>().unwrap() - 40.0).abs() < 0.3, "{}", run.told);
}
