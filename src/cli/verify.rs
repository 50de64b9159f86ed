//! `hsad verify`: a device held against the CPU twins.

use std::{
    fmt::Write as _,
    fs,
    io::{self, Write as _},
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use anyhow::{anyhow, bail};
use clap::Args;
use hsad::{
    Error,
    gpu::{DeviceChoice, Gpu},
    io::atomic,
    verify::{Array, Bench, Case, Comparison, Extent, Outcome, SIZES, Size, Tolerance, cases},
};
use serde_json::{Value, json};

use super::{
    output::{Output, check_writable, write_json},
    terminal::{self, Progress},
};

/// Hold every kernel on a device against its CPU twin
///
/// Runs each kernel, and the whole pipelines, on inputs that follow from a seed, at sizes that divide by nothing; compares
/// with what the CPU twins compute, bit for bit where the arithmetic is in integers, and the twins with hashes that are
/// part of this program. What fails is left in a folder, with the command that repeats it alone.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad verify
  hsad verify --quick --device 1
  hsad verify --json report.json -o failures
  hsad verify --only block_match --size 311x239 --seed 2

Exit codes: 0 nothing fails, 1 something does, 2 usage")]
pub struct Verify {
    /// The device: best, or index or part of the name (see hsad devices)
    #[arg(long, default_value = "best")]
    device: DeviceChoice,
    /// One size instead of all
    #[arg(long)]
    quick: bool,
    /// Only this kernel or pipeline; can be given more than once
    #[arg(long, value_name = "KERNEL")]
    only: Vec<String>,
    /// Only pictures of this size
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<Size>,
    /// What the inputs follow from
    #[arg(long, value_name = "S")]
    seed: Option<u32>,
    /// Write everything about every case to this file, or to stdout (-) instead of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Folder for what fails: inputs, expected and actual results
    #[arg(short, long, value_name = "DIR", default_value = "hsad-verify")]
    output: PathBuf,
    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

/// A size as people write it.
fn size(text: &str) -> Result<Size, String> {
    let sides =
        text.split_once(['x', 'X']).and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    sides.ok_or_else(|| "a size is width and height in pixels, as in 311x239".into())
}

impl Verify {
    /// Runs all cases, prints them as they come, and leaves what fails.
    pub fn run(self) -> anyhow::Result<()> {
        let cases = self.cases()?;
        // An empty folder goes again.
        let folder = Output::open(&self.output)?;
        let json_file = self.json.as_deref().filter(|file| *file != Path::new("-"));
        json_file.map(check_writable).transpose()?;
        let gpu = Gpu::open(&self.device)?;
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
                let written = write_failure(folder.folder(), &device, &outcome, &case.command(&self.device));
                unsaved.extend(written.err());
            }
            reports.push(self.report(&outcome));
            if outcome.lost {
                break;
            }
        }
        drop(progress);
        let (ran, seconds) = (reports.len(), start.elapsed());
        if let Some(path) = &self.json {
            let report = json!({
                "version": env!("CARGO_PKG_VERSION"),
                "device": {
                    "name": gpu.info.name,
                    "backend": gpu.info.backend.to_string(),
                    "driver": format!("{} {}", gpu.info.driver, gpu.info.driver_info),
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
            terminal::error(&anyhow!("what failed was not kept: {error}"));
        }
        if faults > 0 {
            let lost = if ran < cases.len() { "; the device is lost, and the rest was not run" } else { "" };
            bail!("{faults} of {ran} cases fail on {}{lost}: see {}", gpu.info.name, self.output.display());
        }
        print(&format!("all {ran} cases pass, in {}\n", time(seconds)))?;
        Ok(())
    }

    /// What is to be run.
    fn cases(&self) -> hsad::Result<Vec<Case>> {
        // Names and the size are checked before anything is opened.
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
            // All planned sizes have become one.
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
            "width": case.size.0,
            "height": case.size.1,
            "seed": case.seed,
            "parameters": parameters,
            "arrays": comparisons.iter().map(array).collect::<Vec<_>>(),
            "golden": golden,
            "seconds": { "device": device_time.as_secs_f64(), "twin": twin_time.as_secs_f64() },
            "passes": outcome.passes(),
            "faults": faults,
            "command": case.command(&self.device),
        })
    }
}

/// The device and its driver.
fn described(gpu: &Gpu) -> String {
    let info = &gpu.info;
    format!("{} ({}, {} {})\n", info.name, info.backend, info.driver, info.driver_info)
}

/// What the table's columns are.
fn head() -> String {
    let [kernel, size, seed, difference] = ["kernel", "size", "seed", "difference"];
    let [tolerance, golden, device, twin] = ["tolerance", "golden", "device", "twin"];
    format!("{kernel:<17}{size:<9}{seed:>4}  {difference:<20}{tolerance:<26}{golden:<7}{device:>9}{twin:>10}\n")
}

/// What people read of a case: of its arrays the one that is nearest to its tolerance or furthest beyond.
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
    let (width, height) = case.size;
    let mut text = format!(
        "{:<17}{:<9}{:>4}  {difference:<20}{tolerance:<26}{:<7}{:>9}{:>10}\n",
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

/// Leaves all arrays of a case in a folder of its own, with a text that says what they are, and nothing that an earlier
/// run left there.
fn write_failure(folder: &Path, device: &str, outcome: &Outcome, command: &str) -> hsad::Result<()> {
    let Outcome { case, parameters, faults, input, expected, actual, .. } = outcome;
    let (width, height) = case.size;
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

/// What the files of arrays begin with.
const KINDS: [&str; 3] = ["input", "expected", "actual"];

/// The file that says what the others are.
const TEXT: &str = "case.txt";

/// Removes what [`write_failure`] has left in a folder, and no other file.
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
            case: Case::new("pad", (17, 13), 5).unwrap(),
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
        let write_failure = || write_failure(folder.path(), "a device\n", &outcome, &outcome.case.command(&DeviceChoice::Best));
        let left = folder.path().join("pad-17x13-5");
        // Of an earlier run, and of someone else.
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
        assert_eq!(size("311x239"), Ok((311, 239)));
        for text in ["311", "311x", "x9", "1x2x3", "-1x2", "axb", ""] {
            assert!(size(text).is_err(), "{text}");
        }
    }
}
