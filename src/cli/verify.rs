//! `hsad verify`: compares the results of a device with those of the CPU twins.

use std::{
    fmt::Write as _,
    fs,
    io::{self, Write as _},
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use anyhow::{anyhow, bail};
use clap::{
    Args,
    builder::{PossibleValuesParser, TypedValueParser},
};
use hsad::{
    Error,
    gpu::{DeviceChoice, Gpu, SgmPlan},
    image::Size,
    io::atomic,
    verify::{Array, Bench, Case, Comparison, Extent, Outcome, SIZES, Tolerance, cases},
};
use serde_json::{Value, json};

use super::{
    cache::tuned,
    output::{Output, check_writable, write_json},
    terminal::{self, Progress},
};

/// Compare every kernel on a device with its CPU twin
///
/// Runs each kernel and the whole pipelines on inputs drawn from a seed, at odd sizes; compares the results with those
/// of the CPU twins, bit for bit where the arithmetic is in integers, and the twins with hashes stored in this program.
/// The arrays of a failed case are written to a folder, with the command that repeats the case alone.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad verify
  hsad verify --quick --device 1
  hsad verify --json report.json -o failures
  hsad verify --only block_match --size 311x239 --seed 2

Exit codes: 0 all cases pass, 1 a case fails, 2 usage")]
pub struct Verify {
    /// Device to verify: best, or the index or a part of the name of a device (see hsad devices)
    #[arg(long, default_value_t = DeviceChoice::Best)]
    device: DeviceChoice,
    /// How threads share the work of semi-global matching: a thread per line, or threads across disparities [default:
    /// lines on a CPU, lanes on a GPU]
    #[arg(long, value_parser = plans())]
    plan: Option<SgmPlan>,
    /// Verify at one size (131x67) instead of all
    #[arg(long)]
    quick: bool,
    /// Verify only this kernel or pipeline; repeatable [default: all]
    #[arg(long, value_name = "KERNEL")]
    only: Vec<String>,
    /// Verify only at this picture size in pixels, each side 1 to 4096 [default: 8 sizes, up to 5x700 and 311x239]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<Size>,
    /// Seed of the inputs, 0 to 4294967295 [default: another seed for each size, from 1]
    #[arg(long, value_name = "S")]
    seed: Option<u32>,
    /// Write the details of every case to this file as JSON, or to stdout (-) instead of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Folder for the inputs, expected and actual results of failed cases
    #[arg(short, long, value_name = "DIR", default_value = "hsad-verify")]
    output: PathBuf,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

/// The names of plans.
pub(super) fn plans() -> impl TypedValueParser<Value = SgmPlan> {
    PossibleValuesParser::new(SgmPlan::ALL.map(SgmPlan::name)).map(|name| name.parse().expect("one of the names above"))
}

/// Parses `WIDTHxHEIGHT`.
pub(super) fn size(text: &str) -> Result<Size, String> {
    let sides =
        text.split_once(['x', 'X']).and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    sides.map(Size::from).ok_or_else(|| "expected WIDTHxHEIGHT in pixels, as in 311x239".into())
}

/// Refuses the CPU twins for work that only a device can do; `what` says what they are for.
pub fn no_twins(device: &DeviceChoice, what: &str) -> anyhow::Result<()> {
    if *device == DeviceChoice::Cpu {
        bail!("the CPU twins are no GPU: {what}; name one of the devices that hsad devices lists");
    }
    Ok(())
}

impl Verify {
    /// The command that repeats `case` alone.
    fn command(&self, case: &Case) -> String {
        let plan = self.plan.map_or(String::new(), |plan| format!(" --plan {plan}"));
        case.command(&self.device) + &plan
    }

    /// Runs all cases, prints one row per case, and writes the arrays of failed cases.
    pub fn run(self) -> anyhow::Result<()> {
        no_twins(&self.device, "they are what hsad verify compares a device with, or a driver such as lavapipe")?;
        let cases = self.cases()?;
        // A folder that stays empty is removed again when `folder` is dropped.
        let folder = Output::open(&self.output)?;
        let json_file = self.json.as_deref().filter(|file| *file != Path::new("-"));
        json_file.map(check_writable).transpose()?;
        let mut gpu = tuned(Gpu::open(&self.device)?);
        if let Some(plan) = self.plan {
            gpu = gpu.with_sgm_plan(plan);
        }
        let table = !self.quiet && self.json.as_deref() != Some(Path::new("-"));
        let print = |text: &str| if table { terminal::print(text) } else { Ok(()) };
        let device = described(&gpu);
        print(&(device.clone() + &head()))?;

        let start = Instant::now();
        let progress = Progress::new(self.quiet);
        let (mut reports, mut faults, mut unsaved) = (Vec::new(), 0, Vec::new());
        for case in &cases {
            progress.begin(case.subject.name);
            let outcome = case.run(&Bench::new(&gpu));
            progress.suspend(|| print(&row(&outcome)))?;
            if !outcome.passes() {
                faults += 1;
                let written = write_failure(folder.folder(), &device, &outcome, &self.command(case));
                unsaved.extend(written.err());
            }
            reports.push(self.report(&outcome));
            if outcome.lost {
                break;
            }
        }
        drop(progress);
        let (ran, seconds) = (reports.len(), start.elapsed());
        let info = gpu.info();
        if let Some(path) = &self.json {
            let report = json!({
                "version": env!("CARGO_PKG_VERSION"),
                "device": {
                    "name": info.name,
                    "backend": info.backend.to_string(),
                    "driver": format!("{} {}", info.driver, info.driver_info),
                },
                "seconds": seconds.as_secs_f64(),
                "planned": cases.len(),
                "failed": faults,
                "cases": reports,
            });
            if json_file.is_some() {
                atomic::write_whole(path, |out| write_json(out, &report))?;
            } else {
                terminal::print(&format!("{report:#}\n"))?;
            }
        }
        for error in unsaved {
            terminal::error(&anyhow!("the arrays of a failed case were not written: {error}"));
        }
        if faults > 0 {
            let lost =
                if ran < cases.len() { "; the device was lost, and the remaining cases were not run" } else { "" };
            bail!("{faults} of {ran} cases fail on {}{lost}: see {}", info.name, hsad::shown(&self.output));
        }
        let passed = if ran == 1 { "the case passes".into() } else { format!("all {ran} cases pass") };
        print(&format!("{passed}, in {}\n", time(seconds)))?;
        Ok(())
    }

    /// The cases to run, after `--quick`, `--only`, `--size` and `--seed`.
    fn cases(&self) -> hsad::Result<Vec<Case>> {
        // Names and size are checked before the device is opened.
        let named = |name: &String| Case::new(name, self.size.unwrap_or(SIZES[0]), 1);
        let names: Vec<&str> =
            self.only.iter().map(|name| Ok(named(name)?.subject.name)).collect::<hsad::Result<_>>()?;
        let planned = cases(if self.quick { Extent::Quick } else { Extent::Full });
        let mut cases = Vec::new();
        for case in planned {
            if !names.is_empty() && !names.contains(&case.subject.name) {
                continue;
            }
            let size = self.size.unwrap_or(case.size);
            cases.push(Case::new(case.subject.name, size, self.seed.unwrap_or(case.seed))?);
        }
        if self.size.is_some() {
            // With one size for all, cases of one subject and seed are equal.
            cases.dedup_by_key(|case| (case.subject.name, case.seed));
        }
        Ok(cases)
    }

    fn report(&self, outcome: &Outcome) -> Value {
        let Outcome { case, parameters, device_time, twin_time, comparisons, faults, golden, .. } = outcome;
        let array = |comparison: &Comparison| {
            let Comparison { name, tolerance, count, off, largest, .. } = comparison;
            json!({ "name": name, "tolerance": tolerance.text(), "values": count, "off": off, "largest": largest })
        };
        json!({
            "kernel": case.subject.name,
            "width": case.size.width,
            "height": case.size.height,
            "seed": case.seed,
            "parameters": parameters,
            "arrays": comparisons.iter().map(array).collect::<Vec<_>>(),
            "golden": golden,
            "seconds": { "device": device_time.as_secs_f64(), "twin": twin_time.as_secs_f64() },
            "passes": outcome.passes(),
            "faults": faults,
            "command": self.command(case),
        })
    }
}

/// Name, graphics interface and driver of the device, one line.
pub(super) fn described(gpu: &Gpu) -> String {
    let info = gpu.info();
    format!("{} ({}, {} {})\n", info.name, info.backend, info.driver, info.driver_info)
}

/// Header row of the table.
fn head() -> String {
    let [kernel, size, seed, difference] = ["kernel", "size", "seed", "difference"];
    let [tolerance, golden, device, twin] = ["tolerance", "golden", "device", "twin"];
    format!("{kernel:<21}{size:<9}{seed:>4}  {difference:<20}{tolerance:<26}{golden:<7}{device:>9}{twin:>10}\n")
}

/// Table row of a case: shows the array whose difference is largest relative to its tolerance.
fn row(outcome: &Outcome) -> String {
    let Outcome { case, comparisons, faults, golden, device_time, twin_time, .. } = outcome;
    let strain = |comparison: &&Comparison| match comparison.tolerance {
        Tolerance::Exact => comparison.largest,
        Tolerance::Within { difference, .. } => comparison.largest / f64::from(difference),
    };
    let worst = comparisons.iter().max_by(|a, b| strain(a).total_cmp(&strain(b)));
    let (difference, tolerance) = match worst {
        None => ("?".into(), String::new()),
        Some(worst) => {
            let off = if worst.off > 0 { format!(" ({} off)", worst.off) } else { String::new() };
            let largest = if worst.largest == 0.0 { "none".into() } else { format!("{:.3e}", worst.largest) };
            (largest + &off, worst.tolerance.text())
        }
    };
    let Size { width, height } = case.size;
    let mut text = format!(
        "{:<21}{:<9}{:>4}  {difference:<20}{tolerance:<26}{:<7}{:>9}{:>10}\n",
        case.subject.name,
        format!("{width}x{height}"),
        case.seed,
        if *golden { "same" } else { "" },
        time(*device_time),
        time(*twin_time)
    );
    for fault in faults {
        let _ = writeln!(text, "  FAILS: {fault}");
    }
    text
}

fn time(time: Duration) -> String {
    match time.as_secs_f64() {
        seconds if seconds < 1.0 => format!("{:.1} ms", 1e3 * seconds),
        seconds => format!("{seconds:.2} s"),
    }
}

/// Writes all arrays of a case to a folder of its own, with `case.txt` that describes them; removes the arrays of an
/// earlier run first.
fn write_failure(folder: &Path, device: &str, outcome: &Outcome, command: &str) -> hsad::Result<()> {
    let Outcome { case, parameters, faults, input, expected, actual, .. } = outcome;
    let Size { width, height } = case.size;
    let folder = folder.join(format!("{}-{width}x{height}-{}", case.subject.name, case.seed));
    let failed = |source| Error::Io { path: folder.clone(), source };
    fs::create_dir_all(&folder).and_then(|()| remove_old_arrays(&folder)).map_err(failed)?;
    let mut text = format!("{command}\n\n{device}{parameters}\n");
    faults.iter().for_each(|fault| text += &format!("{fault}\n"));
    text += "\nfile, number of values, type; all values have their lowest byte first\n";
    for (kind, arrays) in KINDS.into_iter().zip([input, expected, actual]) {
        for Array { name, values, .. } in arrays {
            let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
            let file = format!("{kind}-{}.{}", words.join("-"), values.kind());
            atomic::write_whole(&folder.join(&file), |out| out.write_all(&values.to_le_bytes()))?;
            text += &format!("{file} {} {}\n", values.len(), values.kind());
        }
    }
    atomic::write_whole(&folder.join(TEXT), |out| out.write_all(text.as_bytes()))
}

/// Prefixes of the array files.
const KINDS: [&str; 3] = ["input", "expected", "actual"];

/// The file that describes the array files.
const TEXT: &str = "case.txt";

/// Removes the files that [`write_failure`] wrote to a folder, and no others.
fn remove_old_arrays(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let of_array = || KINDS.iter().any(|kind| name.strip_prefix(kind).is_some_and(|rest| rest.starts_with('-')));
        if name == TEXT || of_array() {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failed() -> Outcome {
        let words = |values: &[u32]| Array::exact("some words, two", values.to_vec());
        let (actual, expected) = (words(&[1, 3]), words(&[1, 2]));
        let comparison = Comparison::new(&actual, &expected);
        Outcome {
            case: Case::new("pad", Size::new(17, 13), 5).unwrap(),
            parameters: "just so".into(),
            device_time: Duration::from_millis(2),
            twin_time: Duration::from_secs(1),
            faults: comparison.fault.clone().into_iter().collect(),
            comparisons: vec![comparison],
            golden: true,
            lost: false,
            input: Vec::new(),
            expected: vec![expected],
            actual: vec![actual],
        }
    }

    #[test]
    fn a_failure_is_seen_and_left() {
        let outcome = failed();
        let row = row(&outcome);
        assert!(row.contains("1.000e0 (1 off)"), "{row}");
        assert!(row.ends_with("\n  FAILS: some words, two: value 1 is 3, not 2; 1 are off\n"), "{row}");
        let folder = tempfile::tempdir().unwrap();
        let write_failure =
            || write_failure(folder.path(), "a device\n", &outcome, &outcome.case.command(&DeviceChoice::Best));
        let left = folder.path().join("pad-17x13-5");
        // A file of an earlier run, and a file of someone else.
        fs::create_dir(&left).unwrap();
        fs::write(left.join("actual-another.i32"), "old").unwrap();
        fs::write(left.join("notes.txt"), "mine").unwrap();
        write_failure().unwrap();
        let mut names: Vec<_> = fs::read_dir(&left).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        let expected = ["actual-some-words-two.u32", "case.txt", "expected-some-words-two.u32", "notes.txt"];
        assert_eq!(names, expected);
        assert_eq!(fs::read(left.join("actual-some-words-two.u32")).unwrap(), [1, 0, 0, 0, 3, 0, 0, 0]);
        assert_eq!(fs::read(left.join("expected-some-words-two.u32")).unwrap(), [1, 0, 0, 0, 2, 0, 0, 0]);
        let text = fs::read_to_string(left.join("case.txt")).unwrap();
        assert!(text.starts_with("hsad verify --only pad --size 17x13 --seed 5\n\na device\njust so\n"), "{text}");
        assert!(text.contains("value 1 is 3") && text.contains("\nactual-some-words-two.u32 2 u32\n"), "{text}");
    }

    #[test]
    fn sizes_are_width_and_height() {
        assert_eq!(size("311x239"), Ok(Size::new(311, 239)));
        for text in ["311", "311x", "x9", "1x2x3", "-1x2", "axb", ""] {
            assert!(size(text).is_err(), "{text}");
        }
    }
}
