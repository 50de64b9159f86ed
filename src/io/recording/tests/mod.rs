//! Recordings that are written here.

mod damage;

use std::{
    collections::BTreeMap,
    fs,
    io::{Cursor, Write},
    path::Path,
};

use mcap::{WriteOptions, records::MessageHeader};

use super::{fields::Encoding, *};
use crate::io::load::{Unseen, decode_pair};

/// The bytes of a message, as ROS writes them.
pub(super) struct Bytes {
    bytes: Vec<u8>,
    encoding: Encoding,
}

impl Bytes {
    /// A message whose header has a time in nanoseconds.
    pub fn with_header(encoding: Encoding, stamp: u64) -> Self {
        let mut message = Self { bytes: Vec::new(), encoding };
        if encoding == Encoding::Ros1 {
            message.number(7_u32.to_le_bytes());
        }
        message.number(((stamp / 1_000_000_000) as u32).to_le_bytes());
        message.number(((stamp % 1_000_000_000) as u32).to_le_bytes());
        message.text("camera");
        message
    }

    pub fn number<const N: usize>(&mut self, number: [u8; N]) {
        if self.encoding == Encoding::Cdr {
            self.bytes.resize(self.bytes.len().next_multiple_of(N), 0);
        }
        self.bytes.extend(number);
    }

    pub fn text(&mut self, text: &str) {
        let end: &[u8] = if self.encoding == Encoding::Cdr { &[0] } else { &[] };
        self.list(&[text.as_bytes(), end].concat());
    }

    pub fn list(&mut self, bytes: &[u8]) {
        self.number((bytes.len() as u32).to_le_bytes());
        self.bytes.extend(bytes);
    }

    pub fn floats(&mut self, floats: &[f64]) {
        floats.iter().for_each(|float| self.number(float.to_le_bytes()));
    }

    pub fn whole(self) -> Vec<u8> {
        let head: &[u8] = if self.encoding == Encoding::Cdr { &[0, 1, 0, 0] } else { &[] };
        [head, &self.bytes].concat()
    }
}

pub(super) fn image(
    encoding: Encoding,
    stamp: u64,
    (width, height): (u32, u32),
    name: &str,
    is_big_endian: u8,
    step: u32,
    samples: &[u8],
) -> Vec<u8> {
    let mut message = Bytes::with_header(encoding, stamp);
    message.number(height.to_le_bytes());
    message.number(width.to_le_bytes());
    message.text(name);
    message.number([is_big_endian]);
    message.number(step.to_le_bytes());
    message.list(samples);
    message.whole()
}

/// A grey picture of 4x2 pixels whose first one has the level `level`.
fn grey(stamp: u64, level: u8) -> Vec<u8> {
    image(Encoding::Cdr, stamp, (4, 2), "mono8", 0, 4, &[level, 1, 2, 3, 4, 5, 6, 7])
}

fn compressed(stamp: u64, file: &[u8]) -> Vec<u8> {
    let mut message = Bytes::with_header(Encoding::Cdr, stamp);
    message.text("png");
    message.list(file);
    message.whole()
}

/// The camera at the right if `shift` is below 0.
fn camera_info(focal: f64, shift: f64) -> Vec<u8> {
    part_info((4, 2), focal, shift, [0; 6])
}

