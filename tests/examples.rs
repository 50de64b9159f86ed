//! The examples that embed hsad, run as their users run them.
#![cfg(feature = "cli")]

use std::{path::Path, process::Command};

use hsad::{
    Backend, Pair,
    config::Preset,
    disparity::DisparityRange,
    gpu::{DeviceChoice, Gpu, block_on},
    image::Size,
    io::{color::turbo, load},
};

/// The standard output of an example.
fn run(name: &str, arguments: &[&str]) -> String {
    let cargo = std::env::var_os("CARGO").expect("cargo runs the tests");
    let mut command = Command::new(cargo);
    command.args(["run", "--quiet", "--example", name, "--"]).args(arguments);
    let output = command.current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("cargo runs");
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// The frame is the left picture as it was, and beside it the colours of the disparities that the library finds.
#[test]
fn embed_draws_the_picture_and_its_disparities() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.png");
    run("embed", &[path.to_str().unwrap()]);
    let frame = load::load(&path).unwrap();

    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/curved");
    let [left, right] = ["left.png", "right.png"].map(|name| load::load(&scene.join(name)).unwrap());
    let gpu = Gpu::open(&DeviceChoice::Best).expect("this test needs a device; lavapipe is one");
    let config = Preset::Balanced.dense_config(DisparityRange::new(0, 64).unwrap());
    let backend = Backend::Gpu(gpu);
    let pair = block_on(Pair::new(&backend, &left, &right)).unwrap();
    let map = block_on(pair.dense(&config)).unwrap().disparity;
    let Size { width, height } = left.size();
    assert_eq!(frame.size(), (2 * width, height));
    let mut colors = 0;
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        // The first and the last colour stand for 12 and 60 px; the renderer's target rounds.
        let share = ((map.get(x, y) as f32 / 256.0 - 12.0) / 48.0).clamp(0.0, 1.0);
        for (at, expected) in [(x, left.rgb(x, y)), (width + x, turbo(0.05 + 0.95 * share))] {
            let drawn = frame.rgb(at, y);
            let near = drawn.iter().zip(expected).all(|(&drawn, expected)| drawn.abs_diff(expected) <= 2);
            assert!(near, "({at}, {y}): {drawn:?}, not {expected:?}");
        }
        colors += u32::from(frame.rgb(width + x, y) != frame.rgb(width, 0));
    }
    assert!(2 * colors > width * height, "only {colors} pixels differ from the first");
}

/// The first camera sees the picture as it was where there are points; the turned ones see the points elsewhere.
#[test]
fn cloud_draws_the_points_from_several_sides() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.png");
    run("cloud", &[path.to_str().unwrap()]);
    let frame = load::load(&path).unwrap();
    let left = load::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("data/curved/left.png")).unwrap();
    let Size { width, height } = left.size();
    assert_eq!(frame.size(), (3 * width, height));
    let (mut seen, mut same, mut moved) = (0, 0, [0, 0]);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let near = |at: u32| {
            let pair = frame.rgb(at, y).into_iter().zip(left.rgb(x, y));
            pair.fold(0, |most, (drawn, taken)| most.max(drawn.abs_diff(taken))) <= 2
        };
        if frame.rgb(x, y) != [0; 3] {
            seen += 1;
            same += u32::from(near(x));
            for (number, moved) in moved.iter_mut().enumerate() {
                *moved += u32::from(!near((number as u32 + 1) * width + x));
            }
        }
    }
    assert!(10 * seen > 7 * width * height, "{seen} pixels are drawn");
    assert!(1000 * same > 995 * seen, "{same} of {seen} are the picture's");
    assert!(moved.iter().all(|&moved| 2 * moved > seen), "{moved:?} of {seen}");
}

/// Range and brightness from the features of some frames serve later frames. No frame is lost while the range changes, nor with the
/// device.
#[test]
fn stream_follows_the_cameras() {
    let text = run("stream", &["40", "22"]);
    let frames: Vec<&str> = text.lines().filter(|line| line.starts_with("frame ")).collect();
    assert_eq!(frames.len(), 40, "{text}");
    for (index, line) in frames.into_iter().enumerate() {
        assert!(line.starts_with(&format!("frame {index:3} ")), "{text}");
        let coverage: f64 = line.split_whitespace().nth(3).expect("a share").parse().expect("a number");
        // The right camera is darker from frame 20 on, which soft ranks do not see.
        assert!(coverage > 60.0 || line.contains(" px of 0 to 31"), "{text}");
    }
    assert!(text.contains(" px instead of 0 to 31\n"), "{text}");
    assert_eq!(text.matches("the device was lost").count(), 1, "{text}");
    let after = |name: &str| -> f64 {
        let words = text.rsplit_once(name).expect("the figure").1;
        words.split_whitespace().next().expect("a number").parse().expect("a number")
    };
    assert!(after("mean coverage ") > 60.0, "{text}");
    let speeds: Vec<f64> = text.lines().last().unwrap().split(' ').filter_map(|word| word.parse().ok()).collect();
    assert!(speeds.len() == 2 && speeds.iter().all(|&speed| speed > 0.0), "{text}");
}

/// The tables of one scene: a right view that lies lower is found so, and sure pixels are right.
#[test]
fn trust_prints_its_tables() {
    let text = run("trust", &["confidence", "rows", "data/planes"]);
    assert!(text.contains("| alignable, 3.0"), "{text}");
    assert!(!text.contains("## Ranges"), "only what was asked for: {text}");
    assert!(text.contains("| blur along rows, 17 px | 1 |"), "{text}");
    let table = text.split("## Confidence: preset `balanced`").nth(1).expect("the table");
    let line = table.lines().find(|line| line.starts_with("| planes |")).expect("the scene");
    let shares: Vec<f64> = line.split('|').filter_map(|cell| cell.trim().parse().ok()).collect();
    assert!(shares.len() == 4 && shares[2] < 1.0 && shares[3] > 50.0, "{line}");
}
