//! What the tests of all kernels share: a device, buffers on their way there and back, pictures,
//! comparisons.

use std::{f32::consts::TAU, fmt::Debug, path::Path, sync::OnceLock};

use hsad::{
    features::{
        DESCRIPTOR_LENGTH,
        integral_columns::IntegralColumns,
        integral_rows::IntegralRows,
        keypoints::{Keypoint, KeypointList},
    },
    gpu::{DeviceChoice, Gpu},
    image::Luma,
    io::Picture,
    reference::{
        hessian::Octave,
        integral::IntegralImage,
        nonmax::{candidates, integer_threshold, locate},
    },
    wgpu::{self, util::DeviceExt},
};

/// The values of one descriptor.
pub type Values = [f32; DESCRIPTOR_LENGTH];

/// Sizes that divide by nothing, that are smaller than any filter, that are all edge.
pub const SIZES: [(u32, u32); 8] = [(1, 1), (2, 2), (3, 1), (5, 700), (64, 48), (97, 33), (130, 131), (311, 239)];

/// The device of all tests.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::open(&DeviceChoice::Best).expect("these tests need a device; lavapipe is one"))
}

/// A storage buffer that holds `values`.
pub fn upload<T: bytemuck::NoUninit>(values: &[T]) -> wgpu::Buffer {
    gpu().device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("test input"),
        contents: bytemuck::cast_slice(values),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
    })
}

/// Overwrites the first values of `buffer`.
pub fn write<T: bytemuck::NoUninit>(buffer: &wgpu::Buffer, values: &[T]) {
    gpu().queue.write_buffer(buffer, 0, bytemuck::cast_slice(values));
}

/// Fills `buffer` with ones, so that 'wrote 0' differs from 'never wrote'.
pub fn poison(buffer: &wgpu::Buffer) {
    write(buffer, &vec![0xFF_u8; buffer.size() as usize]);
}

/// Submits what `record` records.
pub fn run(record: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    record(&mut encoder);
    gpu().queue.submit([encoder.finish()]);
}

/// All of `buffer`, after everything that was submitted.
pub fn download<T: bytemuck::AnyBitPattern>(buffer: &wgpu::Buffer) -> Vec<T> {
    let staging = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test output"),
        size: buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    run(|encoder| encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, None));
    staging.map_async(wgpu::MapMode::Read, .., |mapped| mapped.expect("mapping"));
    gpu().device.poll(wgpu::PollType::wait_indefinitely()).expect("waiting for the device");
    let bytes = staging.get_mapped_range(..).expect("mapped");
    bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect()
}

/// A picture of smooth noise, different for each `seed`.
pub fn picture(width: u32, height: u32, seed: u32) -> Luma {
    // A value for every corner of a grid of 8 px, blended between the corners, and some grain.
    let corner = |x: u32, y: u32| {
        let mut hash = x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
        hash = (hash ^ hash >> 15).wrapping_mul(0x2C1B_3C6D);
        hash = (hash ^ hash >> 12).wrapping_mul(0x297A_2D39);
        (hash ^ hash >> 15) >> 24
    };
    Luma::from_fn(width, height, |x, y| {
        let (i, j, fx, fy) = (x / 8, y / 8, x % 8, y % 8);
        let top = (8 - fx) * corner(i, j) + fx * corner(i + 1, j);
        let bottom = (8 - fx) * corner(i, j + 1) + fx * corner(i + 1, j + 1);
        let smooth = ((8 - fy) * top + fy * bottom) / 64;
        (smooth * 15 / 16 + corner(x + 7919, y) / 16) as u8
    })
}

/// The picture, packed, on the device.
pub fn upload_luma(picture: &Luma) -> wgpu::Buffer {
    upload(&hsad::luma::pack(picture))
}

/// The integral image of `picture`, on the device.
pub fn integral_image(picture: &Luma) -> wgpu::Buffer {
    let (width, height) = picture.size();
    let device = &gpu().device;
    let rows = IntegralRows::new(device, &upload_luma(picture), width, height).unwrap();
    let columns = IntegralColumns::new(device, rows.sums(), width, height);
    run(|encoder| {
        rows.record(encoder);
        columns.record(encoder);
    });
    rows.sums().clone()
}

/// A list that holds `keypoints`, on the device.
pub fn keypoint_list(keypoints: &[Keypoint]) -> KeypointList {
    let count = keypoints.len() as u32;
    let list = KeypointList::new(&gpu().device, count).unwrap();
    write(list.found(), &[count]);
    write(list.keypoints(), keypoints);
    list
}

/// A keypoint of which only the place is known.
pub fn keypoint(x: f32, y: f32, scale: f32) -> Keypoint {
    Keypoint { x, y, scale, orientation: 0.0, response: 0, octave: 0, index: 0 }
}

/// The keypoints that the twins find in a picture, in the order of the final list.
pub fn keypoints_of(integral: &IntegralImage, octaves: u32, step: u32, threshold: f32) -> Vec<Keypoint> {
    let octave_keypoints = |index| {
        let octave = Octave::new(integral, index, step);
        let found = candidates(&octave, integral.width(), integral.height(), integer_threshold(threshold));
        let keypoint = |at| {
            let place = locate(&octave, at);
            let plane = &octave.layers[at.layer as usize];
            Keypoint {
                response: plane.get(at.i, at.j).0,
                octave: index,
                index: ((at.layer - 1) * plane.height() + at.j) * plane.width() + at.i,
                ..keypoint(place.x, place.y, place.scale)
            }
        };
        found.into_iter().map(keypoint).collect::<Vec<_>>()
    };
    (0..octaves).flat_map(octave_keypoints).collect()
}

