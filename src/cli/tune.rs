//! `hsad tune`: the fastest kernels for a device, by measuring.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use clap::Args;
use hsad::{
    Gpu, Preset, Size,
    gpu::{DeviceChoice, Exchange, SgmPlan, Shapes, ShapesFile, Windows, cache_folder},
    io::atomic,
    wgpu::DeviceType,
};
use serde_json::{Value, json};

use super::{
    bench::{Case, Scene, least_times},
    demo,
    output::{check_writable, write_json},
    terminal::{self, Progress},
    verify::{described, no_twins, size},
};

/// Find the fastest kernels for a device, and keep the choice
///
/// Some stages have several kernels with the same result, to the bit, of which one is fastest on one device and another on another.
/// They are timed at the given size, and the choice is kept in the user's cache folder, for this device and its driver: match,
/// demo, eval, verify and bench take it from then on.
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
    /// Runs of each kernel, of which the fastest counts, 1 to 10000
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    /// Forget the choice for the device instead
    #[arg(long, conflicts_with_all = ["size", "disparities", "runs", "json"])]
    forget: bool,
    /// Write the times to this file as JSON, or to stdout (-) instead of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

/// Stages that are chosen for together.
struct Part {
    name: &'static str,
    /// The stages, by the names of their kernels without `lane_` and `tile_`.
    stages: &'static [&'static str],
    /// The preset that runs them.
    preset: Preset,
    /// What can be chosen, from the choice so far: the name of each, and the shapes.
    candidates: fn(Shapes) -> Vec<(String, Shapes)>,
}

const PARTS: [Part; 5] = [
    Part {
        name: "semi-global matching",
        stages: &["cost", "path", "select"],
        preset: Preset::Balanced,
        candidates: |shapes| {
            let lines = ("lines".into(), Shapes { sgm: SgmPlan::Lines, ..shapes });
            let mut candidates = vec![lines];
            for lane_disparities in Shapes::LANE_DISPARITIES {
                for lane_threads in Shapes::LANE_THREADS {
                    for exchange in Exchange::ALL {
                        let name = format!("lanes, {lane_disparities} disparities, {lane_threads} threads, {exchange}");
                        let lanes = Shapes { sgm: SgmPlan::Lanes, lane_disparities, lane_threads, exchange, ..shapes };
                        candidates.push((name, lanes));
                    }
                }
            }
            candidates
        },
    },
    Part {
        name: "block matching",
        stages: &["block_match"],
        preset: Preset::Fast,
        candidates: |shapes| windows(|block_match| Shapes { block_match, ..shapes }),
    },
    Part {
        name: "census",
        stages: &["census"],
        preset: Preset::Balanced,
        candidates: |shapes| windows(|census| Shapes { census, ..shapes }),
    },
    Part {
        name: "support",
        stages: &["support"],
        preset: Preset::Balanced,
        candidates: |shapes| windows(|support| Shapes { support, ..shapes }),
    },
    Part {
        name: "weighted median",
        stages: &["weighted_median"],
        preset: Preset::Balanced,
        candidates: |shapes| windows(|weighted_median| Shapes { weighted_median, ..shapes }),
    },
];

/// Another candidate takes the place of the present one if it takes at most this share of the time: less is noise.
const CLEARLY_FASTER: f64 = 0.97;

