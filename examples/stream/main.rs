//! Disparities of a sequence of frames: upload, compute and read-back overlap over a ring of slots, and the disparity
//! range and brightness found from the features of a frame serve the following frames.
//!
//!     cargo run --example stream -- [FRAMES]
//!
//! The frames are windows that move over the shipped pair; from the middle on, the right camera is darker.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "it prints results and errors")]

mod slot;

use std::{path::Path, process::ExitCode, rc::Rc, time::Instant};

use hsad::{
    config::Preset,
    dense::DenseConfig,
    disparity::{DisparityRange, NONE},
    gpu::Gpu,
    image::Size,
    io::{Picture, load},
    seeding::Seeding,
    wgpu,
};

use slot::{Engine, FrameResult, Slot};

type AnyError = Box<dyn std::error::Error>;

/// Number of frames in flight: one is uploaded, one computed, one read.
const SLOTS: usize = 3;
/// Seeding runs on one frame out of this many.
const SEEDED: usize = 8;
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

/// The engine for the next frames, and the frames in flight, each with the engine it was submitted to.
struct Stream {
    engine: Rc<Engine>,
    slots: Vec<Slot>,
}

impl Stream {
    fn new(gpu: &Gpu, config: DenseConfig) -> hsad::Result<Self> {
        let engine = Rc::new(Engine::new(gpu, SIZE, config)?);
        let slots = (0..SLOTS).map(|_| Slot::new(&engine, SIZE)).collect::<hsad::Result<_>>()?;
        Ok(Self { engine, slots })
    }

    /// Submits a frame in a free slot.
    fn send(&mut self, index: usize, frame: [Picture; 2]) -> hsad::Result<()> {
        let slot = &mut self.slots[index % SLOTS];
        if !Rc::ptr_eq(&slot.engine, &self.engine) {
            *slot = Slot::new(&self.engine, SIZE)?;
        }
        slot.send(index, frame, index.is_multiple_of(SEEDED));
        Ok(())
    }

    /// Waits for the frame in the slot that frame `index` will take, and learns from it.
    fn collect(&mut self, index: usize) -> hsad::Result<Option<FrameResult>> {
        let result = self.slots[index % SLOTS].collect()?;
        if let Some(seeding) = result.as_ref().and_then(|result| result.seeding.as_ref()) {
            self.learn(seeding)?;
        }
        Ok(result)
    }

    /// Adopts range and brightness from the seeds of a frame for the following frames. A change of brightness costs
    /// nothing; a change of range needs another engine, so it happens only if necessary. Frames in flight keep the engine
    /// they were submitted to.
    fn learn(&mut self, seeding: &Seeding) -> hsad::Result<()> {
        let mut config = self.engine.config.clone();
        if let Some(found) = &seeding.brightness {
            config.brightness = found.equalising();
            self.engine.matcher.set_brightness(config.brightness)?;
        }
        let Ok(found) = seeding.range.map(|found| found.range) else { return Ok(()) };
        let has = config.range;
        let too_small = found.min < has.min || found.last() > has.last();
        if too_small || 4 * found.count < has.count {
            // A margin of half the range on either side keeps the next frames inside.
            let margin = (found.count / 2).cast_signed();
            let range = DisparityRange::inclusive(found.min - margin, found.last() + margin)?;
            println!("range {} to {} px instead of {} to {}", range.min, range.last(), has.min, has.last());
            self.engine = Rc::new(Engine::new(&self.engine.gpu, SIZE, DenseConfig { range, ..config })?);
        }
        Ok(())
    }
}

/// Submits all frames, with `SLOTS` of them in flight, or one if `in_turn`. Returns the frames per second.
fn run(stream: &mut Stream, scene: &Scene, in_turn: bool, mut tell: impl FnMut(FrameResult)) -> Result<f64, AnyError> {
    let start = Instant::now();
    for index in 0..scene.frames + SLOTS {
        stream.collect(index)?.map(&mut tell);
        if index < scene.frames {
            stream.send(index, scene.frame(index))?;
        }
        if in_turn {
            stream.collect(index)?.map(&mut tell);
        }
    }
    Ok(scene.frames as f64 / start.elapsed().as_secs_f64())
}

fn tell(FrameResult { index, map, seeding }: FrameResult) {
    let known: Vec<i32> = map.disparity.into_data().into_iter().filter(|&disparity| disparity != NONE).collect();
    let mean = known.iter().map(|&d| f64::from(d) / 256.0).sum::<f64>() / known.len().max(1) as f64;
    let coverage = 100.0 * known.len() as f64 / f64::from(SIZE.width * SIZE.height);
    print!("frame {index:3}  coverage {coverage:5.1} %  mean disparity {mean:5.2} px");
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

fn stream() -> Result<(), AnyError> {
    let frames = match std::env::args().nth(1) {
        None => 48,
        Some(frames) => {
            frames.parse().map_err(|_| format!("'{frames}' is no number of frames: usage: stream [FRAMES]"))?
        }
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/curved");
    let scene =
        Scene { views: [load::load(&folder.join("left.png"))?, load::load(&folder.join("right.png"))?], frames };

    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_limits: wgpu::Limits::downlevel_defaults(),
        ..Default::default()
    }))?;

    // The range is a guess until there are seeds.
    let config = Preset::Fast.dense_config(DisparityRange::new(0, 32)?);
    let mut stream = Stream::new(&Gpu::new(device, queue), config)?;
    run(&mut stream, &scene, false, tell)?;
    let overlapped = run(&mut stream, &scene, false, drop)?;
    let in_turn = run(&mut stream, &scene, true, drop)?;
    println!("{overlapped:.1} frames per second; {in_turn:.1} with each one waited for");
    Ok(())
}
