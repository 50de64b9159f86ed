//! `hsad bench`: times of the dense presets on a device, by kernel.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use anyhow::anyhow;
use clap::{
    Args,
    builder::{PossibleValuesParser, TypedValueParser},
};
use hsad::{
    Preset, Size,
    dense::Matcher,
    disparity::DisparityRange,
    gpu::{DeviceChoice, Gpu, SgmPlan, block_on},
    image::Luma,
    io::atomic,
    luma::pack,
    verify::MAX_SIDE,
};
use serde_json::{Value, json};

use super::{
    demo,
    output::{check_writable, write_json},
    terminal::{self, Progress},
    verify::{described, plans, size},
};

/// Time each preset on a device, kernel by kernel
///
/// Matches the scene built into this program, enlarged or repeated to each size such that its disparities are among those that
/// are searched. Times are of dense matching alone, from two views on the device to a map on the device: no files, no seeding.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad bench
  hsad bench --preset balanced --size 640x480 --disparities 128
  hsad bench --plan lanes --json lanes.json
  hsad bench --compare before.json")]
pub struct Bench {
    /// Device to measure: best, or the index or a part of the name of a device (see hsad devices)
    #[arg(long, default_value_t = DeviceChoice::Best)]
    device: DeviceChoice,
    /// Preset to measure; repeatable [default: fast, balanced and quality]
    #[arg(long, value_parser = presets())]
    preset: Vec<Preset>,
    /// Picture size in pixels, each side 1 to 4096; repeatable [default: 640x480]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Vec<Size>,
    /// Number of disparities; repeatable [default: 64]
    #[arg(long, value_name = "N")]
    disparities: Vec<u32>,
    /// How threads share the work of semi-global matching [default: lines on a CPU, lanes on a GPU]
    #[arg(long, value_parser = plans())]
    plan: Option<SgmPlan>,
    /// Warm runs of each, 1 to 10000
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    /// Write the figures to this file as JSON, or to stdout (-) instead of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// JSON of an earlier run, with whose medians those of this run are compared
    #[arg(long, value_name = "FILE")]
    compare: Option<PathBuf>,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

fn presets() -> impl TypedValueParser<Value = Preset> {
    PossibleValuesParser::new(Preset::ALL.map(Preset::name)).map(|name| name.parse().expect("one of the names above"))
}

impl Bench {
    /// Measures and prints.
    pub fn run(self) -> anyhow::Result<()> {
        let cases = self.cases()?;
        let earlier = self.compare.as_deref().map(Earlier::read).transpose()?;
        let file = self.json.as_deref().filter(|file| *file != Path::new("-"));
        file.map(check_writable).transpose()?;
        let mut gpu = Gpu::open(&self.device)?;
        if let Some(plan) = self.plan {
            gpu = gpu.with_sgm_plan(plan);
        }
        let table = !self.quiet && (self.json.is_none() || file.is_some());
        let print = |text: &str| if table { terminal::print(text) } else { Ok(()) };
        print(&format!("{}semi-global matching by {}\n", described(&gpu), gpu.shapes().sgm))?;

        let scene = demo::views()?;
        let progress = Progress::new(self.quiet);
        let mut reports = Vec::new();
        for case in cases {
            progress.begin(case.name());
            let figures = case.measure(&gpu, &scene, self.runs)?;
            progress.suspend(|| print(&figures.text(earlier.as_ref())))?;
            reports.push(figures.report());
        }
        drop(progress);
        if let Some(path) = &self.json {
            let info = gpu.info();
            let report = json!({
                "version": env!("CARGO_PKG_VERSION"),
                "device": {
                    "name": info.name,
                    "backend": info.backend.to_string(),
                    "driver": format!("{} {}", info.driver, info.driver_info),
                },
                "plan": gpu.shapes().sgm.name(),
                "runs": self.runs,
                "cases": reports,
            });
            match file {
                Some(_) => atomic::write_whole(path, |out| write_json(out, &report))?,
                None => terminal::print(&format!("{report:#}\n"))?,
            }
        }
        Ok(())
    }

    fn cases(&self) -> anyhow::Result<Vec<Case>> {
        fn or<T: Copy>(given: &[T], default: &[T]) -> Vec<T> {
            if given.is_empty() { default } else { given }.to_vec()
        }
        let mut cases = Vec::new();
        for &size in &or(&self.size, &[Size::new(640, 480)]) {
            if !(1..=MAX_SIDE).contains(&size.width) || !(1..=MAX_SIDE).contains(&size.height) {
                return Err(hsad::Error::Parameter {
                    name: "--size",
                    value: size.to_string(),
                    expected: format!("each side must be 1 to {MAX_SIDE} px"),
                }
                .into());
            }
            for &disparities in &or(&self.disparities, &[64]) {
                let range = DisparityRange::new(0, disparities)?;
                for &preset in &or(&self.preset, &[Preset::Fast, Preset::Balanced, Preset::Quality]) {
                    preset.dense_config(range).validate()?;
                    cases.push(Case { preset, size, range });
                }
            }
        }
        Ok(cases)
    }
}

/// What is measured.
struct Case {
    preset: Preset,
    size: Size,
    range: DisparityRange,
}

impl Case {
    fn name(&self) -> String {
        format!("{} {} {}", self.preset, self.size, self.range.count)
    }

