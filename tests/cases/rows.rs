//! Rows of the views that do not correspond as they are.

use hsad::{
    image::Plane,
    io::{Picture, pfm},
};

use crate::{
    pair::{Pair, lowered, resampled, transposed, upside_down},
    run::Run,
};

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

/// A right view sheared by 0.15 makes all surfaces slant: a fit of the disparities has to be made without the shear, and to be
/// written with it.
#[test]
fn a_right_view_with_leaning_columns_is_matched() {
    let pair = Pair::shipped("planes");
    let level = pair.matched(&[]).wrong(&pair.truth);
    let mut leaning = pair.with_right(|right| resampled(right, |x, y| (x - 0.15 * (y - 127.0), y)));
    for (i, disparity) in leaning.truth.data_mut().iter_mut().enumerate() {
        *disparity -= 0.15 * ((i / 340) as f32 - 127.0);
    }
    let run = leaning.matched(&[]).ends(0, &[]);
    let lean = run.report()["rectification"]["lean"].as_f64().unwrap();
    assert!((-0.17..-0.13).contains(&lean), "{lean}");
    // Upright columns are searched over at most 58 disparities, which the lean over 255 rows widens.
    run.holds(&leaning.truth, 58 + (255.0 * lean.abs()) as u32)
        .judges(&leaning.truth)
        .errs_below(level + 0.02, &leaning.truth);
    // A range that is asked for is searched as asked.
    let asked = leaning.matched(&["--min-disparity", "-40", "--disparities", "110"]).ends(0, &[]);
    assert_eq!(asked.range().min, -40);
}

/// Both views turned alike, as from a hand that moved up and to the right: rows differ by the disparity, which no warp of the rows mends, and
/// which a plane through the parallax hides from most points.
#[test]
fn a_baseline_that_slants_in_the_pictures_is_rectified() {
    let pair = Pair::shipped("planes");
    for degrees in [-12.0_f64, 15.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let place = |x: f64, y: f64| {
            let (x, y) = (x - 169.5, y - 127.0);
            (cos * x - sin * y + 169.5, sin * x + cos * y + 127.0)
        };
        let turned = |picture: &Picture| resampled(picture, place);
        let slanting = Pair { left: turned(&pair.left), right: turned(&pair.right), ..pair.clone() };
        let run = slanting.matched(&["--map-back"]).ends(0, &["do not stand side by side"]);
        assert_eq!(run.report()["rectified"]["method"], "uncalibrated", "{degrees}");
        let truth = Plane::from_fn(pair.size(), |x, y| {
            let (x, y) = place(x.into(), y.into());
            let inside = (0.0..=339.0).contains(&x) && (0.0..=254.0).contains(&y);
            if inside { pair.truth.get(x.round() as u32, y.round() as u32) } else { f32::NAN }
        });
        let (_, wrong) = run.wrong_but_for_a_constant(&truth);
        assert!(wrong < 0.1, "{degrees}: {wrong}");
        slanting.matched(&["--rectify", "never"]).ends(3, &["do not stand side by side"]);
    }
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
    let run = pair.matched(&["--rectify", "never", "--force"]);
    let run = run.ends(0, &["warning: rows are off by up to ", "remove the distortion"]);
    assert!(run.range().min >= 0, "{:?}", run.range());
    assert!(run.report()["rectification"]["unexplained_px"].as_f64().unwrap() > 0.5);
    Pair::shipped("planes").matched(&[]).ends(0, &[]).never_says(&["distort"]);
}

