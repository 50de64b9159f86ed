//! Pairs as they were taken, rectified by the calibration of their cameras.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hsad::{
    calibration::{CameraModel, Lens, RadialTangential, StereoCalibration},
    glam::{DMat3, DVec2, DVec3},
    image::{Plane, Size},
    io::{Picture, calibration::to_json, load, pfm, png},
    rectify::CalibratedRectification,
};
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;
use tempfile::TempDir;

use crate::common::{RECTIFIED, cloud, folder, hsad, names, report, scene};

/// The cameras of the scene `planes`: focal length and principal points in pixels, baseline in metres.
const FOCAL: f64 = 378.0;
const CENTRES: [DVec2; 2] = [DVec2::new(169.5, 127.0), DVec2::new(183.5, 127.0)];
const BASELINE: f64 = 0.1;
const SIZE: Size = Size::new(340, 255);

/// The scene `planes` as turned cameras with distorted lenses take it.
struct Taken {
    folder: TempDir,
    pictures: [PathBuf; 2],
    calibration: PathBuf,
    stereo: StereoCalibration,
}

fn camera() -> CameraModel {
    let lens = Lens::Pinhole(RadialTangential::new(&[-0.15, 0.03]).unwrap());
    CameraModel::new(DVec2::new(350.0, 352.0), DVec2::new(171.0, 126.0), lens).unwrap()
}

/// From the scene's coordinates to those of the left and of the right camera.
fn turns() -> [DMat3; 2] {
    let turn = |x, y, z| DMat3::from_rotation_x(x) * DMat3::from_rotation_y(y) * DMat3::from_rotation_z(z);
    [turn(0.02, -0.03, 0.06), turn(-0.03, 0.04, -0.05)]
}

/// The position in a picture of the scene that a pixel of a taken picture shows.
fn in_scene(view: usize, pixel: DVec2) -> DVec2 {
    let ray = turns()[view].transpose() * camera().unproject(pixel).unwrap();
    FOCAL * ray.truncate() / ray.z + CENTRES[view]
}

fn stereo(right_turn: DMat3) -> StereoCalibration {
    let shift = right_turn * DVec3::new(-BASELINE, 0.0, 0.0);
    StereoCalibration::new([camera(); 2], [Some(SIZE); 2], right_turn * turns()[0].transpose(), shift).unwrap()
}

