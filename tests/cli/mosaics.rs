//! `hsad match` of raw mosaics.

use std::path::Path;

use hsad::{
    eval,
    io::{load, pfm},
};
use predicates::str::contains;
use serde_json::json;

use crate::common::{folder, grey_png, match_on_cpu, report, scene, views};

/// Writes the mosaic of a view, red at the odd columns of the even rows.
fn mosaic_of(view: &Path, path: &Path) {
    let colors = load::load(view).unwrap();
    let mut grey = colors.luma();
    for (x, y) in (0..colors.height()).flat_map(|y| (0..colors.width()).map(move |x| (x, y))) {
        let [red, green, blue] = colors.rgb(x, y);
        grey.set(x, y, [[green, red], [blue, green]][y as usize % 2][x as usize % 2]);
    }
    grey_png(path, &grey);
}

/// Matches two views on the CPU: the share of pixels that are wrong by more than 1 px, and what stderr says.
fn wrong(left: &Path, right: &Path, out: &Path) -> (f64, String) {
    let output = match_on_cpu(left, right, out).assert().success().get_output().clone();
    let map = pfm::read_disparities(&out.join("disparity.pfm")).unwrap();
    let truth = pfm::read(&scene("planes", "disp_left.pfm")).unwrap();
    let score = eval::score(&map, &truth, None, &[1.0]).unwrap();
    (score.bad[0].of_known, String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_mosaic_is_told_and_matched_almost_as_well_as_a_picture() {
    let (temporary, views) = (folder(), views("planes"));
    let mosaics = ["left.png", "right.png"].map(|name| temporary.path().join(name));
    views.iter().zip(&mosaics).for_each(|(view, path)| mosaic_of(view, path));
    let out = temporary.path().join("out");
    // Without colours, which guide the filling of holes and which a mosaic does not have.
    let greys = ["grey-left.png", "grey-right.png"].map(|name| temporary.path().join(name));
    views.iter().zip(&greys).for_each(|(view, path)| grey_png(path, &load::load(view).unwrap().luma()));
    let (expected, told) = wrong(&greys[0], &greys[1], &out);
    assert_eq!((told.as_str(), &report(&out)["mosaics"]), ("", &json!({ "left": false, "right": false })));

    let (found, told) = wrong(&mosaics[0], &mosaics[1], &out);
    assert!(found < expected + 0.01, "{found} of the mosaic, {expected} of the picture");
    let warning = "both views are raw Bayer mosaics: the luma of the colours was matched";
    assert!(told.starts_with(&format!("warning: {warning}")), "{told}");
    let report = report(&out);
    assert_eq!(report["mosaics"], json!({ "left": true, "right": true }));
    assert!(report["warnings"][0].as_str().unwrap().starts_with(warning), "{}", report["warnings"]);
}

#[test]
fn a_mosaic_beside_a_picture_is_told() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let mosaic = temporary.path().join("mosaic.png");
    mosaic_of(&right, &mosaic);
    let out = temporary.path().join("out");
    for method in ["hsad", "kamencay"] {
        let mut command = match_on_cpu(&left, &mosaic, &out);
        command.args(["--disparities", "72", "--method", method]);
        command.assert().success().stderr(contains("warning: the right view is a raw Bayer mosaic").count(1));
        assert_eq!(report(&out)["mosaics"], json!({ "left": false, "right": true }));
    }
}
