//! Every frame costs the same: after the first frames no frame compiles a kernel or leaves memory behind.
//!
//! Memory is that of the process, which a compilation enlarges: drivers keep what they compile.
#![cfg(all(feature = "cli", target_os = "linux"))]

use std::sync::{Mutex, MutexGuard, PoisonError};

use hsad::{
    Detector, DeviceChoice, DisparityRange, FeatureConfig, Gpu, Matcher, Preset, block_on,
    image::{Luma, Size},
    luma::pack,
    wgpu,
};

/// Memory is measured for the whole process, so that one test runs at a time.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Resident memory of this process, in kB.
fn memory() -> i64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("the status of a process");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("its memory");
    line.trim().trim_end_matches(" kB").parse().expect("a number")
}

/// How much `work`, repeated so often, adds to the memory of this process, in kB. What it adds the first time is not
/// counted: pools and caches fill.
fn growth(times: u32, mut work: impl FnMut()) -> i64 {
    for _ in 0..times.div_ceil(4) {
        work();
    }
    let before = memory();
    for _ in 0..times {
        work();
    }
    memory() - before
}

fn open() -> Gpu {
    Gpu::open(&DeviceChoice::Best).expect("a device")
}

fn picture(size: Size) -> Luma {
    Luma::from_fn(size, |x, y| (x.wrapping_mul(7919) ^ y.wrapping_mul(104_729) ^ (x * y)) as u8)
}

const PRESETS: [Preset; 4] = [Preset::Fast, Preset::Balanced, Preset::Quality, Preset::Paper];

/// Accepted growth in 50 frames, in kB: fewer than the shortest of the compilations that lavapipe made at these widths
/// left behind.
const LIMIT: i64 = 1_000;

#[test]
fn no_frame_compiles_at_widths_that_are_powers_of_two() {
    let (_alone, gpu) = (alone(), open());
    let range = DisparityRange::new(0, 32).expect("a range");
    let mut grown = Vec::new();
    for preset in PRESETS {
        for width in [64, 128, 256, 512, 1024] {
            let matcher = Matcher::new(&gpu, (width, 24), &preset.dense_config(range)).expect("a matcher");
            let added = growth(50, || drop(matcher.run().expect("a map")));
            if added > LIMIT {
                grown.push((preset.to_string(), width, added));
            }
        }
    }
    assert!(grown.is_empty(), "preset, width and kB: {grown:?}");
}

#[test]
fn no_detection_compiles_at_widths_that_are_powers_of_two() {
    let (_alone, gpu) = (alone(), open());
    let mut grown = Vec::new();
    for width in [64, 128, 256, 512, 1024] {
        let view = picture(Size::new(width, 64));
        let detector = block_on(Detector::new(&gpu, view.size(), &FeatureConfig::default())).expect("a detector");
        let words = pack(&view);
        let luma = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4 * words.len() as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue.write_buffer(&luma, 0, bytemuck::cast_slice(&words));
        let added = growth(50, || drop(block_on(detector.detect(&luma)).expect("features")));
        if added > LIMIT {
            grown.push((width, added));
        }
    }
    assert!(grown.is_empty(), "width and kB: {grown:?}");
}

/// Sizes and ranges change as in a program that runs for days: what is dropped is freed.
#[test]
fn matchers_that_are_dropped_leave_nothing_behind() {
    let (_alone, gpu) = (alone(), open());
    let mut index = 0;
    let mut build = || {
        index += 1;
        let (size, count) = ((40 + index % 5, 24 + index % 7), 8 * (1 + index % 3));
        let range = DisparityRange::new(-(index as i32 % 4), count).expect("a range");
        for preset in [Preset::Balanced, Preset::Paper] {
            let matcher = Matcher::new(&gpu, size, &preset.dense_config(range)).expect("a matcher");
            matcher.run().expect("a map");
        }
        block_on(Detector::new(&gpu, size, &FeatureConfig::default())).expect("a detector");
    };
    let added = growth(100, &mut build);
    assert!(added <= LIMIT, "{added} kB");
}

/// On lavapipe, which compiles a kernel when it first runs, the first frame after a warm-up takes no more memory than any
/// other; without one it takes that of the compiled kernels.
#[test]
fn after_a_warm_up_the_first_frame_compiles_nothing() {
    let _alone = alone();
    let first_frame = |is_warm: bool| {
        let gpu = open();
        let config = Preset::Balanced.dense_config(DisparityRange::new(0, 32).expect("a range"));
        let matcher = Matcher::new(&gpu, (64, 48), &config).expect("a matcher");
        let mut readback = block_on(matcher.readback()).expect("a readback");
        if is_warm {
            block_on(matcher.warm_up(None, readback.outputs())).expect("a warm-up");
        }
        let before = memory();
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        matcher.record_luma(&mut encoder, readback.outputs());
        gpu.queue.submit([encoder.finish()]);
        block_on(readback.read()).expect("a map");
        (memory() - before, gpu.info().driver)
    };
    // The first device of a process also takes what the driver's compiler takes for itself.
    first_frame(false);
    let ((cold, driver), (warm, _)) = (first_frame(false), first_frame(true));
    if driver == "llvmpipe" {
        assert!(warm < cold / 4, "{warm} kB with a warm-up, {cold} kB without");
    }
}
