//! `hsad tune`: the fastest kernels for a device, by measuring.

mod parts;
mod race;

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use anyhow::anyhow;
use clap::Args;
use hsad::{
    Gpu, Preset, Size,
    gpu::{DeviceChoice, Shapes, ShapesFile, Windows, block_on, cache_folder},
    io::atomic,
    wgpu::DeviceType,
};
use serde_json::{Value, json};

use self::{
    parts::{PARTS, Part},
    race::{LEAST_ROUNDS, Races, Runner},
};
use super::{
    bench::{Case, Scene},
    demo,
    output::{check_writable, write_json},
    terminal::{self, Progress},
    verify::{described, no_twins, size},
};

/// Find the fastest kernels for a device, and keep the choice
///
/// Some stages have several kernels with the same result, to the bit, of which one is fastest on one device and another on another.
/// Each is timed at the given size in turn with the one that the device gets by default, whose place it takes only if it is clearly faster, and
/// so once more at the end. The choice is kept in the user's cache folder, for this device and its driver: match, demo, eval, verify and bench
/// take it from then on.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad tune
  hsad tune --device nvidia --size 1920x1080 --disparities 256
  hsad tune --forget")]
pub struct Tune {
    /// Device to measure: best, or the index or a part of the name of a device (see hsad devices)
    #[arg(long, default_value_t = DeviceChoice::Best)]
    device: DeviceChoice,
    /// Picture size in pixels, each side 1 to 4096
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "640x480")]
    size: Size,
    /// Number of disparities
    #[arg(long, value_name = "N", default_value_t = 128)]
    disparities: u32,
    /// Runs of each kernel and of the default beside it, 5 to 10000; one that is far slower runs once
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(i64::from(LEAST_ROUNDS)..=10_000))]
    runs: u32,
    /// Time in seconds after which no other kernel is measured, 1 to 86400
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    seconds: u32,
    /// Forget the choice for the device instead
    #[arg(long, conflicts_with_all = ["size", "disparities", "runs", "seconds", "json"])]
    forget: bool,
    /// Write the times to this file as JSON, or to stdout (-) instead of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

impl Tune {
    /// Measures, keeps the choice, and prints the times.
    pub fn run(self) -> anyhow::Result<()> {
        no_twins(&self.device, "hsad tune times the kernels of a device, or of a driver such as lavapipe")?;
        Case::new(Preset::Balanced, self.size, self.disparities)?;
        let json_file = self.json.as_deref().filter(|file| *file != Path::new("-"));
        json_file.map(check_writable).transpose()?;
        let gpu = Gpu::open(&self.device)?;
        let folder = cache_folder().ok_or_else(|| {
            anyhow!("no folder to keep the choice in: set HOME, XDG_CACHE_HOME or LOCALAPPDATA to an absolute path")
        })?;
        let kept = ShapesFile::of(&gpu, &folder);
        if !self.forget {
            // Told before anything is measured.
            let failed = |error| anyhow!("{}: no choice can be kept there ({error})", hsad::shown(&folder));
            kept.path().parent().map_or(Ok(()), std::fs::create_dir_all).map_err(failed)?;
            check_writable(kept.path())?;
        }
        let table = !self.quiet && self.json.as_deref() != Some(Path::new("-"));
        let print = |text: &str| if table { terminal::print(text) } else { Ok(()) };
        if self.forget {
            let known = if kept.remove()? { "forgotten" } else { "nothing was kept" };
            return Ok(print(&format!("{}{known}: {}\n", described(&gpu), kept.path().display()))?);
        }

        print(&described(&gpu))?;
        let progress = Progress::new(self.quiet);
        let mut shapes = gpu.shapes();
        let scene = demo::views()?;
        let (mut reports, mut unmeasured) = (Vec::new(), 0);
        let end = Instant::now() + Duration::from_secs(self.seconds.into());
        for (number, part) in PARTS.iter().enumerate() {
            // Each part has the share of the time that is its share of the candidates.
            let candidates = |part: &Part| candidates(part, &gpu, shapes).len() as u32;
            let left: u32 = PARTS[number..].iter().map(candidates).sum();
            let share = end.saturating_duration_since(Instant::now()) * candidates(part) / left.max(1);
            let measured = self.measure(part, (&gpu, shapes), &scene, &progress, Instant::now() + share)?;
            shapes = measured.chosen();
            progress.suspend(|| print(&measured.text()))?;
            unmeasured += measured.rows().iter().filter(|row| row.times.is_none()).count();
            reports.push(measured.report());
        }
        drop(progress);
        kept.write(shapes)?;
        if unmeasured > 0 {
            print(&format!(
                "\n{unmeasured} kernels were not measured in {} s: --seconds gives more time\n",
                self.seconds
            ))?;
        }
        print(&format!("\nkept in {}\n", kept.path().display()))?;
        if let Some(path) = &self.json {
            let report = json!({
                "version": env!("CARGO_PKG_VERSION"),
                "device": gpu.info().name,
                "width": self.size.width,
                "height": self.size.height,
                "disparities": self.disparities,
                "parts": reports,
                "shapes": shapes.to_string(),
            });
            match json_file {
                Some(_) => atomic::write_whole(path, |out| write_json(out, &report))?,
                None => terminal::print(&format!("{report:#}\n"))?,
            }
        }
        Ok(())
    }