fn windows(of: impl Fn(Windows) -> Shapes) -> Vec<(String, Shapes)> {
    Windows::ALL.map(|windows| (windows.to_string(), of(windows))).into()
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
        let mut reports = Vec::new();
        for part in &PARTS {
            let measured = self.measure(part, (&gpu, shapes), &scene, &progress)?;
            shapes = measured.chosen();
            progress.suspend(|| print(&measured.text()))?;
            reports.push(measured.report());
        }
        drop(progress);
        kept.write(shapes)?;
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
    ) -> anyhow::Result<Measured> {
        let case = Case::new(part.preset, self.size, self.disparities)?;
        let mut times = Vec::new();
        for (name, shapes) in (part.candidates)(present) {
            if takes_minutes(gpu, &shapes) {
                continue;
            }
            progress.begin(format!("{}: {name}", part.name));
            let matcher = case.matcher(&gpu.clone().with_shapes(shapes), scene)?;
            // The first run compiles.
            matcher.run()?;
            let kernels = least_times(&matcher, self.runs)?;
            let kernels =
                kernels.ok_or_else(|| anyhow!("the device tells no times of kernels: it has no timestamps"))?;
            let is_of_part = |kernel: &str| {
                let stage = ["lane_", "tile_"].iter().find_map(|shape| kernel.strip_prefix(shape)).unwrap_or(kernel);
                part.stages.contains(&stage)
            };
            let sum: f64 =
                kernels.iter().filter(|(kernel, _)| is_of_part(kernel)).map(|(_, time)| time.as_secs_f64()).sum();
            times.push(Time { name, shapes, milliseconds: 1e3 * sum });
        }
        Ok(Measured { part, present, times })
    }
}

/// Whether a driver takes minutes to compile the kernels of `shapes`: that of a CPU whose own shapes have no windows in registers.
fn takes_minutes(gpu: &Gpu, shapes: &Shapes) -> bool {
    let own = gpu.shapes();
    let is_cpu = gpu.info().device_type == DeviceType::Cpu;
    is_cpu && own.block_match == Windows::Tiles && shapes.block_match == Windows::Rows
}

/// A candidate and its time.
struct Time {
    name: String,
    shapes: Shapes,
    milliseconds: f64,
}

/// The times of a part.
struct Measured {
    part: &'static Part,
    present: Shapes,
    times: Vec<Time>,
}

impl Measured {
    /// The fastest candidate; the present one, if no other is clearly faster.
    fn chosen(&self) -> Shapes {
        let present = self.times.iter().find(|time| time.shapes == self.present);
        let fastest = self.times.iter().min_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
        let is_clearly_faster = |fastest: &&Time| {
            present.is_none_or(|present| fastest.milliseconds <= CLEARLY_FASTER * present.milliseconds)
        };
        fastest.filter(is_clearly_faster).map_or(self.present, |fastest| fastest.shapes)
    }

    fn text(&self) -> String {
        let mut text = format!("\n{}\n", self.part.name);
        for Time { name, shapes, milliseconds } in &self.times {
            let mark = if *shapes == self.chosen() { "  <" } else { "" };
            text += &format!("  {name:<50}{milliseconds:>10.3} ms{mark}\n");
        }
        text
    }

    fn report(&self) -> Value {
        let time = |time: &Time| json!({ "name": time.name, "ms": time.milliseconds });
        json!({
            "part": self.part.name,
            "preset": self.part.preset.name(),
            "candidates": self.times.iter().map(time).collect::<Vec<_>>(),
            "chosen": self.times.iter().find(|time| time.shapes == self.chosen()).map(|time| &time.name),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_candidate_must_be_clearly_faster() {
        let present: Shapes =
            "sgm=lines lane_disparities=8 lane_threads=64 exchange=memory block_match=rows census=rows support=rows \
             weighted_median=rows"
                .parse()
                .expect("shapes");
        let measured = |lines, lanes| {
            let times = (PARTS[0].candidates)(present).into_iter().map(|(name, shapes)| {
                let milliseconds = if shapes.sgm == SgmPlan::Lines { lines } else { lanes };
                Time { name, shapes, milliseconds }
            });
            Measured { part: &PARTS[0], present, times: times.collect() }
        };
        assert_eq!(measured(10.0, 9.9).chosen(), present);
        assert_eq!(measured(10.0, 9.0).chosen().sgm, SgmPlan::Lanes);
        assert_eq!(measured(10.0, 90.0).chosen(), present);
    }
}
