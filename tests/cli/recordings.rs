//! `hsad batch` of recordings of robots.

use std::{
    collections::BTreeMap,
    fs,
    io::Cursor,
    path::{Path, PathBuf},
};

use assert_cmd::assert::Assert;
use hsad::image::Plane;
use mcap::{WriteOptions, records::MessageHeader};
use predicates::{prelude::PredicateBooleanExt, str::contains};

use crate::{
    batch::{of, records, statuses},
    common::{folder, grey_png, hsad, views},
};

/// Little-endian CDR.
#[derive(Default)]
struct Message(Vec<u8>);

impl Message {
    fn of_time(stamp: u32) -> Self {
        let mut message = Self::default();
        message.numbers(&[stamp, 500]);
        message.bytes(b"camera\0");
        message
    }

    fn numbers(&mut self, numbers: &[u32]) {
        self.0.resize(self.0.len().next_multiple_of(4), 0);
        numbers.iter().for_each(|number| self.0.extend(number.to_le_bytes()));
    }

    fn floats(&mut self, floats: &[f64]) {
        self.0.resize(self.0.len().next_multiple_of(8), 0);
        floats.iter().for_each(|float| self.0.extend(float.to_le_bytes()));
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.numbers(&[bytes.len() as u32]);
        self.0.extend(bytes);
    }

    fn whole(self) -> Vec<u8> {
        [&[0, 1, 0, 0], &self.0[..]].concat()
    }
}

fn image(stamp: u32, picture: &Plane<u8>) -> Vec<u8> {
    let mut message = Message::of_time(stamp);
    message.numbers(&[picture.height(), picture.width()]);
    message.bytes(b"mono8\0");
    message.0.push(0);
    message.numbers(&[picture.width()]);
    message.bytes(picture.data());
    message.whole()
}

fn camera_info(picture: &Plane<u8>, shift: f64) -> Vec<u8> {
    let mut message = Message::of_time(0);
    message.numbers(&[picture.height(), picture.width()]);
    message.bytes(b"plumb_bob\0");
    message.numbers(&[0]);
    let [x, y] = [picture.width(), picture.height()].map(|side| f64::from(side - 1) / 2.0);
    message.floats(&[300.0, 0.0, x, 0.0, 300.0, y, 0.0, 0.0, 1.0]);
    message.floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    message.floats(&[300.0, 0.0, x, shift, 0.0, 300.0, y, 0.0, 0.0, 0.0, 1.0, 0.0]);
    message.numbers(&[0; 6]);
    message.0.push(0);
    message.whole()
}