impl Taken {
    fn new() -> Self {
        let folder = folder();
        let pictures = [(0, "left.png"), (1, "right.png")].map(|(view, name)| {
            let source = load::load(&scene("planes", name)).unwrap();
            let taken = Picture::from_fn(SIZE, |x, y| shown(&source, in_scene(view, DVec2::new(x.into(), y.into()))));
            let path = folder.path().join(format!("taken-{name}"));
            let mut bytes = Vec::new();
            png::write_rgba8(&mut bytes, &taken).unwrap();
            fs::write(&path, bytes).unwrap();
            path
        });
        let stereo = stereo(turns()[1]);
        let calibration = folder.path().join("rig.json");
        fs::write(&calibration, to_json(&stereo)).unwrap();
        Self { folder, pictures, calibration, stereo }
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn run(&self, command: &str, args: &[&str]) -> assert_cmd::assert::Assert {
        let mut program = hsad();
        program.arg(command).args(&self.pictures).arg("-o").arg(self.out()).args(args);
        if !args.contains(&"--device") {
            program.args(["--device", "cpu"]);
        }
        program.assert()
    }

    fn run_calibrated(&self, command: &str, args: &[&str]) -> assert_cmd::assert::Assert {
        self.run(command, &[args, &["--calib", self.calibration.to_str().unwrap()]].concat())
    }

    /// Depth of a pixel of the taken left view in its camera, in metres; `None` where it is not known.
    fn depth(truth: &Plane<f32>, pixel: DVec2) -> Option<f64> {
        let place = in_scene(0, pixel);
        let nearest = place.round();
        let is_inside = nearest.cmpge(DVec2::ZERO).all() && nearest.x < 340.0 && nearest.y < 255.0;
        let disparity = is_inside.then(|| truth.get(nearest.x as u32, nearest.y as u32)).filter(|d| d.is_finite())?;
        let depth = BASELINE * FOCAL / (f64::from(disparity) + CENTRES[1].x - CENTRES[0].x);
        Some((turns()[0] * (((place - CENTRES[0]) / FOCAL).extend(1.0) * depth)).z)
    }
}

/// The bilinear value of a picture at a place; transparent outside.
fn shown(picture: &Picture, place: DVec2) -> [u8; 4] {
    let Size { width, height } = picture.size();
    let first = place.floor();
    if first.x < 0.0 || first.y < 0.0 || first.x >= f64::from(width - 1) || first.y >= f64::from(height - 1) {
        return [0; 4];
    }
    let (x, y, part) = (first.x as u32, first.y as u32, place - first);
    [0, 1, 2, 3].map(|channel| {
        let at = |i, j| f64::from(picture.get(x + i, y + j)[channel]);
        let row = |j| at(0, j) * (1.0 - part.x) + at(1, j) * part.x;
        (row(0) * (1.0 - part.y) + row(1) * part.y).round() as u8
    })
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Shares of depths that lie within 3 % of the truth, and number of depths that the truth knows.
fn right_depths(depths: impl Iterator<Item = (DVec2, f64)>) -> (f64, usize) {
    let truth = pfm::read(&scene("planes", "disp_left.pfm")).unwrap();
    let known = depths.filter_map(|(pixel, depth)| Some((depth, Taken::depth(&truth, pixel)?)));
    let (right, count) =
        known.fold((0, 0), |(right, n), (z, truth)| (right + usize::from((z / truth - 1.0).abs() < 0.03), n + 1));
    (right as f64 / f64::from(count), count as usize)
}

#[test]
fn points_behind_the_cameras_are_told() {
    let mut taken = Taken::new();
    let told = || contains("matched points lie behind the cameras").and(contains("the translation has the wrong sign"));
    // The translation from the right to the left camera for that from the left to the right one.
    let json = to_json(&taken.stereo);
    let mut file: Value = serde_json::from_str(&json).unwrap();
    for part in file["translation"].as_array_mut().unwrap() {
        *part = Value::from(-part.as_f64().unwrap());
    }
    fs::write(&taken.calibration, file.to_string()).unwrap();
    taken.run_calibrated("match", &["-q"]).code(3).stderr(told());
    taken.run_calibrated("rectify", &["-q"]).code(3).stderr(told());
    assert!(!taken.out().exists());
    // Exchanged views.
    fs::write(&taken.calibration, json).unwrap();
    taken.pictures.reverse();
    taken.run_calibrated("match", &["-q"]).code(3).stderr(contains("left and right are mixed up"));
}

#[test]
fn a_calibration_of_other_cameras_gives_no_depth() {
    let taken = Taken::new();
    let options = ["--preset", "fast", "-q"];
    // The right camera turned to the side, and then up, by 1.7 degrees: rows are aligned all the same.
    for (turn, told) in [
        (DMat3::from_rotation_y(0.03), "the right camera looks 1."),
        (DMat3::from_rotation_x(0.03), "matches correspond, and rows differ by up to"),
    ] {
        fs::write(&taken.calibration, to_json(&stereo(turn * turns()[1]))).unwrap();
        taken.run_calibrated("match", &options[..2]).code(5).stderr(contains(told).and(contains("does not fit")));
        assert!(!taken.out().join("depth.pfm").exists() && taken.out().join("disparity.pfm").exists());
    }
    taken.run_calibrated("match", &[&options[..], &["--force"]].concat()).success();
    assert!(taken.out().join("depth.pfm").exists());
}

#[test]
fn a_pair_is_rectified_by_its_calibration() {
    let taken = Taken::new();
    taken.run_calibrated("rectify", &[]).success().stdout(contains("by the calibration, the left view turned by"));
    let out = taken.out();
    assert_eq!(names(&out), RECTIFIED);
    let rectified = json(&out.join("rectification.json"));
    assert_eq!(report(&out)["rectified"], rectified);
    assert_eq!(rectified["method"], "calibrated");
    let figure = |value: &Value| value.as_f64().unwrap();
    let [points, right] = ["points", "right"].map(|name| figure(&rectified["residual"][name]));
    assert!(points > 100.0 && right > 0.7 * points, "{rectified}");
    assert!(figure(&rectified["residual"]["mean_px"]) < 0.5, "{rectified}");
    assert!((figure(&rectified["Q"][3][2]) * BASELINE - 1.0).abs() < 1e-9);
    assert!((figure(&rectified["calibration"]["baseline_m"]) - BASELINE).abs() < 1e-9);
    let yaml = fs::read_to_string(out.join("rectification.yml")).unwrap();
    assert!(["R1", "R2", "P1", "P2", "Q"].iter().all(|name| yaml.contains(&format!("\n{name}: !!opencv-matrix"))));
    let mask = load::load(&out.join("left-mask.png")).unwrap().luma();
    let left = load::load(&out.join("left.png")).unwrap();
    assert!(mask.data().iter().zip(left.data()).all(|(mask, pixel)| *mask == pixel[3]));
    let seen = mask.data().iter().filter(|&&value| value == 255).count();
    assert!(mask.data().contains(&0) && seen * 2 > mask.data().len(), "{seen}");
    // The pictures are those of a rectified pair, and the matrices their calibration.
    let [left, right, yaml] = ["left.png", "right.png", "rectification.yml"].map(|name| out.join(name));
    let again = taken.folder.path().join("again");
    let mut program = hsad();
    program.arg("match").args([left, right]).arg("-o").arg(&again).arg("--calib").arg(yaml).args(["--device", "cpu"]);
    program.assert().success();
    let found = report(&again);
    assert_eq!((&found["rectified"], &found["rectification"]["rows"]["model"]), (&Value::Null, &"as is".into()));
    assert_eq!(found["calibration"]["focal_px"], rectified["calibration"]["focal_px"]);
}

#[test]
fn a_device_and_the_cpu_write_the_same_rectified_bytes() {
    let taken = Taken::new();
    let [cpu, device] = ["cpu", "best"].map(|device| {
        taken.run_calibrated("rectify", &["--device", device]).success();
        ["left.png", "right.png", "left-mask.png", "rectification.yml"]
            .map(|name| fs::read(taken.out().join(name)).unwrap())
    });
    assert!(cpu == device);
}

#[test]
fn depth_is_in_metres_for_the_picture_as_it_was_taken() {
    let taken = Taken::new();
    taken.run_calibrated("match", &["--map-back", "--max-depth", "inf", "--min-confidence", "0"]).success();
    let found = report(&taken.out());
    assert_eq!((&found["rectified"]["method"], &found["mapped_back"]), (&"calibrated".into(), &true.into()));
    assert_eq!((&found["width"], &found["height"]), (&340.into(), &255.into()));
    let depth = pfm::read(&taken.out().join("depth.pfm")).unwrap();
    assert_eq!(depth.size(), SIZE);
    let pixels = (0..255).flat_map(|y| (0..340).map(move |x| (x, y)));
    let place = |(x, y): (u32, u32)| DVec2::new(x.into(), y.into());
    let finite = pixels.filter(|&(x, y)| depth.get(x, y).is_finite());
    let depths: Vec<_> = finite.map(|pixel| (place(pixel), f64::from(depth.get(pixel.0, pixel.1)))).collect();
    let (right, count) = right_depths(depths.iter().copied());
    assert!(right > 0.85 && count > 50_000, "{right} of {count}");
    // The cloud has the same points, in the left camera's coordinates.
    let points = cloud(&taken.out());
    assert_eq!(points.len(), depths.len());
    for (point, (pixel, depth)) in points.iter().zip(depths) {
        let seen = camera().project(*point).unwrap();
        assert!((seen - pixel).length() < 0.1 && (point.z - depth).abs() < 1e-4, "{point}: {seen}, not {pixel}");
    }
}

#[test]
fn the_cloud_of_a_rectified_pair_is_in_the_coordinates_of_the_left_camera() {
    let taken = Taken::new();
    taken.run_calibrated("match", &[]).success();
    let out = taken.out();
    let points = cloud(&out);
    let (right, count) = right_depths(points.iter().map(|point| (camera().project(*point).unwrap(), point.z)));
    assert!(right > 0.85 && count > 50_000, "{right} of {count}");
    // Depth is that of the rectified camera: focal length times baseline over the disparity.
    let [depth, disparity] = ["depth.pfm", "disparity.pfm"].map(|name| pfm::read(&out.join(name)).unwrap());
    let found = report(&out);
    let [focal, baseline] = ["focal_px", "baseline_m"].map(|name| found["calibration"][name].as_f64().unwrap());
    for (depth, disparity) in depth.data().iter().zip(disparity.data()).filter(|(depth, _)| depth.is_finite()) {
        assert!((f64::from(*depth) * f64::from(*disparity) / (focal * baseline) - 1.0).abs() < 1e-3);
    }
    assert_eq!(load::load(&out.join("rectified-left.png")).unwrap().size(), disparity.size());
}

#[test]
fn rows_that_a_calibration_leaves_off_are_aligned() {
    let taken = Taken::new();
    // The right camera nods by 0.2 degrees more than the calibration says: rows are off by about a pixel.
    let nodded = DMat3::from_rotation_x(0.2_f64.to_radians()) * turns()[1];
    fs::write(&taken.calibration, to_json(&stereo(nodded))).unwrap();
    taken.run_calibrated("match", &["--map-back"]).success();
    let found = report(&taken.out());
    assert_eq!(found["rectified"]["method"], "calibrated");
    assert_ne!(found["rectification"]["rows"]["model"], "as is");
    let cpu = pfm::read(&taken.out().join("disparity.pfm")).unwrap();
    taken.run_calibrated("match", &["--map-back", "--device", "best"]).success();
    let device = pfm::read(&taken.out().join("disparity.pfm")).unwrap();
    // Positions of interest points are floats, and so are the rows that follow from them.
    let differ = cpu.data().iter().zip(device.data()).filter(|(a, b)| a != b && (*a - *b).abs().max(0.0) > 0.5).count();
    assert!(differ * 100 < cpu.data().len(), "{differ} disparities differ");
    let depth = pfm::read(&taken.out().join("depth.pfm")).unwrap();
    let pixels = (0..255).flat_map(|y| (0..340).map(move |x| (x, y)));
    let depths = pixels.map(|(x, y)| (DVec2::new(x.into(), y.into()), f64::from(depth.get(x, y))));
    let (right, count) = right_depths(depths.filter(|(_, depth)| depth.is_finite()));
    assert!(right > 0.8 && count > 50_000, "{right} of {count}");
}

#[test]
fn a_calibration_of_other_pictures_is_told() {
    let taken = Taken::new();
    let rolled = DMat3::from_rotation_z(0.3) * turns()[1];
    fs::write(&taken.calibration, to_json(&stereo(rolled))).unwrap();
    taken.run_calibrated("match", &[]).code(3).stderr(contains("the calibration does not fit the pictures"));
    assert!(!taken.out().exists());
    taken.run_calibrated("rectify", &[]).success().stderr(contains("matches correspond after the rectification"));
    // One camera in front of the other.
    let shift = DVec3::new(0.0, 0.0, -0.1);
    let forward = StereoCalibration::new([camera(); 2], [Some(SIZE); 2], DMat3::IDENTITY, shift).unwrap();
    fs::write(&taken.calibration, to_json(&forward)).unwrap();
    for command in ["match", "rectify"] {
        taken.run_calibrated(command, &[]).code(3).stderr(contains("one camera stands in front of the other"));
    }
}

#[test]
fn rectify_says_what_is_done() {
    let taken = Taken::new();
    taken.run("match", &["--rectify", "calibrated"]).code(2).stderr(contains("name it with --calib"));
    let never = taken.run_calibrated("match", &["--rectify", "never"]);
    never.code(1).stderr(contains("rectify the pair by the calibration first"));
    let both = taken.run_calibrated("match", &["--rectify", "uncalibrated"]);
    both.code(2).stderr(contains("leave the calibration out, or rectify by it"));
    taken.run("match", &["--rectify", "uncalibrated"]).success();
    assert_eq!(report(&taken.out())["rectified"]["method"], "uncalibrated");
    assert!(!taken.out().join("depth.pfm").exists());
}

#[test]
fn files_of_taken_and_rectified_pictures_are_tried_on_the_matches() {
    let taken = Taken::new();
    let found = CalibratedRectification::new(&taken.stereo, [SIZE; 2]).unwrap();
    let projections = found.projections();
    let files = [0, 1].map(|view: usize| {
        let rotation = found.views()[view].rotation().transpose().to_cols_array();
        let text = format!(
            "image_width: 340\nimage_height: 255\nK: [350, 0, 171, 0, 352, 126, 0, 0, 1]\nD: [-0.15, 0.03, 0, 0, 0]\n\
             distortion_model: plumb_bob\nR: {rotation:?}\nP: {:?}\n",
            projections[view]
        );
        let path = taken.folder.path().join(format!("{view}.yaml"));
        fs::write(&path, text).unwrap();
        path
    });
    let files = files.each_ref().map(|path| path.to_str().unwrap());
    let words = "these were rectified by it, since their rows correspond better then";
    taken.run("match", &["--calib", files[0], "--calib", files[1]]).success().stderr(contains(words));
    assert_eq!(report(&taken.out())["rectified"]["method"], "calibrated");
    // The scene itself is rectified.
    let views = ["left.png", "right.png"].map(|name| scene("planes", name));
    let mut program = hsad();
    program.arg("match").args(views).arg("-o").arg(taken.out()).args(["--calib", files[0], "--calib", files[1]]);
    let told = program.args(["--device", "cpu"]).assert().get_output().stderr.clone();
    assert!(!String::from_utf8(told).unwrap().contains(words));
    assert_eq!(report(&taken.out())["rectified"], Value::Null);
}

#[test]
fn the_right_view_can_be_the_reference() {
    let taken = Taken::new();
    taken
        .run_calibrated("match", &["--map-back", "--reference", "right"])
        .success()
        .stdout(contains("by the calibration"));
    let depth = pfm::read(&taken.out().join("depth.pfm")).unwrap();
    // The point of each pixel, in the right camera, is what the left camera sees at that depth.
    let finite = (0..255).flat_map(|y| (0..340).map(move |x| (x, y))).filter(|&(x, y)| depth.get(x, y).is_finite());
    let rotation = taken.stereo.rotation().transpose();
    let in_left = finite.map(|(x, y): (u32, u32)| {
        let ray = camera().unproject(DVec2::new(x.into(), y.into())).unwrap();
        rotation * (ray / ray.z * f64::from(depth.get(x, y)) - taken.stereo.translation())
    });
    let (right, count) = right_depths(in_left.map(|point| (camera().project(point).unwrap(), point.z)));
    assert!(right > 0.8 && count > 50_000, "{right} of {count}");
}
