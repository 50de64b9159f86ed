//! Every kernel of a device against its CPU twin, and the twins against stored hashes: a regression suite for drivers,
//! shader compilers and these shaders.
//!
//! A [`Case`] is a kernel or a whole pipeline, a size and a seed, from which everything it is given follows; the tests
//! of single kernels build their own [`Trial`]s. Nothing here prints.

mod array;
mod bench;
pub mod blocks;
mod case;
pub mod cells;
mod dice;
pub mod goldens;
pub mod integral;
pub mod kamencay;
pub mod maps;
pub mod paths;
pub mod pipelines;
pub mod points;

pub use array::{Array, Comparison, Outliers, Tolerance, Values};
pub use bench::Bench;
pub use case::{Case, MAX_SIDE, Outcome, Subject, Trial, compare};
pub use dice::{Dice, Size, smooth_noise};

use crate::{
    error::{Error, Result},
    gpu::{DeviceChoice, Gpu},
};

/// Sizes that divide by nothing, that are smaller than any filter, that are all edge.
pub const SIZES: [Size; 8] = [(1, 1), (1, 67), (70, 1), (17, 13), (5, 700), (64, 48), (130, 131), (311, 239)];

/// Those of them for what compiles many kernels for each, which software drivers take seconds for.
const PIPELINE_SIZES: [Size; 4] = [(1, 1), (17, 13), (130, 131), (311, 239)];

/// Large enough for every kernel to have something to do.
const QUICK_SIZE: Size = (131, 67);

/// How much is verified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Everything once.
    Quick,
    /// Everything at all [`SIZES`].
    Full,
}

/// Everything that is verified, kernels first.
pub fn subjects() -> impl Iterator<Item = &'static Subject> {
    let groups =
        [integral::SUBJECTS, points::SUBJECTS, blocks::SUBJECTS, cells::SUBJECTS, paths::SUBJECTS, maps::SUBJECTS];
    groups.into_iter().chain([kamencay::SUBJECTS, pipelines::SUBJECTS]).flatten()
}

/// The cases that are verified if none is named.
pub fn cases(extent: Extent) -> Vec<Case> {
    let of_subject = |subject: &'static Subject| -> Vec<Case> {
        match extent {
            Extent::Quick => vec![Case { subject, size: QUICK_SIZE, seed: 1 }],
            Extent::Full => {
                let sizes = (1..).zip(SIZES).filter(|(_, size)| !subject.is_pipeline || PIPELINE_SIZES.contains(size));
                sizes.map(|(seed, size)| Case { subject, size, seed }).collect()
            }
        }
    };
    subjects().flat_map(of_subject).collect()
}

/// Refuses a device on which any kernel fails, at one size. `choice` is what it was opened by, for the command that
/// repeats the failure.
///
/// # Errors
/// [`Error::WrongResults`].
pub fn self_test(gpu: &Gpu, choice: &DeviceChoice) -> Result<()> {
    let bench = Bench::new(gpu);
    for case in cases(Extent::Quick) {
        if let Some(fault) = case.run(&bench).faults.into_iter().next() {
            let what = format!("{}: {fault}", case.subject.name);
            return Err(Error::WrongResults { device: gpu.info().name, what, command: case.command(choice) });
        }
    }
    Ok(())
}