    fn measure(self, gpu: &Gpu, (views, largest): &([Luma; 2], f32), runs: u32) -> hsad::Result<Figures> {
        let start = Instant::now();
        let matcher = Matcher::new(gpu, self.size, &self.preset.dense_config(self.range))?;
        let width = views[0].width();
        let scale = f64::from(self.size.width) / f64::from(width);
        let scale = scale.min(f64::from(self.range.last()) / f64::from(*largest)).max(0.1);
        for (view, luma) in views.iter().zip(matcher.luma()) {
            gpu.queue.write_buffer(luma, 0, bytemuck::cast_slice(&pack(&repeated(view, scale, self.size))));
        }
        let run = || {
            let start = Instant::now();
            matcher.run().map(|_| start.elapsed())
        };
        run()?;
        let cold = start.elapsed();
        let mut warm = (0..runs).map(|_| run()).collect::<hsad::Result<Vec<_>>>()?;
        warm.sort();
        // Without timestamps the device tells no times of kernels.
        let kernels = match block_on(matcher.profile()) {
            Ok((_, mut least)) => {
                for _ in 1..runs {
                    let (_, times) = block_on(matcher.profile())?;
                    least.iter_mut().zip(times).for_each(|(least, time)| least.1 = least.1.min(time.1));
                }
                Some(least)
            }
            Err(hsad::Error::Unsupported(_)) => None,
            Err(error) => return Err(error),
        };
        Ok(Figures { memory: matcher.memory(), case: self, cold, warm, kernels })
    }
}

/// A view enlarged by `scale` and repeated to a picture of `size`: of each pixel the nearest one.
fn repeated(view: &Luma, scale: f64, size: Size) -> Luma {
    let at = |place: u32, length: u32| (f64::from(place) / scale) as u32 % length;
    Luma::from_fn(size, |x, y| view.get(at(x, view.width()), at(y, view.height())))
}

/// What was measured.
struct Figures {
    case: Case,
    /// From nothing to the first map, with the compilation of kernels.
    cold: Duration,
    /// Times of the other runs, in increasing order.
    warm: Vec<Duration>,
    /// Kernels in the order of execution, each at its fastest.
    kernels: Option<Vec<(&'static str, Duration)>>,
    /// Bytes of the matcher's buffers and textures.
    memory: u64,
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}

impl Figures {
    fn median(&self) -> f64 {
        milliseconds(self.warm[self.warm.len() / 2])
    }

    /// Millions of pixels times disparities per second.
    fn rate(&self) -> f64 {
        let Case { size, range, .. } = self.case;
        size.pixels() as f64 * f64::from(range.count) / 1e3 / self.median()
    }

    /// Dispatches and time of each kernel, in the order of first execution.
    fn sums(&self) -> Option<Vec<(&'static str, usize, f64)>> {
        let mut sums: Vec<(&str, usize, f64)> = Vec::new();
        for &(name, time) in self.kernels.as_ref()? {
            match sums.iter_mut().find(|sum| sum.0 == name) {
                Some((_, dispatches, sum)) => (*dispatches, *sum) = (*dispatches + 1, *sum + milliseconds(time)),
                None => sums.push((name, 1, milliseconds(time))),
            }
        }
        Some(sums)
    }

    fn text(&self, earlier: Option<&Earlier>) -> String {
        let mut text = format!(
            "\n{}: first {:.1} ms, then at least {:.2} ms, median {:.2} ms, {:.0} Mpd/s, {:.0} MB\n",
            self.case.name(),
            milliseconds(self.cold),
            milliseconds(self.warm[0]),
            self.median(),
            self.rate(),
            self.memory as f64 / 1e6,
        );
        if let Some(earlier) = earlier {
            text += &match earlier.0.get(&self.case.name()) {
                Some(before) => format!("  {:.2} of the earlier median, {before:.2} ms\n", self.median() / before),
                None => "  not measured earlier\n".into(),
            };
        }
        match self.sums() {
            None => text += "  no times of kernels: the device has no timestamps\n",
            Some(sums) => {
                let all: f64 = sums.iter().map(|sum| sum.2).sum();
                for (name, dispatches, sum) in sums {
                    let share = 100.0 * sum / all;
                    text += &format!("  {name:<16}{sum:>9.3} ms{share:>6.1} %  in {dispatches}\n");
                }
            }
        }
        text
    }

    fn report(&self) -> Value {
        let Case { preset, size, range } = self.case;
        let kernel = |(name, dispatches, sum)| json!({ "name": name, "dispatches": dispatches, "ms": sum });
        json!({
            "preset": preset.name(),
            "width": size.width,
            "height": size.height,
            "disparities": range.count,
            "first_ms": milliseconds(self.cold),
            "least_ms": milliseconds(self.warm[0]),
            "median_ms": self.median(),
            "mpd_per_s": self.rate(),
            "bytes": self.memory,
            "kernels": self.sums().map(|sums| sums.into_iter().map(kernel).collect::<Vec<_>>()),
        })
    }
}

/// Medians of an earlier run, by the names of the cases.
struct Earlier(BTreeMap<String, f64>);

impl Earlier {
    fn read(file: &Path) -> anyhow::Result<Self> {
        let text = fs::read_to_string(file).map_err(|error| anyhow!("{}: {error}", file.display()))?;
        let unknown = || anyhow!("{}: no figures of hsad bench --json", file.display());
        let report: Value = serde_json::from_str(&text).map_err(|_| unknown())?;
        let case = |case: &Value| {
            let number = |name: &str| case[name].as_u64();
            let (width, height) = (number("width")?, number("height")?);
            let name = format!("{} {width}x{height} {}", case["preset"].as_str()?, number("disparities")?);
            Some((name, case["median_ms"].as_f64().filter(|median| *median > 0.0)?))
        };
        let cases = report["cases"].as_array().ok_or_else(unknown)?;
        cases.iter().map(|one| case(one).ok_or_else(unknown)).collect::<Result<_, _>>().map(Self)
    }
}
