//! Disparities of a sequence of frames: upload, compute and read-back overlap over a ring of slots, and the disparity
//! range and brightness found from the features of a frame serve the following frames. Another range is prepared on a thread
//! while frames flow, and a lost device is replaced: no frame is lost by either.
//!
//!     cargo run --example stream -- [FRAMES [LOST]]
//!
//! The frames are windows that move over the shipped pair; from the middle on, the right camera is darker. Before frame LOST
//! the device is lost.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "it prints results and errors")]

mod engine;
mod slot;
mod stream;

use std::{
    path::Path,
    process::ExitCode,
    time::{Duration, Instant},
};

use hsad::{
    config::Preset,
    dense::Dense,
    disparity::{DisparityRange, NONE},
    gpu::{Gpu, block_on},
    image::Size,
    io::{Picture, load},
    wgpu,
};

use slot::FrameResult;
use stream::{SLOTS, Stream};

type AnyError = Box<dyn std::error::Error>;

/// Width and height of a frame, in pixels.
const SIZE: Size = Size::new(256, 192);

/// The cameras.
struct Scene {
    views: [Picture; 2],
    frames: usize,
}

impl Scene {
    /// The views of both cameras at a time.
    fn frame(&self, index: usize) -> [Picture; 2] {
        let Size { width, height } = self.views[0].size();
        let (x0, y0) = ((3 * index as u32) % (width - SIZE.width), index as u32 % (height - SIZE.height));
        let crop = |view: &Picture| Picture::from_fn(SIZE, |x, y| view.get(x0 + x, y0 + y));
        let [left, right] = [crop(&self.views[0]), crop(&self.views[1])];
        let darker = |level: u8| (u16::from(level) * 2 / 3) as u8;
        let is_dark = index >= self.frames / 2;
        [left, if is_dark { right.map(|&[r, g, b, a]| [darker(r), darker(g), darker(b), a]) } else { right }]
    }
}

/// The frames per second of a run, and the longest time between two results.
struct Pace {
    rate: f64,
    longest: Duration,
}

/// Submits all frames, with `SLOTS` of them in flight, or one if `in_turn`. The device is lost before frame `lost`.
fn run(
    stream: &mut Stream,
    scene: &Scene,
    (in_turn, lost): (bool, Option<usize>),
    mut tell: impl FnMut(FrameResult),
) -> Result<Pace, AnyError> {
    let start = Instant::now();
    let (mut last, mut longest) = (start, Duration::ZERO);
    for index in 0..scene.frames + SLOTS {
        stream.collect(index)?.map(&mut tell);
        if index < scene.frames {
            if lost == Some(index) {
                stream.lose();
            }
            stream.send(index, scene.frame(index));
        }
        if in_turn {
            stream.collect(index)?.map(&mut tell);
        }
        longest = longest.max(last.elapsed());
        last = Instant::now();
    }
    Ok(Pace { rate: scene.frames as f64 / start.elapsed().as_secs_f64(), longest })
}

fn coverage(map: &Dense) -> f64 {
    let known = map.disparity.data().iter().filter(|&&disparity| disparity != NONE).count();
    100.0 * known as f64 / f64::from(SIZE.width * SIZE.height)
}

fn tell(FrameResult { index, range, map, seeding }: FrameResult) {
    let coverage = coverage(&map);
    let known: Vec<i32> = map.disparity.into_data().into_iter().filter(|&disparity| disparity != NONE).collect();
    let mean = known.iter().map(|&d| f64::from(d) / 256.0).sum::<f64>() / known.len().max(1) as f64;
    print!(
        "frame {index:3}  coverage {coverage:5.1} %  mean disparity {mean:5.2} px of {} to {}",
        range.min,
        range.last()
    );
    match seeding.and_then(|seeding| Some((seeding.seeds.len(), seeding.brightness?))) {
        Some((seeds, brightness)) => println!("  {seeds} seeds, right view {:.2} times as bright", brightness.gain),
        None => println!(),
    }
}

fn main() -> ExitCode {
    match stream() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// A device as an application opens it.
fn open() -> Result<Gpu, AnyError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let (device, queue) = block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_limits: wgpu::Limits::downlevel_defaults(),
        ..Default::default()
    }))?;
    Ok(Gpu::new(device, queue))
}

fn stream() -> Result<(), AnyError> {
    let number = |index, otherwise| match std::env::args().nth(index) {
        None => Ok(otherwise),
        Some(text) => {
            let usage = format!("'{text}' is no number of frames: usage: stream [FRAMES [LOST]]");
            text.parse().map(Some).map_err(|_| usage)
        }
    };
    let (frames, lost) = (number(1, Some(48))?.unwrap_or(48), number(2, None)?);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/curved");
    let scene =
        Scene { views: [load::load(&folder.join("left.png"))?, load::load(&folder.join("right.png"))?], frames };

    // The range is a guess until there are seeds.
    let config = Preset::Fast.dense_config(DisparityRange::new(0, 32)?);
    let mut stream = Stream::new(open, SIZE, config)?;
    let first = run(&mut stream, &scene, (false, lost), tell)?;
    stream.adopt()?;
    let mut coverages = 0.0;
    let overlapped = run(&mut stream, &scene, (false, None), |result| coverages += coverage(&result.map))?;
    let in_turn = run(&mut stream, &scene, (true, None), drop)?;
    println!(
        "longest time between results {} ms, then {} ms",
        first.longest.as_millis(),
        overlapped.longest.as_millis()
    );
    println!("mean coverage {:.1} %, of the range that was found", coverages / frames as f64);
    println!("{:.1} frames per second; {:.1} with each one waited for", overlapped.rate, in_turn.rate);
    Ok(())
}