#[test]
fn the_distortion_of_a_lens_is_removed() {
    let lens = |x: f64, y: f64| {
        let (u, v) = ((x - 169.5) / 240.0, (y - 127.0) / 240.0);
        let factor = 1.0 + 0.3 * (u * u + v * v);
        (169.5 + 240.0 * factor * u, 127.0 + 240.0 * factor * v)
    };
    let pair = Pair::shipped("planes").with(|view, _| resampled(&view, lens));
    let as_is = pair.matched(&["--rectify", "never"]).ends(0, &["as by a distorted lens"]);
    let run = pair.matched(&[]).ends(0, &["the lens distorts the pictures"]).never_says(&["as by a distorted lens"]);
    // The inverse of the lens above has more terms than one.
    let k1 = run.report()["rectified"]["k1"].as_f64().unwrap();
    assert!((-0.4..-0.2).contains(&k1), "{k1}");
    let unexplained = |run: &Run| run.report()["rectification"]["unexplained_px"].as_f64().unwrap();
    assert!(unexplained(&as_is) > 1.0 && unexplained(&run) == 0.0);
    // With a focal length and a baseline depth is worth more than rows.
    let run = pair.matched(&["--focal", "378", "--baseline", "0.1", "--doffs", "14"]);
    assert!(run.ends(0, &["as by a distorted lens"]).has("depth.pfm"));
}

#[test]
fn a_right_view_upside_down_is_named_and_turned_back() {
    let pair = Pair::shipped("planes");
    let turned = pair.clone().with_right(upside_down);
    let words = "the right view is upside down: turn the right view by 180 degrees";
    let run = turned.matched(&["--rectify", "never"]).ends(3, &[words, "--force"]);
    assert!(!run.has("report.json"));
    // Without being told, too: the left view stays, and so does the truth.
    let run = turned.matched(&[]).ends(0, &[words, "rectified from its matches"]).judges(&pair.truth);
    assert!(run.has("rectified-right.png"));
    run.errs_below(pair.matched(&[]).wrong(&pair.truth) + 0.02, &pair.truth);
    turned.with_right(upside_down).matched(&[]).ends(0, &[]).judges(&pair.truth);
}

#[test]
fn cameras_above_each_other_are_named() {
    let Pair { left, right, truth } = Pair::shipped("planes");
    let above = Pair { left: transposed(&left), right: transposed(&right), truth: transposed(&truth) };
    let words = "the cameras stand above each other: turn both views by 90 degrees";
    // A fit of rows has no meaning there.
    let figures = ["clockwise", "larger", "smaller", "higher", "lower"];
    above.matched(&["--rectify", "never"]).ends(3, &[words]).never_says(&figures);
    let run = above.matched(&["--map-back"]).ends(0, &[words]);
    assert_eq!(run.report()["rectified"]["model"], "both views");
    // Columns of views that are both turned are known but for a shift.
    let (constant, wrong) = run.wrong_but_for_a_constant(&above.truth);
    assert!(constant.abs() < 20.0 && wrong < 0.1, "{constant} {wrong}");
}

