//! Run times of dense matching and of features on a device, cold and warm:
//! `cargo bench --bench speed -- [LEFT RIGHT [DISPARITIES [NAME]]]`, where NAME selects one measurement: 7x7, fast,
//! balanced, quality or features.
//!
//! One line per measurement: name, first run (which compiles), and minimum and median of the other runs, in
//! milliseconds; below a dense measurement the time of each kernel by the device's clock. `scripts/compare-opencv.py`
//! runs this benchmark beside OpenCV.
#![expect(clippy::print_stdout, reason = "a benchmark prints")]

use std::{
    hint::black_box,
    path::Path,
    time::{Duration, Instant},
};

use hsad::{
    config::Preset,
    dense::{DenseConfig, Destination, Matcher},
    disparity::DisparityRange,
    features::{Detector, FeatureConfig},
    gpu::{DeviceChoice, Gpu, block_on},
    image::{Luma, Size},
    io::{Picture, load},
    luma::pack,
    matching::match_features,
    seeding::Seeding,
    wgpu::{self, util::DeviceExt},
};

const RUNS: usize = 20;
const PROFILES: usize = 12;

fn main() -> hsad::Result<()> {
    // Cargo adds an argument --bench.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/curved");
    let picture = |i: usize, name: &str| load::load(&arguments.get(i).map_or_else(|| root.join(name), Into::into));
    let pair = [picture(0, "left.png")?, picture(1, "right.png")?];
    let disparities = arguments.get(2).and_then(|count| count.parse().ok()).unwrap_or(64);
    let gpu = Gpu::open(&DeviceChoice::Best)?;
    let Size { width, height } = pair[0].size();
    println!("{} ({}), {width}x{height}, {disparities} disparities", gpu.info().name, gpu.info().driver_info);
    let luma = pair.each_ref().map(Picture::luma);
    let is_selected = |name: &str| arguments.get(3).is_none_or(|selected| selected == name);
    dense(&gpu, &luma, disparities, is_selected)?;
    if is_selected("features") { features(&gpu, &luma) } else { Ok(()) }
}

/// Runs `work` repeatedly and prints its times.
fn time(name: &str, mut work: impl FnMut() -> hsad::Result<()>) -> hsad::Result<()> {
    let mut run = || {
        let start = Instant::now();
        work().map(|()| 1e3 * start.elapsed().as_secs_f64())
    };
    let first = run()?;
    let mut others = (0..RUNS).map(|_| run()).collect::<hsad::Result<Vec<_>>>()?;
    others.sort_by(f64::total_cmp);
    println!("{name}: first {first:.1} ms, minimum {:.1} ms, median {:.1} ms", others[0], others[RUNS / 2]);
    Ok(())
}

fn upload(gpu: &Gpu, luma: &Luma) -> wgpu::Buffer {
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("luma"),
        contents: bytemuck::cast_slice(&pack(luma)),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
    })
}

fn submit(gpu: &Gpu, record: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    record(&mut encoder);
    gpu.queue.submit([encoder.finish()]);
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
}

/// Block matching with a 7x7 window (both views, uniqueness, consistency and sub-pixel), then the presets.
fn dense(
    gpu: &Gpu,
    [left, right]: &[Luma; 2],
    disparities: u32,
    is_selected: impl Fn(&str) -> bool,
) -> hsad::Result<()> {
    let range = DisparityRange::new(0, disparities)?;
    let blocks = DenseConfig::new(range).with(|parameters| {
        parameters.uniqueness = 15;
        parameters.consistency = Some(256);
    });
    let preset = |preset: Preset| (preset.to_string(), preset.dense_config(range));
    let presets = [Preset::Fast, Preset::Balanced, Preset::Quality].map(preset);
    let bytes = 4 * left.data().len() as u64;
    let [map, confidence] = ["disparities", "confidences"].map(|label| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    });
    for (name, config) in [("7x7".into(), blocks)].into_iter().chain(presets) {
        if !is_selected(&name) {
            continue;
        }
        let start = Instant::now();
        let matcher = Matcher::new(gpu, left.size(), &config)?;
        println!("dense {name}, building: {:.1} ms, {} bytes", 1e3 * start.elapsed().as_secs_f64(), matcher.memory());
        for (view, luma) in [left, right].into_iter().zip(matcher.luma()) {
            gpu.queue.write_buffer(luma, 0, bytemuck::cast_slice(&pack(view)));
        }
        let outputs = matcher.outputs(Destination::Buffer(&map), Some(&confidence))?;
        time(&format!("dense {name}"), || {
            submit(gpu, |encoder| matcher.record_luma(encoder, &outputs));
            Ok(())
        })?;
        kernels(&matcher)?;
    }
    Ok(())
}

/// Prints the time of each kernel by the device's clock: the sum of its dispatches, each at its fastest.
fn kernels(matcher: &Matcher) -> hsad::Result<()> {
    let (_, mut least) = block_on(matcher.profile())?;
    for _ in 1..PROFILES {
        let (_, times) = block_on(matcher.profile())?;
        least.iter_mut().zip(times).for_each(|(least, time)| least.1 = least.1.min(time.1));
    }
    let mut sums: Vec<(&str, Vec<Duration>)> = Vec::new();
    for (name, time) in least {
        match sums.iter_mut().find(|sum| sum.0 == name) {
            Some(sum) => sum.1.push(time),
            None => sums.push((name, vec![time])),
        }
    }
    for (name, times) in sums {
        let milliseconds = |time: Duration| format!("{:.2}", 1e3 * time.as_secs_f64());
        let each: Vec<String> = times.iter().copied().map(milliseconds).collect();
        println!("  {name}: {} ms = {}", milliseconds(times.iter().sum()), each.join(" + "));
    }
    Ok(())
}

/// Times detection and description of both views, then matching and seeding.
fn features(gpu: &Gpu, luma: &[Luma; 2]) -> hsad::Result<()> {
    let detectors = luma
        .iter()
        .map(|view| {
            let detector = block_on(Detector::new(gpu, view.size(), &FeatureConfig::default()))?;
            let input = block_on(detector.input(&upload(gpu, view)))?;
            Ok((detector, input))
        })
        .collect::<hsad::Result<Vec<_>>>()?;
    let detect = || -> hsad::Result<Vec<_>> {
        submit(gpu, |encoder| detectors.iter().for_each(|(detector, input)| detector.record(encoder, input)));
        detectors.iter().map(|(detector, _)| block_on(detector.read())).collect()
    };
    time("features of both views", || detect().map(|found| drop(black_box(found))))?;
    let found = detect()?;
    let seeding = Preset::Balanced.config().seeding;
    time("matching", || {
        match_features(&found[0], &found[1], &seeding.matching).map(|matches| drop(black_box(matches)))
    })?;
    time("seeding", || {
        Seeding::find((&luma[0], &luma[1]), (&found[0], &found[1]), &seeding).map(|seeding| drop(black_box(seeding)))
    })?;
    println!("features: {} and {}", found[0].len(), found[1].len());
    Ok(())
}
