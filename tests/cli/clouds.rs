//! `cloud.ply` of `hsad match`: which pixels become points.

use std::{fs, path::Path};

use hsad::io::{load, pfm};
use predicates::str::contains;
use serde_json::json;

use crate::common::{cloud, fails, folder, match_on_cpu, report, views};

/// `depth.png` has `depths`, in metres, as far as 16 bits hold millimetres.
fn check_millimetres(out: &Path, depths: &[f32]) {
    let values = image::load_from_memory(&fs::read(out.join("depth.png")).unwrap()).unwrap().into_luma16().into_raw();
    let mut beyond = 0;
    for (&value, &depth) in values.iter().zip(depths) {
        match depth {
            depth if depth.is_infinite() => assert_eq!(value, 0),
            depth if depth > 65.5354 => {
                beyond += 1;
                assert_eq!(value, 0);
            }
            depth => assert!((f64::from(value) - 1000.0 * f64::from(depth)).abs() <= 0.5001, "{value} {depth}"),
        }
    }
    assert!(beyond > 0);
    let told =
        json!({ "metres_per_value": 0.001, "left_out": { "beyond_65.535_m": beyond, "nearer_than_half_a_value": 0 } });
    assert_eq!(report(out)["depth_png"], told);
}

/// `mesh.ply` joins most of the cloud's points, of which there are `points`, and faces the camera.
fn check_mesh(out: &Path, points: usize) {
    let bytes = fs::read(out.join("mesh.ply")).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let count = |element: &str| -> usize {
        let line = text.lines().find_map(|line| line.strip_prefix(&format!("element {element} "))).unwrap();
        line.parse().unwrap()
    };
    let (vertices, faces) = (count("vertex"), count("face"));
    assert!(
        vertices <= points && 10 * vertices > 9 * points && faces > vertices && faces < 2 * vertices,
        "{points} {text:.300}"
    );
    let body = &bytes[bytes.len() - 27 * vertices - 13 * faces..];
    let number = |vertex: &[u8], place: usize| f32::from_le_bytes(vertex[4 * place..4 * place + 4].try_into().unwrap());
    for vertex in body[..27 * vertices].chunks_exact(27) {
        let [x, y, z, nx, ny, nz] = [0, 1, 2, 3, 4, 5].map(|place| number(vertex, place));
        assert!(z <= 1.0 && x * nx + y * ny + z * nz < 0.0, "{x} {y} {z} {nx} {ny} {nz}");
    }
    assert!(report(out)["files"].as_array().unwrap().contains(&json!("mesh.ply")));
}

#[test]
fn the_cloud_has_measured_points_of_known_depth() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    // The disparities of the scene are 9.1 to 57.5 px: some are nearly infinity.
    let run = |name: &str, args: &[&str]| {
        let out = temporary.path().join(name);
        let mut command = match_on_cpu(&left, &right, &out);
        command.args(["--disparities", "72", "--focal", "300", "--baseline", "0.1", "--doffs", "-9"]).args(args);
        command.assert().success().stdout(contains("cloud "));
        let depth = pfm::read(&out.join("depth.pfm")).unwrap();
        check_millimetres(&out, depth.data());
        let confidence = load::load(&out.join("confidence.png")).unwrap().luma();
        let pixels = depth.into_data().into_iter().zip(confidence.into_data());
        (cloud(&out), report(&out)["cloud"].clone(), pixels.collect::<Vec<_>>())
    };
    let check = |name: &str, args: &[&str], max_depth: f32, min_confidence: u8| {
        let (points, told, pixels) = run(name, args);
        let depths = pixels.iter().filter(|&&(z, confidence)| z <= max_depth && confidence >= min_confidence);
        let depths: Vec<f64> = depths.map(|&(z, _)| z.into()).collect();
        assert!(points.iter().map(|point| point.z).eq(depths), "{name}: {told}");
        let sure = pixels.iter().filter(|&&(_, confidence)| confidence >= min_confidence).count();
        assert_eq!((&told["points"], &told["min_confidence"]), (&json!(points.len()), &json!(min_confidence)));
        assert_eq!(told["left_out"]["beyond_max_depth"], json!(sure - points.len()));
        assert_eq!(told["left_out"]["below_min_confidence"], json!(pixels.len() - sure));
        (points.len(), told["max_depth_m"].as_f64())
    };
    // Half a pixel is a tenth of 5 px, and 300 px * 0.1 m / 5 px is 6 m.
    let (points, max_depth) = check("usual", &[], 6.0, 16);
    assert!((max_depth.unwrap() - 6.0).abs() < 1e-9 && points > 10_000, "{points}");
    let (filled, _) = check("filled", &["--filled"], 6.0, 1);
    let (sure, _) = check("sure", &["--min-confidence", "200"], 6.0, 200);
    let (near, nearest) = check("near", &["--max-depth", "1", "--mesh"], 1.0, 16);
    let (all, farthest) = check("all", &["--max-depth", "inf"], f32::MAX, 16);
    check_mesh(&temporary.path().join("near"), near);
    assert!(near < points && sure < points && points < filled && points < all, "{near} {sure} {points} {filled} {all}");
    assert_eq!((nearest, farthest), (Some(1.0), None));
    let told = contains("lie beyond 0.600 m and are not in cloud.ply: --max-depth keeps them");
    let mut command = match_on_cpu(&left, &right, &temporary.path().join("none"));
    command.args(["--disparities", "72", "--focal", "300", "--baseline", "0.1", "--max-depth", "0.6"]);
    command.assert().success().stderr(told);
}

#[test]
fn options_of_a_cloud_that_is_not_written_are_refused() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let out = temporary.path().join("out");
    let refused = |args: &[&str], expected: &str| {
        let mut command = match_on_cpu(&left, &right, &out);
        command.args(args);
        fails(command, 2, expected);
        assert!(!out.exists());
    };
    for args in [&["--max-depth", "30"][..], &["--min-confidence", "99"], &["--filled"], &["--mesh"]] {
        refused(
            args,
            "without a calibration there is no point cloud: name one with --calib, or give --focal and --baseline",
        );
    }
    for depth in ["0", "-1", "nan"] {
        refused(&["--focal", "300", "--baseline", "0.1", "--max-depth", depth], "it must be above 0 metres");
    }
}
