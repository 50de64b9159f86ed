//! What the tests of all kernels share: a device, buffers on their way there and back, pictures.

use std::{fmt::Debug, sync::OnceLock};

use hsad::{
    gpu::{DeviceChoice, Gpu},
    image::Luma,
    wgpu::{self, util::DeviceExt},
};

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

/// Compares element by element and tells the first difference.
pub fn assert_same<T: PartialEq + Debug>(what: &str, actual: &[T], expected: &[T]) {
    assert_eq!(actual.len(), expected.len(), "{what}: lengths differ");
    if let Some(i) = (0..actual.len()).find(|&i| actual[i] != expected[i]) {
        panic!("{what}: element {i} is {:?}, not {:?}", actual[i], expected[i]);
    }
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

#[test]
#[should_panic(expected = "element 2 is 4, not 3")]
fn a_changed_element_is_seen() {
    assert_same("copy", &[1, 2, 4], &[1, 2, 3]);
}

#[test]
#[should_panic(expected = "lengths differ")]
fn a_missing_element_is_seen() {
    assert_same("copy", &[1, 2], &[1, 2, 3]);
}

#[test]
fn poison_reaches_every_word() {
    let buffer = upload(&[0_u32; 3]);
    poison(&buffer);
    assert_eq!(download::<u32>(&buffer), [u32::MAX; 3]);
}
