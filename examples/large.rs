//! Time and memory of the preset `balanced` on large pictures, over a pyramid and over the whole range:
//! `cargo run --example large -- LEFT RIGHT DISPARITIES [MEGAPIXELS...]`, with the number of disparities of the pair as
//! given. The pair is enlarged to each number of megapixels (0.4, 1.5, 3, 12, 24 and 50), and its range with it.
//!
//! Each search runs in a process of its own, whose peak of memory Linux tells; on a software driver that is the device's
//! memory too. Times are of dense matching alone, with the compilation of its kernels.
#![expect(clippy::print_stdout, reason = "a measurement prints")]

use std::{env, fs, path::Path, process::Command, time::Instant};

use hsad::{
    config::Preset,
    dense::{self, Aggregation, DenseConfig, Pyramid, Search},
    disparity::{DisparityRange, coverage},
    gpu::{DeviceChoice, Gpu, block_on},
    image::{Luma, Size},
    io::load,
};

type AnyError = Box<dyn std::error::Error>;

const MEGAPIXELS: [&str; 6] = ["0.4", "1.5", "3", "12", "24", "50"];

fn main() -> Result<(), AnyError> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    if let [left, right, disparities, megapixels, search] = &arguments[..]
        && let Some(search) = search_of(search)
    {
        return measure([left, right], disparities.parse()?, megapixels.parse()?, search);
    }
    let [left, right, disparities, sizes @ ..] = &arguments[..] else {
        return Err("LEFT RIGHT DISPARITIES [MEGAPIXELS...]".into());
    };
    let sizes = if sizes.is_empty() { MEGAPIXELS.map(String::from).to_vec() } else { sizes.to_vec() };
    for size in &sizes {
        for search in ["pyramid", "whole"] {
            Command::new(env::current_exe()?).args([left, right, disparities, size, search]).status()?;
        }
    }
    Ok(())
}

fn search_of(name: &str) -> Option<Search> {
    match name {
        "pyramid" => Some(Search::CoarseToFine),
        "whole" => Some(Search::Whole),
        _ => None,
    }
}

fn measure(files: [&String; 2], disparities: u32, megapixels: f64, search: Search) -> Result<(), AnyError> {
    let views = files.map(|file| load::load(Path::new(file)).map(|picture| picture.luma()));
    let [left, right] = views;
    let (left, right) = (left?, right?);
    let scale = (1e6 * megapixels / left.size().pixels() as f64).sqrt().max(1.0);
    let views = [enlarged(&left, scale), enlarged(&right, scale)];
    let size = views[0].size();
    let range = DisparityRange::new(0, (scale * f64::from(disparities)).ceil() as u32)?;
    let config = DenseConfig { parameters: Preset::Balanced.dense_parameters(), ..DenseConfig::new(range) };
    let config = config.with(|parameters| {
        if let Aggregation::Costs(costs) = &mut parameters.aggregation {
            costs.search = search;
        }
    });
    let levels = Pyramid::of(&config, size).map_or(1, |pyramid| pyramid.levels().len());
    let gpu = Gpu::open(&DeviceChoice::Best)?;
    let start = Instant::now();
    let map = block_on(dense::compute(&gpu, &views[0], &views[1], &config))?.disparity;
    println!(
        "{size}, {} disparities, {levels} levels: {:.1} s, at most {} MB, {:.1} % covered",
        range.count,
        start.elapsed().as_secs_f64(),
        peak_megabytes().map_or("?".into(), |peak| peak.to_string()),
        100.0 * coverage(&map),
    );
    Ok(())
}

/// A view enlarged by `scale`, by linear interpolation.
fn enlarged(view: &Luma, scale: f64) -> Luma {
    let length = |length: u32| (scale * f64::from(length)).round() as u32;
    let Size { width, height } = view.size();
    Luma::from_fn((length(width), length(height)), |x, y| {
        let place = |at: u32| (f64::from(at) + 0.5) / scale - 0.5;
        let (x, y) = (place(x), place(y));
        let at = |i: i64, j: i64| f64::from(view.get_clamped(x.floor() as i64 + i, y.floor() as i64 + j));
        let (i, j) = (x - x.floor(), y - y.floor());
        let row = |below: i64| (1.0 - i) * at(0, below) + i * at(1, below);
        ((1.0 - j) * row(0) + j * row(1)).round() as u8
    })
}

/// The most memory that this process has had, in MB.
fn peak_megabytes() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches(" kB").trim().parse::<u64>().ok().map(|kilobytes| kilobytes / 1024)
}