/// As [`camera_info`], of a picture of another size; `part` is what follows the matrices: binning, and x, y, height and width of the part.
pub(super) fn part_info((width, height): (u32, u32), focal: f64, shift: f64, part: [u32; 6]) -> Vec<u8> {
    let mut message = Bytes::with_header(Encoding::Cdr, 1);
    message.number(height.to_le_bytes());
    message.number(width.to_le_bytes());
    message.text("plumb_bob");
    message.number(5_u32.to_le_bytes());
    message.floats(&[0.0; 5]);
    message.floats(&[focal, 0.0, 2.0, 0.0, focal, 1.0, 0.0, 0.0, 1.0]);
    message.floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    message.floats(&[focal, 0.0, 2.0, shift, 0.0, focal, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    part.iter().for_each(|number| message.number(number.to_le_bytes()));
    message.number([1]);
    message.whole()
}

const IMAGE: &str = "sensor_msgs/msg/Image";
const COMPRESSED: &str = "sensor_msgs/msg/CompressedImage";
const INFO: &str = "sensor_msgs/msg/CameraInfo";

/// A message of a recording: topic, type, bytes.
type Sent<'a> = (&'a str, &'a str, Vec<u8>);

/// A recording of messages that follow one another by a nanosecond, from time 100 on.
fn recorded(options: WriteOptions, sent: &[Sent<'_>]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = options.profile("ros2").create(&mut bytes).unwrap();
    let mut channels = BTreeMap::new();
    for (number, (topic, message_type, data)) in (0..).zip(sent) {
        let encoding = if message_type.contains("/msg/") { "cdr" } else { "ros1" };
        let channel = *channels.entry(topic).or_insert_with(|| {
            let schema = writer.add_schema(message_type, "ros2msg", b"").unwrap();
            writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap()
        });
        let header =
            MessageHeader { channel_id: channel, sequence: number, log_time: 100 + u64::from(number), publish_time: 0 };
        writer.write_to_known_channel(&header, data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

fn plain() -> WriteOptions {
    WriteOptions::new().compression(None)
}

/// The time of a pair, and the first pixels of its views.
type Found = (u64, [u8; 2]);

/// What comes of a recording: its pairs, what is left out, and the error that ends it.
fn read(file: &Path) -> Result<(Vec<Found>, LeftOut, Option<String>)> {
    let recording = Recording::open(file)?;
    let mut pairs = recording.pairs(recording.both_views(None)?);
    let (mut found, mut error) = (Vec::new(), None);
    for pair in pairs.by_ref() {
        match pair {
            Ok((name, [left, right])) => {
                let files = [left.to_file()?, right.to_file()?];
                let paths = [&left, &right].map(|shot| shot.path.as_path());
                let loaded = decode_pair((&files[0], paths[0]), (&files[1], paths[1]), &Unseen::default())?;
                found.push((name.parse().unwrap(), [loaded.left, loaded.right].map(|picture| picture.get(0, 0)[0])));
            }
            Err(reason) => error = Some(reason.to_string()),
        }
    }
    let left_out = pairs.left_out().lock().unwrap().clone();
    Ok((found, left_out, error))
}

fn written(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("ride.mcap");
    fs::write(&file, bytes).unwrap();
    (folder, file)
}

/// Three pairs and a left frame between them, among messages of other kinds.
fn ride() -> Vec<Sent<'static>> {
    vec![
        ("/tf", "tf2_msgs/msg/TFMessage", vec![0, 1, 0, 0]),
        ("/left/image", IMAGE, grey(10, 50)),
        ("/right/image", IMAGE, grey(10, 60)),
        ("/left/image", IMAGE, grey(20, 51)),
        ("/left/image", IMAGE, grey(30, 52)),
        ("/right/image", IMAGE, grey(30, 62)),
        ("/right/image", IMAGE, grey(41, 63)),
        ("/left/image", IMAGE, grey(40, 53)),
    ]
}

const PAIRS: [Found; 3] = [(10, [50, 60]), (30, [52, 62]), (40, [53, 63])];

#[test]
fn pairs_come_out_of_chunks_of_any_size_and_of_none() {
    for options in
        [plain(), plain().chunk_size(Some(1)), plain().use_chunks(false), plain().emit_summary_records(false)]
    {
        let (_folder, file) = written(&recorded(options, &ride()));
        let (found, left_out, error) = read(&file).unwrap();
        assert_eq!((found, error), (PAIRS.to_vec(), None));
        assert_eq!(left_out, LeftOut { alone: [1, 0], ..LeftOut::default() });
    }
}

/// The chunks of a recording, compressed anew.
fn with_chunks(bytes: &[u8], name: &str, compress: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    let mut out = mcap::MAGIC.to_vec();
    let mut rest = &bytes[8..];
    while let Some(([code, length @ ..], after)) = rest.split_first_chunk::<9>() {
        let (body, after) = after.split_at(u64::from_le_bytes(*length) as usize);
        rest = after;
        let body = match mcap::parse_record(*code, body) {
            Ok(mcap::records::Record::Chunk { header, data }) => {
                let data = compress(&data);
                let name = [&(name.len() as u32).to_le_bytes(), name.as_bytes()].concat();
                let sizes = [header.message_start_time, header.message_end_time, header.uncompressed_size]
                    .map(u64::to_le_bytes);
                let length = (data.len() as u64).to_le_bytes();
                [&sizes.concat()[..], &header.uncompressed_crc.to_le_bytes(), &name, &length, &data].concat()
            }
            _ => body.to_vec(),
        };
        out.push(*code);
        out.extend((body.len() as u64).to_le_bytes());
        out.extend(body);
        if *code == mcap::records::op::DATA_END {
            break;
        }
    }
    out
}

#[test]
fn compressed_chunks_are_read_and_others_named() {
    let whole = recorded(plain(), &ride());
    let lz4 = |data: &[u8]| {
        let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
        encoder.write_all(data).unwrap();
        encoder.finish().unwrap()
    };
    let zstd = |data: &[u8]| ruzstd::encoding::compress_to_vec(data, ruzstd::encoding::CompressionLevel::Fastest);
    for bytes in
        [with_chunks(&whole, "lz4", lz4), with_chunks(&whole, "zstd", zstd), with_chunks(&whole, "", <[u8]>::to_vec)]
    {
        let (_folder, file) = written(&bytes);
        let (found, _, error) = read(&file).unwrap();
        assert_eq!((found, error), (PAIRS.to_vec(), None));
    }
    let error = |bytes: Vec<u8>| {
        let (_folder, file) = written(&bytes);
        read(&file).map(|(.., error)| error.unwrap()).unwrap_or_else(|error| error.to_string())
    };
    let told = error(with_chunks(&whole, "brotli", <[u8]>::to_vec));
    assert!(told.contains("compressed by \"brotli\"") && told.contains("mcap compress"), "{told}");
    let told = error(with_chunks(&whole, "zstd", |_| vec![1; 20]));
    assert!(told.contains("a chunk is damaged"), "{told}");
    let told = error(with_chunks(&whole, "lz4", |data| lz4(&data[1..])));
    assert!(told.contains("a chunk is damaged (of"), "{told}");
    let told =
        error(with_chunks(&whole, "", |data| data.iter().map(|&byte| if byte == 52 { 53 } else { byte }).collect()));
    assert!(told.contains("its checksum is another one"), "{told}");
}

#[test]
fn compressed_pictures_and_messages_of_ros_1_are_read() {
    let png = |level: u8| {
        let mut png = Vec::new();
        crate::io::png::write_grey8(&mut png, &crate::image::Plane::filled((4, 2), level)).unwrap();
        png
    };
    let sent = [
        ("/cam0/image_raw/compressed", COMPRESSED, compressed(5, &png(80))),
        ("/cam1/image_raw/compressed", COMPRESSED, compressed(5, &png(81))),
    ];
    let (_folder, file) = written(&recorded(plain(), &sent));
    assert_eq!(read(&file).unwrap().0, [(5, [80, 81])]);
    let old = |level| image(Encoding::Ros1, 5, (1, 1), "bgr8", 0, 3, &[9, 9, level]);
    let sent = [("/cam1/image_raw", "sensor_msgs/Image", old(91)), ("/cam0/image_raw", "sensor_msgs/Image", old(90))];
    let (_folder, file) = written(&recorded(plain(), &sent));
    assert_eq!(read(&file).unwrap().0, [(5, [90, 91])]);
}

#[test]
fn files_of_one_recording_follow_one_another() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("metadata.yaml"), "rosbag2_bagfile_information:\n  version: 5\n").unwrap();
    for (number, part) in ride().chunks(1).enumerate() {
        fs::write(folder.path().join(format!("ride_{}.mcap", number + 5)), recorded(plain(), part)).unwrap();
    }
    assert!(Recording::is_one(folder.path()));
    let (found, left_out, error) = read(folder.path()).unwrap();
    assert_eq!((found, left_out.alone, error), (PAIRS.to_vec(), [1, 0], None));
    let recording = Recording::open(folder.path()).unwrap();
    let counts: Vec<_> = recording.topics().iter().map(|topic| (topic.name.as_str(), topic.messages)).collect();
    assert_eq!(counts, [("/left/image", Some(4)), ("/right/image", Some(3)), ("/tf", Some(1))]);
}

#[test]
fn recordings_in_one_folder_have_pairs_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let both =
        |stamp, level| [("/left/image", IMAGE, grey(stamp, level)), ("/right/image", IMAGE, grey(stamp, level + 1))];
    // The first one breaks off in a pair, and the second one goes on in another file.
    for (name, sent) in [
        ("a_0", both(10, 50).to_vec()),
        ("a_1", both(20, 60)[..1].to_vec()),
        ("b_0", [both(10, 70), both(15, 80)].concat()),
        ("b_1", both(20, 90).to_vec()),
        ("c", both(30, 100).to_vec()),
    ] {
        fs::write(folder.path().join(format!("{name}.mcap")), recorded(plain(), &sent)).unwrap();
    }
    let recording = Recording::open(folder.path()).unwrap();
    let mut pairs = recording.pairs(recording.both_views(None).unwrap());
    let names: Vec<String> = pairs.by_ref().map(|pair| pair.unwrap().0).collect();
    assert_eq!(names, ["10", "b/10", "15", "20", "30"]);
    assert_eq!(pairs.left_out().lock().unwrap().alone, [1, 0]);
}

#[test]
fn calibrations_are_those_of_the_part_of_the_sensor_that_is_sent() {
    let info = |part| CameraInfo::of(&part_info((40, 20), 100.0, -12.0, part), Encoding::Cdr).unwrap();
    let whole = info([0; 6]);
    assert_eq!(whole, info([1, 1, 0, 0, 20, 40]));
    assert_eq!((whole.size, whole.camera[2], whole.projection[3]), (Size::new(40, 20), 2.0, -12.0));
    let part = info([0, 0, 1, 3, 10, 30]);
    assert_eq!((part.size, part.camera[0], part.camera[2], part.camera[5]), (Size::new(30, 10), 100.0, 1.0, -2.0));
    assert_eq!((part.projection[2], part.projection[3], part.projection[6]), (1.0, -12.0, -2.0));
    // The first pixel is the first two of the part, whose centre is 0.5 there.
    let binned = info([2, 5, 1, 0, 20, 30]);
    assert_eq!((binned.size, binned.camera[0], binned.camera[4]), (Size::new(15, 4), 50.0, 20.0));
    assert_eq!((binned.camera[2], binned.camera[5]), (0.25, -0.2));
    assert_eq!(binned.projection, [50.0, 0.0, 0.25, -6.0, 0.0, 20.0, -0.2, 0.0, 0.0, 0.0, 1.0, 0.0]);
    assert_eq!(info([0, 0, 4, 0, 0, 0]).size, (36, 20));
}

#[test]
fn the_calibration_lies_beside_the_pictures() {
    let calibration = |infos: [Vec<u8>; 2]| {
        let [left, right] = infos;
        let mut sent = vec![("/left/camera_info", INFO, left), ("/right/camera_info", INFO, right)];
        sent.extend(ride());
        let (_folder, file) = written(&recorded(plain(), &sent));
        let recording = Recording::open(&file).unwrap();
        recording.calibration(recording.both_views(None).unwrap())
    };
    let found = calibration([camera_info(100.0, 0.0), camera_info(100.0, -12.0)]).unwrap().unwrap();
    let rectified = found.loaded.for_rectified((4, 2).into()).unwrap();
    assert_eq!((rectified.focal, rectified.baseline, found.is_rectified), (100.0, 0.12, false));
    assert!(found.path.ends_with("ride.mcap#/right/camera_info"));
    assert!(found.check_sizes([(4, 2).into(); 2]).is_ok());
    let error = found.check_sizes([(8, 4).into(); 2]).unwrap_err().to_string();
    assert!(error.contains("camera_info: the calibration is for pictures of 4x2"), "{error}");
    assert!(calibration([camera_info(0.0, 0.0), camera_info(0.0, 0.0)]).unwrap().is_none(), "not calibrated");
    let error = calibration([camera_info(100.0, 0.0), camera_info(100.0, 0.0)]).unwrap_err().to_string();
    assert!(error.contains("minus focal length times baseline"), "{error}");
    let one_alone = "left/camera_info: the calibration is of one camera alone: /right/camera_info has none";
    let error = calibration([camera_info(100.0, 0.0), camera_info(0.0, 0.0)]).unwrap_err().to_string();
    assert!(error.contains(one_alone), "{error}");
    let error = calibration([vec![0, 1, 0, 0, 5], camera_info(100.0, -12.0)]).unwrap_err().to_string();
    assert!(error.contains("ride.mcap#/left/camera_info: "), "damaged: {error}");

    let sent = [&[("/left/camera_info", INFO, camera_info(100.0, 0.0))], &ride()[..]].concat();
    let (_folder, file) = written(&recorded(plain(), &sent));
    let recording = Recording::open(&file).unwrap();
    let error = recording.calibration(recording.both_views(None).unwrap()).unwrap_err().to_string();
    assert!(error.contains(one_alone), "{error}");
}
