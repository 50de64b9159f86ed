//! `hsad bench`: times of the dense presets on a device, by kernel.

mod case;
mod earlier;
mod figures;

use std::path::{Path, PathBuf};

use clap::{
    Args,
    builder::{PossibleValuesParser, TypedValueParser},
};
use hsad::{
    Error, Preset, Size,
    gpu::{DeviceChoice, Gpu, Rates, SgmPlan, block_on},
    io::atomic,
};
use serde_json::json;

pub use case::{Case, Scene};
use earlier::Earlier;

use super::{
    cache::tuned,
    demo,
    output::{check_tables, write_json},
    terminal::{self, Progress},
    verify::{described, no_twins, plans, size},
};

/// Time each preset on a device, kernel by kernel
///
/// Matches the scene built into this program, enlarged or repeated to each size such that its disparities are among those that
/// are searched. Times are of dense matching alone, from two views on the device to a map on the device: no files, no seeding.
/// 'of copies' compares the bytes that a kernel reads and writes with the rate at which this device copies memory, 'of integers' the
/// operations that its equations ask for with the rate at which it adds and takes minima.
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
    /// How threads share the work of semi-global matching [default: what hsad tune has found; else lines on
    /// a CPU, lanes on a GPU]
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
        no_twins(&self.device, "hsad bench times the kernels of a device, or of a driver such as lavapipe")?;
        let cases = self.cases()?;
        let earlier = self.compare.as_deref().map(|file| Earlier::read(file, &cases)).transpose()?;
        let file = self.json.as_deref().filter(|file| *file != Path::new("-"));
        check_tables(file, self.compare.as_deref())?;
        let mut gpu = tuned(Gpu::open(&self.device)?);
        if let Some(plan) = self.plan {
            gpu = gpu.with_sgm_plan(plan);
        }
        let rates = match block_on(Rates::measure(&gpu)) {
            // Without timestamps.
            Err(Error::Unsupported(_)) => None,
            rates => Some(rates?),
        };
        let table = !self.quiet && (self.json.is_none() || file.is_some());
        let print = |text: &str| if table { terminal::print(text) } else { Ok(()) };
        let shapes = gpu.shapes();
        print(&format!("{}{shapes}\n", described(&gpu)))?;
        if let Some(Rates { copied, operations }) = rates {
            print(&format!("copies {:.1} GB/s, {:.1} billion integer operations/s\n", copied / 1e9, operations / 1e9))?;
        }

        let scene = demo::views()?;
        let progress = Progress::new(self.quiet);
        let mut reports = Vec::new();
        for case in cases {
            progress.begin(case.name());
            let figures = case.measure(&gpu, &scene, self.runs)?;
            progress.suspend(|| print(&figures.text(rates.as_ref(), earlier.as_ref())))?;
            reports.push(figures.report(rates.as_ref(), earlier.as_ref()));
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
                "plan": shapes.sgm.name(),
                "shapes": shapes.to_string(),
                "copied_bytes_per_s": rates.map(|rates| rates.copied),
                "integer_operations_per_s": rates.map(|rates| rates.operations),
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

    fn cases(&self) -> hsad::Result<Vec<Case>> {
        fn or<T: Copy>(given: &[T], default: &[T]) -> Vec<T> {
            if given.is_empty() { default } else { given }.to_vec()
        }
        let mut cases = Vec::new();
        for &size in &or(&self.size, &[Size::new(640, 480)]) {
            for &disparities in &or(&self.disparities, &[64]) {
                for &preset in &or(&self.preset, &[Preset::Fast, Preset::Balanced, Preset::Quality]) {
                    cases.push(Case::new(preset, size, disparities)?);
                }
            }
        }
        Ok(cases)
    }
}