/// Pictures of all [`SIZES`] and [`photographs`], each with a name.
pub fn pictures() -> Vec<(String, Luma)> {
    let noise = SIZES.map(|(width, height)| (format!("{width}x{height}"), picture(width, height, 1)));
    let real = photographs().into_iter().map(|(name, picture)| (name, picture.luma()));
    noise.into_iter().chain(real).collect()
}

/// The left views of the rendered scenes, and of the real ones where they are present.
pub fn photographs() -> Vec<(String, Picture)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let real = root.join("../shared/data/stereo");
    let mut pictures = views_in(&root.join("data"));
    assert_eq!(pictures.len(), 3, "the scenes that come with the project");
    if real.is_dir() {
        pictures.extend(views_in(&real));
    } else {
        eprintln!("SKIPPED: real pictures, as {} is absent", real.display());
    }
    pictures
}

fn views_in(folder: &Path) -> Vec<(String, Picture)> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut files: Vec<_> =
        entries.map(|entry| entry.unwrap().path().join("left.png")).filter(|path| path.is_file()).collect();
    files.sort();
    files.into_iter().map(|path| (path.display().to_string(), hsad::io::load::load(&path).unwrap())).collect()
}

/// Compares element by element and tells the first difference.
pub fn assert_same<T: PartialEq + Debug>(what: &str, actual: &[T], expected: &[T]) {
    assert_mostly(what, actual, expected, 0.0, T::eq);
}

/// Compares element by element, tells the first that is not `near`, and allows a `share` of them.
pub fn assert_mostly<T: Debug>(what: &str, actual: &[T], expected: &[T], share: f64, near: impl Fn(&T, &T) -> bool) {
    assert_eq!(actual.len(), expected.len(), "{what}: lengths differ");
    let off: Vec<_> = (0..actual.len()).filter(|&i| !near(&actual[i], &expected[i])).collect();
    if off.len() as f64 > share * actual.len() as f64 {
        let first = off[0];
        let (actual, expected) = (&actual[first], &expected[first]);
        panic!("{what}: element {first} is {actual:?}, not {expected:?}; {} are off", off.len());
    }
}

/// Whether two places (column, row, scale, in pixels) are the same within 1/4096 px.
///
/// The division that places a maximum between its samples may be off by 2.5 units in the last place of half a sample,
/// and samples are up to 32 px apart; the place is rounded to 1/8192 px from 1024 px on.
pub fn place_near(actual: [f32; 3], expected: [f32; 3]) -> bool {
    actual.iter().zip(expected).all(|(a, e)| (a - e).abs() <= 1.0 / 4096.0)
}

/// Whether two directions, 0 to 2 pi, are the same within 1/1000.
///
/// The twin adds floats, the kernel whole numbers of 1/32768 grey level, and the `atan2` of a device may be off by 4096
/// units in the last place. On lavapipe they are at most 0.0004 apart.
pub fn angle_near(actual: &f32, expected: &f32) -> bool {
    let difference = (actual - expected).abs();
    (0.0..TAU).contains(actual) && difference.min(TAU - difference) <= 1e-3
}

/// Whether two descriptors are the same.
pub fn descriptor_near(tolerance: f32) -> impl Fn(&Values, &Values) -> bool {
    move |actual, expected| actual.iter().zip(expected).all(|(a, e)| (a - e).abs() <= tolerance)
}

#[test]
fn a_changed_angle_is_seen() {
    assert!(angle_near(&1.0, &1.0) && angle_near(&0.0, &(TAU - 1e-4)));
    assert!(!angle_near(&1.002, &1.0) && !angle_near(&(TAU + 1.0), &1.0) && !angle_near(&f32::NAN, &1.0));
}

#[test]
fn a_changed_descriptor_is_seen() {
    let good = [0.125; DESCRIPTOR_LENGTH];
    let near = descriptor_near(1e-4);
    assert!(near(&good, &good));
    for value in [0.1252, -0.125, f32::NAN] {
        let mut changed = good;
        changed[63] = value;
        assert!(!near(&changed, &good));
    }
}

#[test]
#[should_panic(expected = "element 2 is 4, not 3; 1 are off")]
fn a_changed_element_is_seen() {
    assert_same("copy", &[1, 2, 4], &[1, 2, 3]);
}

#[test]
#[should_panic(expected = "lengths differ")]
fn a_missing_element_is_seen() {
    assert_same("copy", &[1, 2], &[1, 2, 3]);
}

#[test]
#[should_panic(expected = "element 7 is 9, not 1; 2 are off")]
fn more_than_the_share_is_seen() {
    let expected = [1; 200];
    let mut actual = expected;
    actual[7] = 9;
    assert_mostly("copy", &actual, &expected, 0.005, i32::eq);
    actual[8] = 9;
    assert_mostly("copy", &actual, &expected, 0.005, i32::eq);
}

#[test]
fn poison_reaches_every_word() {
    let buffer = upload(&[0_u32; 3]);
    poison(&buffer);
    assert_eq!(download::<u32>(&buffer), [u32::MAX; 3]);
}
