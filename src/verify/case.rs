//! One kernel at one size, with inputs drawn from a seed: run, compared, timed.

use std::time::{Duration, Instant};

use super::{
    array::{Array, Comparison},
    bench::Bench,
    dice::Dice,
    golden_hash,
    trial::{Subject, Trial},
    trials::subjects,
};
use crate::{
    error::{Error, Result},
    gpu::DeviceChoice,
    image::Size,
};

/// Compares the outputs of a device with those of the twins.
///
/// # Errors
/// The errors of either.
pub fn compare(trial: &dyn Trial, bench: &Bench<'_>) -> Result<Vec<Comparison>> {
    let expected = trial.twin()?;
    let actual = bench.guarded("a kernel", || trial.on_device(bench))?;
    Ok(comparisons(&actual, &expected))
}

fn comparisons(actual: &[Array], expected: &[Array]) -> Vec<Comparison> {
    assert_eq!(actual.len(), expected.len(), "device and twin are written to leave as many arrays");
    actual.iter().zip(expected).map(|(actual, expected)| Comparison::new(actual, expected)).collect()
}

/// The longest side of a case's picture, in pixels.
pub const MAX_SIDE: u32 = 4096;

/// A subject with a size and a seed, which determine all inputs.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The subject verified.
    pub subject: &'static Subject,
    /// Size of the picture, in pixels.
    pub size: Size,
    /// Seed of the inputs.
    pub seed: u32,
}

impl Case {
    /// The case of the subject of this name.
    ///
    /// # Errors
    /// [`Error::Parameter`] with all names if `name` is unknown, or if a side is not 1 to [`MAX_SIDE`].
    pub fn new(name: &str, size: impl Into<Size>, seed: u32) -> Result<Self> {
        let size = size.into();
        if size.width.min(size.height) == 0 || size.width.max(size.height) > MAX_SIDE {
            return Err(Error::Parameter {
                name: "size",
                value: format!("{}x{}", size.width, size.height),
                expected: format!("each side must be 1 to {MAX_SIDE} px"),
            });
        }
        let subject = subjects().find(|subject| subject.name == name).ok_or_else(|| {
            let names: Vec<_> = subjects().map(|subject| subject.name).collect();
            Error::Parameter {
                name: "only",
                value: format!("'{name}'"),
                expected: format!("there are {}", names.join(", ")),
            }
        })?;
        Ok(Self { subject, size, seed })
    }

    /// Draws the trial of this case.
    pub fn trial(&self) -> Box<dyn Trial> {
        (self.subject.draw)(self.size, &mut Dice::new(self.subject.name, self.seed))
    }

    /// The command that repeats this case alone, on `device`.
    pub fn command(&self, device: &DeviceChoice) -> String {
        let Size { width, height } = self.size;
        let command = format!("hsad verify --only {} --size {width}x{height} --seed {}", self.subject.name, self.seed);
        match device {
            DeviceChoice::Named(name) => format!("{command} --device {}", quoted(name)),
            DeviceChoice::Best | DeviceChoice::Cpu => command,
        }
    }

    /// Runs the case on a device and on the CPU.
    pub fn run(&self, bench: &Bench<'_>) -> Outcome {
        let trial = self.trial();
        let start = Instant::now();
        let expected = trial.twin();
        let twin_time = start.elapsed();
        let start = Instant::now();
        let actual = bench.guarded(self.subject.name, || trial.on_device(bench));
        let device_time = start.elapsed();
        let mut outcome = Outcome {
            case: *self,
            parameters: trial.parameters(),
            device_time,
            twin_time,
            comparisons: Vec::new(),
            faults: Vec::new(),
            golden: false,
            lost: matches!(actual, Err(Error::DeviceLost(_))),
            input: trial.input(),
            expected: Vec::new(),
            actual: Vec::new(),
        };
        match expected {
            Ok(expected) => outcome.expected = expected,
            Err(error) => outcome.faults.push(format!("the twin: {error}")),
        }
        match actual {
            Ok(actual) => outcome.actual = actual,
            Err(error) => outcome.faults.push(error.to_string()),
        }
        if outcome.faults.is_empty() {
            outcome.comparisons = comparisons(&outcome.actual, &outcome.expected);
            outcome.faults.extend(outcome.comparisons.iter().filter_map(|comparison| comparison.fault.clone()));
        }
        let golden = golden_hash::stored(&golden_hash::key(self.subject.name, self.size, self.seed));
        if let (Some(golden), Some(hash)) = (golden, golden_hash::hash(&outcome.expected)) {
            outcome.golden = golden == hash;
            if !outcome.golden {
                outcome.faults.push(format!("the twin's hash is {hash:016x}, and {golden:016x} is stored"));
            }
        }
        outcome
    }
}

/// Quotes a word for a shell.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// The outcome of a case.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The case.
    pub case: Case,
    /// Parameters of the trial beside its arrays.
    pub parameters: String,
    /// Time on the device, with the compilation of its kernels.
    pub device_time: Duration,
    /// Time of the twins.
    pub twin_time: Duration,
    /// One comparison per array; empty if there was nothing to compare.
    pub comparisons: Vec<Comparison>,
    /// Descriptions of all faults; empty if the case passes.
    pub faults: Vec<String>,
    /// Whether a golden hash is stored for this case and equals that of the twin's exact results.
    pub golden: bool,
    /// Whether the device is lost, so that no other case can run on it.
    pub lost: bool,
    /// The input arrays.
    pub input: Vec<Array>,
    /// The twin's arrays.
    pub expected: Vec<Array>,
    /// The device's arrays.
    pub actual: Vec<Array>,
}

impl Outcome {
    /// Whether the case has no fault.
    pub fn passes(&self) -> bool {
        self.faults.is_empty()
    }
}