/// An MCAP file of messages: topic, type, bytes; a chunk each.
fn recording(messages: &[(&str, &str, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = WriteOptions::new().compression(None).chunk_size(Some(1)).create(&mut bytes).unwrap();
    let mut channels = BTreeMap::new();
    for (number, (topic, message_type, data)) in (0..).zip(messages) {
        let channel_id = *channels.entry(topic).or_insert_with(|| {
            let schema = writer.add_schema(&format!("sensor_msgs/msg/{message_type}"), "ros2msg", b"").unwrap();
            writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap()
        });
        let header =
            MessageHeader { channel_id, sequence: number, log_time: number.into(), publish_time: number.into() };
        writer.write_to_known_channel(&header, data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

/// Parts of a shipped scene, each some rows below the one before: what a camera sees that goes by.
fn frames(count: u32) -> Vec<[Plane<u8>; 2]> {
    let views = views("planes").map(|view| hsad::io::load::load(&view).expect("a shipped view").luma());
    let part =
        |view: &Plane<u8>, row: u32| Plane::from_fn((view.width(), view.height() - 40), |x, y| view.get(x, y + row));
    (0..count).map(|number| views.each_ref().map(|view| part(view, 6 * number))).collect()
}

/// Frames as messages of a left and a right camera, and a left frame that has no partner.
fn ride(frames: &[[Plane<u8>; 2]]) -> Vec<(&'static str, &'static str, Vec<u8>)> {
    let mut messages = Vec::new();
    for (number, [left, right]) in (1..).zip(frames) {
        messages.push(("/stereo/right/image_raw", "Image", image(number, right)));
        messages.push(("/stereo/left/image_raw", "Image", image(number, left)));
    }
    messages.push(("/stereo/left/image_raw", "Image", image(99, &frames[0][0])));
    messages
}

fn batch(source: &Path, more: &[&str], out: &Path) -> Assert {
    hsad().arg("batch").arg(source).args(["--disparities", "64"]).args(more).arg("-o").arg(out).assert()
}

fn map(out: &Path, name: &str) -> Vec<u8> {
    fs::read(out.join(name).join("disparity.pfm")).unwrap()
}

#[test]
fn frames_of_a_recording_are_pairs() {
    let temporary = folder();
    let root = temporary.path();
    let frames = frames(2);
    let pictures = ["left.png", "right.png"].map(|name| root.join(name));
    pictures.iter().zip(&frames[1]).for_each(|(path, view)| grey_png(path, view));
    let single = root.join("single");
    hsad().arg("match").args(&pictures).args(["-q", "--disparities", "64", "-o"]).arg(&single).assert().success();
    // A calibration of larger pictures.
    let larger = Plane::from_fn((680, 430), |_, _| 0);
    let infos = [("/stereo/left/camera_info", 0.0), ("/stereo/right/camera_info", -30.0)]
        .map(|(topic, shift)| (topic, "CameraInfo", camera_info(&larger, shift)));
    let bytes = recording(&[&infos[..], &ride(&frames)].concat());
    let (file, out) = (root.join("ride.mcap"), root.join("out"));
    let names = ["1000000500", "2000000500"];

    // Cut off in the second pair's right frame, and whole afterwards.
    let second = bytes.windows(8).position(|part| part == [0, 1, 0, 0, 2, 0, 0, 0]).unwrap();
    fs::write(&file, &bytes[..second + 100]).unwrap();
    batch(&file, &[], &out).code(1).stderr(
        contains("ride.mcap: the recording is cut off: mcap recover")
            .and(contains("calibration of the recording is not used"))
            .and(contains("for pictures of 680x430")),
    );
    assert_eq!(statuses(&out.join("report.jsonl")), of(&[(names[0], "done")]));
    let written = || fs::metadata(out.join(names[0]).join("report.json")).unwrap().modified().unwrap();
    let before = written();
    fs::write(&file, &bytes).unwrap();
    batch(&file, &["--resume"], &out)
        .success()
        .stderr(contains("frames without a partner: 1 of /stereo/left/image_raw, 0 of /stereo/right/image_raw"));
    assert_eq!(written(), before, "nothing is redone");
    assert_eq!(map(&out, names[1]), fs::read(single.join("disparity.pfm")).unwrap());
    let report = &records(&out.join("report.jsonl"))[1];
    assert!(report["left"].as_str().unwrap().ends_with("ride.mcap#/stereo/left/image_raw@2000000500"), "{report}");

    let shares = root.join("shares");
    for share in ["0/2", "1/2"] {
        batch(&file, &["-q", "--shard", share], &shares).success();
    }
    names.iter().for_each(|name| assert!(map(&shares, name) == map(&out, name)));
}

#[test]
fn frames_of_a_recording_follow_one_another_and_have_its_calibration() {
    let temporary = folder();
    let root = temporary.path();
    let frames = frames(5);
    let mut messages = ride(&frames);
    messages.insert(0, ("/stereo/left/camera_info", "CameraInfo", camera_info(&frames[0][0], 0.0)));
    messages.insert(1, ("/stereo/right/camera_info", "CameraInfo", camera_info(&frames[0][1], -30.0)));
    let file = root.join("ride.mcap");
    fs::write(&file, recording(&messages)).unwrap();
    let options = ["--temporal", "3", "--rectify", "never", "-q"];
    let out = root.join("out");
    batch(&file, &options, &out).success();
    let all = records(&out.join("report.jsonl"));
    let follows: Vec<bool> = all.iter().map(|record| record["follows"] == true).collect();
    assert_eq!(follows, [false, true, true, false, true]);
    assert!(out.join("1000000500/depth.pfm").exists(), "depth in metres by the calibration");
    let without = [&options[..], &["--resume", "--no-camera-info"]].concat();
    batch(&file, &without, &out).code(1).stderr(contains("with other options"));

    // The same frames as files.
    for (number, both) in (1..).zip(&frames) {
        for (side, view) in ["left", "right"].into_iter().zip(both) {
            let picture = root.join(side).join(format!("{number}000000500.png"));
            fs::create_dir_all(picture.parent().unwrap()).unwrap();
            grey_png(&picture, view);
        }
    }
    // Beside which the recording itself lies.
    let again = root.join("again");
    batch(root, &options, &again).success();
    for number in 1..=5 {
        let name = format!("{number}000000500");
        assert!(map(&out, &name) == map(&again, &name), "{name}");
    }
}

#[test]
fn what_is_no_pair_of_topics_is_told() {
    let temporary = folder();
    let root = temporary.path();
    let [left, right] = &frames(1)[0];
    let messages =
        [("/front", "Image", image(1, left)), ("/rear", "Image", image(1, right)), ("/scan", "LaserScan", vec![])];
    let (file, out) = (root.join("ride.mcap"), root.join("out"));
    fs::write(&file, recording(&messages)).unwrap();
    let fails = |source: &PathBuf, more: &[&str], told: &str| {
        batch(source, more, &out).code(1).stdout("").stderr(contains(told));
        assert!(!out.exists(), "{more:?}");
    };
    fails(
        &file,
        &[],
        "topics of pictures are /front (1 messages), /rear (1 messages): name two with --topics LEFT RIGHT",
    );
    fails(&file, &["--topics", "/front", "/scan"], "the topic /scan has sensor_msgs/msg/LaserScan");
    fails(&file, &["--topics", "/front", "/left"], "there is no topic /left");
    fails(&file, &["--topics", "/front", "/rear", "--side-by-side", "left-right"], "a recording has a topic per view");
    fs::create_dir(root.join("pairs")).unwrap();
    fails(&root.join("pairs"), &["--topics", "/front", "/rear"], "--topics names topics of a recording");
    let bag = root.join("ride.bag");
    fs::write(&bag, "#ROSBAG V2.0\n").unwrap();
    fails(&bag, &[], "mcap convert IN.bag OUT.mcap");
    let rectified = root.join("rectified.mcap");
    let messages = [
        ("/left/camera_info", "CameraInfo", camera_info(left, 0.0)),
        ("/right/camera_info", "CameraInfo", camera_info(right, -30.0)),
        ("/left/image_rect", "Image", image(1, left)),
        ("/right/image_rect", "Image", image(1, right)),
    ];
    fs::write(&rectified, recording(&messages)).unwrap();
    batch(&rectified, &["--rectify", "calibrated"], &out).code(2).stderr(contains("of the pair as it was taken"));
    assert!(!out.exists());
    batch(&file, &["-q", "--topics", "/front", "/rear"], &out).success();
}