#[test]
fn figures_of_a_refusal_are_right() {
    let far = Pair::shipped("planes").with_right(|right| lowered(right, 40));
    let run = far
        .matched(&["--rectify", "never"])
        .ends(3, &["the right view lies ", " px lower", "--rectify never", "--force"]);
    let figure = run.told.split("lies ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert!((figure.parse::<f64>().unwrap() - 40.0).abs() < 0.3, "{}", run.told);
}

/// The position that a camera which turned to the right by `angle` shows at a pixel: that of the scene's own picture.
fn panned(angle: f64) -> impl Fn(f64, f64) -> (f64, f64) {
    let (sin, cos) = angle.sin_cos();
    move |x, y| {
        let (x, y) = ((x - 169.5) / 378.0, (y - 127.0) / 378.0);
        let depth = cos - sin * x;
        (378.0 * (cos * x + sin) / depth + 169.5, 378.0 * y / depth + 127.0)
    }
}

#[test]
fn a_right_view_turned_far_and_smaller_is_rectified() {
    let pair = Pair::shipped("planes");
    let (sin, cos) = 12_f64.to_radians().sin_cos();
    let turned = pair.clone().with_right(|right| {
        resampled(right, |x, y| {
            let (x, y) = ((x - 169.5) / 0.9, (y - 127.0) / 0.9);
            (cos * x - sin * y + 169.5, sin * x + cos * y + 127.0)
        })
    });
    turned.matched(&["--rectify", "never"]).ends(3, &["--force"]);
    let run = turned.matched(&[]).ends(0, &["rectified from its matches"]);
    assert_eq!(run.report()["rectified"]["model"], "affine");
    // The last digits of orientations, which devices differ in, are gone.
    let on_cpu = turned.matched(&["--device", "cpu"]).ends(0, &[]);
    assert!(on_cpu.disparity() == run.disparity(), "another map without a device");
    // The left view stays.
    run.errs_below(pair.matched(&[]).wrong(&pair.truth) + 0.05, &pair.truth);
}

#[test]
fn a_camera_that_turned_to_the_side_is_named() {
    let pair = Pair::shipped("planes");
    let turned = pair.clone().with_right(|_| resampled(&pair.left, panned(0.12)));
    let words = "the camera turned on the spot, and disparities tell no depth";
    let run = turned.matched(&["--focal", "378", "--baseline", "0.1"]).ends(4, &[words]).never_says(&["exchange"]);
    assert_eq!((run.trust(), &run.report()["no_depth"]), (0.0, &"turned on the spot".into()));
    assert!(!run.has("depth.pfm") && run.confidence().data().iter().all(|&confidence| confidence < 192));
    let quiet = turned.matched(&["-q"]).ends(4, &[words]);
    assert!(quiet.told.starts_with("error: ") && quiet.told.lines().count() == 1, "{}", quiet.told);
    turned.matched(&["--force"]).ends(0, &["warning: the camera turned on the spot"]);
    pair.matched(&[]).never_says(&["on the spot"]);
}

/// Rows of a right camera that looks to the side are aligned, and the constant of the disparities remains.
#[test]
fn a_right_camera_that_looks_to_the_side_tells_no_depth() {
    let pair = Pair::shipped("planes").with_right(|right| resampled(right, panned(0.02)));
    let calibration = ["--focal", "378", "--baseline", "0.1", "--doffs", "14"];
    let run = pair.matched(&calibration).ends(5, &["by its rows the right camera looks 1.", "--no-align", "no depth"]);
    assert!(!run.has("depth.pfm") && !run.has("cloud.ply"));
    pair.matched(&[]).ends(0, &[]).never_says(&["to the side"]);
    let run = Pair::shipped("planes").matched(&calibration).ends(0, &[]).never_says(&["to the side"]);
    assert!(run.has("depth.pfm"));
}

#[test]
fn a_mirror_image_is_named() {
    let pair = Pair::shipped("planes");
    let mirrored = |rows: bool, columns: bool| {
        pair.clone().with_right(|right| {
            let at = |mirrored: bool, place: u32, side: u32| if mirrored { side - 1 - place } else { place };
            Picture::from_fn(right.size(), |x, y| right.get(at(columns, x, 340), at(rows, y, 255)))
        })
    };
    let words = "one view is a mirror image of the other, ";
    for (mirrored, sides) in [(mirrored(false, true), "left and right"), (mirrored(true, false), "top and bottom")] {
        let run = mirrored.matched(&[]).never_says(&["negative", "upside down", "unrelated"]);
        assert!([3, 4].contains(&run.code) && run.told.contains(words) && run.told.contains(sides), "{}", run.told);
        let run = mirrored.matched(&["--rectify", "uncalibrated"]).ends(3, &[words, sides]);
        run.never_says(&["unrelated"]);
    }
    let unrelated = Pair { right: Pair::shipped("curved").right, ..pair.clone() };
    unrelated.matched(&[]).ends(4, &[]).never_says(&[words]);
}

#[test]
fn what_shows_no_depth_is_named() {
    let pair = Pair::shipped("planes");
    let same = |change: &dyn Fn(f64, f64) -> (f64, f64)| {
        pair.clone().with_right(|_| resampled(&pair.left, change)).matched(&["--rectify", "uncalibrated"])
    };
    same(&panned(0.12)).ends(3, &["the camera turned on the spot, "]);
    // A plane that leans back: rows are further apart at the top.
    same(&|x, y| {
        let depth = 1.0 + 0.0012 * (y - 127.0);
        ((x - 169.5) / depth + 180.0, (y - 127.0) / depth + 147.0)
    })
    .ends(3, &["the views show a plane, "]);
    // Rows that a small warp mends: a plane from two places, and a camera that rolled.
    let near = |change: &dyn Fn(f64, f64) -> (f64, f64)| {
        pair.clone().with_right(|_| resampled(&pair.left, change)).matched(&[])
    };
    near(&|x, y| {
        let depth = 1.0 + 0.0002 * (x - 169.5);
        ((x - 169.5) / depth + 180.0, (y - 127.0) / depth + 128.0)
    })
    .ends(4, &["the views show a plane, "]);
    let (sin, cos) = 0.03_f64.sin_cos();
    near(&|x, y| (cos * (x - 169.5) - sin * (y - 127.0) + 180.0, sin * (x - 169.5) + cos * (y - 127.0) + 127.0))
        .ends(4, &["the views show a plane, or the camera turned on the spot"]);
    // A stereo camera sees a wall so.
    near(&|x, y| (0.9 * (x - 169.5) + 150.0, y)).ends(0, &[]).never_says(&["plane"]);
    let unrelated = Pair { right: Pair::shipped("curved").right, ..pair.clone() };
    unrelated.matched(&["--rectify", "uncalibrated"]).ends(3, &["the views are unrelated"]);
}

#[test]
fn lenses_with_a_calibration_cost_nothing_but_the_edges() {
    // Focal length 378 px, and the right camera 14 px of principal point and 100 mm to the right: see `meta.json`.
    let lens = |centre: f64| {
        move |x: f64, y: f64| {
            let (u, v) = ((x - centre) / 378.0, (y - 127.0) / 378.0);
            // The inverse of u (1 - 0.2 r^2), to 1/1000 px within the picture.
            let square = u * u + v * v;
            let factor = 1.0 + 0.2 * square + 0.12 * square * square + 0.096 * square * square * square;
            (centre + 378.0 * factor * u, 127.0 + 378.0 * factor * v)
        }
    };
    let pair = Pair::shipped("planes");
    let taken = pair.clone().with(|view, side| resampled(&view, lens(if side == 0 { 169.5 } else { 183.5 })));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rig.json");
    let camera = |cx: f64| {
        format!("{{\"focal\": [378, 378], \"centre\": [{cx}, 127], \"model\": \"pinhole\", \"distortion\": [-0.2]}}")
    };
    let rig = format!("{{\"left\": {}, \"right\": {}, \"translation\": [-0.1, 0, 0]}}", camera(169.5), camera(183.5));
    std::fs::write(&file, rig).unwrap();
    let run = taken.matched(&["--map-back", "--calib", file.to_str().unwrap()]).ends(0, &[]);
    assert!(run.has("cloud.ply") && run.report()["mapped_back"] == true);
    let depth = pfm::read(&run.path("depth.pfm")).unwrap();
    // The lens leaves axis and depth alone: depth at a pixel is that of the scene where the pixel looks.
    let (mut wrong, mut count) = (0, 0);
    for (x, y) in (0..255).flat_map(|y| (0..340).map(move |x| (x, y))) {
        let (u, v) = lens(169.5)(f64::from(x), f64::from(y));
        let truth = pair.truth.get_clamped(u.round() as i64, v.round() as i64);
        if truth.is_finite() && (0.0..339.0).contains(&u) && (0.0..254.0).contains(&v) {
            let disparity = 37.8 / f64::from(depth.get(x, y)) - 14.0;
            count += 1;
            wrong += usize::from((disparity - f64::from(truth)).abs() > 2.0 || !depth.get(x, y).is_finite());
        }
    }
    let without = pair.matched(&[]).wrong(&pair.truth);
    assert!((wrong as f64) < (without + 0.06) * f64::from(count), "{wrong} of {count}, {without} without a lens");
}