    fn measure(
        &self,
        part: &'static Part,
        (gpu, present): (&Gpu, Shapes),
        scene: &Scene,
        progress: &Progress,
        end: Instant,
    ) -> anyhow::Result<Measured> {
        let case = Case::new(part.preset, self.size, self.disparities)?;
        let runner = |name: &str, shapes: Shapes| -> anyhow::Result<Runner> {
            progress.begin(format!("{}: {name}", part.name));
            let matcher = case.matcher(&gpu.clone().with_shapes(shapes), scene)?;
            // The first run compiles.
            matcher.run()?;
            Ok(Box::new(move || match block_on(matcher.profile()) {
                Ok((_, kernels)) => Ok(part.milliseconds(&kernels)),
                Err(hsad::Error::Unsupported(_)) => {
                    Err(anyhow!("the device tells no times of kernels: it has no timestamps"))
                }
                Err(error) => Err(error.into()),
            }))
        };
        let candidates = candidates(part, gpu, present);
        let default = runner("the default", present)?;
        let prepare = |index: usize| {
            let (name, shapes) = &candidates[index];
            runner(name, *shapes)
        };
        let races = Races::run(candidates.len(), self.runs, default, prepare, &|| Instant::now() < end)?;
        Ok(Measured { part, present, candidates, races })
    }
}

/// What can be chosen in place of `present`, but for what a driver takes minutes to compile.
fn candidates(part: &Part, gpu: &Gpu, present: Shapes) -> Vec<(String, Shapes)> {
    let candidates = (part.candidates)(present).into_iter();
    candidates.filter(|(_, shapes)| *shapes != present && !takes_minutes(gpu, shapes)).collect()
}

/// Whether a driver takes minutes to compile the kernels of `shapes`: that of a CPU whose own shapes have no windows in registers.
fn takes_minutes(gpu: &Gpu, shapes: &Shapes) -> bool {
    let own = gpu.shapes();
    let is_cpu = gpu.info().device_type == DeviceType::Cpu;
    is_cpu && own.block_match == Windows::Tiles && shapes.block_match == Windows::Rows
}

/// The times of a part.
struct Measured {
    part: &'static Part,
    present: Shapes,
    /// What can be chosen in place of `present`, a race each.
    candidates: Vec<(String, Shapes)>,
    races: Races,
}

impl Measured {
    /// The winner's shapes, or the present ones.
    fn chosen(&self) -> Shapes {
        self.races.winner.map_or(self.present, |index| self.candidates[index].1)
    }

    /// The least time in milliseconds and the ratio to the default's of everything that could be chosen, in the order of the part; `None` for what
    /// there was no time to measure.
    fn rows(&self) -> Vec<Row> {
        let row = |(name, shapes): (String, Shapes)| {
            let race =
                self.candidates.iter().position(|(_, other)| *other == shapes).map(|index| &self.races.all[index]);
            let times = match race {
                Some(race) => race.least().zip(race.ratio()),
                None => (shapes == self.present).then_some((self.races.default, 1.0)),
            };
            (race.is_some() || times.is_some()).then(|| Row { name, times, is_chosen: shapes == self.chosen() })
        };
        (self.part.candidates)(self.present).into_iter().filter_map(row).collect()
    }

    fn text(&self) -> String {
        let mut text = format!("\n{:<50}{:>13}{:>15}\n", self.part.name, "ms", "of default");
        for Row { name, times, is_chosen } in self.rows() {
            let [milliseconds, ratio] = match times {
                Some((milliseconds, ratio)) => [format!("{milliseconds:.3}"), format!("{ratio:.2}")],
                None => ["-".into(), "-".into()],
            };
            let mark = if is_chosen { "  <" } else { "" };
            text += &format!("  {name:<48}{milliseconds:>13}{ratio:>15}{mark}\n");
        }
        text
    }

    fn report(&self) -> Value {
        let rows = self.rows();
        let candidate = |Row { name, times, .. }: &Row| {
            let (milliseconds, ratio) = times.unzip();
            json!({ "name": name, "ms": milliseconds, "of_default": ratio })
        };
        json!({
            "part": self.part.name,
            "preset": self.part.preset.name(),
            "candidates": rows.iter().map(candidate).collect::<Vec<_>>(),
            "chosen": rows.iter().find(|row| row.is_chosen).map(|row| &row.name),
        })
    }
}

/// A line of a part's table.
struct Row {
    name: String,
    /// Least time in milliseconds, and the median of the ratios to the default's.
    times: Option<(f64, f64)>,
    is_chosen: bool,
}
