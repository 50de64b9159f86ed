//! `hsad match --calib`: formats of calibrations.

use std::{fs, path::Path};

use predicates::str::contains;

use crate::common::{fails, folder, match_on_cpu, views};

#[test]
fn a_calibration_in_two_files_gives_the_depth_of_one_file() {
    let (temporary, [left, right]) = (folder(), views("planes"));
    let file = |name: &str, text: &str| {
        let path = temporary.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let camera = |cx: f64, shift: f64| {
        format!(
            "image_width: 340\nimage_height: 255\nK: [290, 0, 160, 0, 290, 120, 0, 0, 1]\nD: [-0.1, 0, 0, 0, 0]\n\
             distortion_model: plumb_bob\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n\
             P: [300, 0, {cx}, {shift}, 0, 300, 127, 0, 0, 0, 1, 0]\n"
        )
    };
    let one = file("calib.txt", "cam0=[300 0 169.5; 0 300 127; 0 0 1]\ndoffs=5\nbaseline=100\n");
    let two = [file("left.yaml", &camera(169.5, 0.0)), file("right.yaml", &camera(174.5, -30.0))];
    let depth = |calibration: &[&Path]| {
        let out = temporary.path().join("out");
        let mut command = match_on_cpu(&left, &right, &out);
        command.args(["--disparities", "72", "--preset", "fast"]);
        command.args(calibration.iter().flat_map(|path| [Path::new("--calib"), path]));
        command.assert().success();
        fs::read(out.join("depth.pfm")).unwrap()
    };
    assert!(depth(&[&one]) == depth(&[&two[0], &two[1]]));
    // Numbers of a larger camera: its principal point is outside the pictures.
    // Numbers of a camera that is larger by less: a warning.
    let numbers = file("K.txt", "424 0 239.5 0 424 179.5 0 0 1\n0.063\n");
    let mut command = match_on_cpu(&left, &right, &temporary.path().join("larger"));
    command.args(["--disparities", "72", "--preset", "fast"]).arg("--calib").arg(numbers);
    command.assert().success().stderr(contains("(239.5, 179.5) is the centre of pictures of about 480x360 pixels"));
    let numbers = file("K.txt", "754.7 0 489.4 0 754.7 265.2 0 0 1\n0.063\n");
    let mut command = match_on_cpu(&left, &right, &temporary.path().join("numbers"));
    command.args(["--disparities", "72", "--preset", "fast"]).arg("--calib").arg(numbers);
    fails(
        command,
        1,
        "(489.4, 265.2), but it lies outside the pictures of 340x255 pixels: the calibration is for other ones",
    );
}
