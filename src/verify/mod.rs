//! Every kernel of a device against its CPU twin, and the twins against stored hashes: a regression suite for drivers,
//! shader compilers and these shaders.
//!
//! A [`Case`] is a kernel or a whole pipeline, a size and a seed, from which everything it is given follows; the tests
//! of single kernels build their own [`Trial`]s. Nothing here prints.

mod array;
mod bench;
mod case;
mod dice;
mod golden_hash;
pub mod goldens;
mod trial;
#[doc(hidden)]
pub mod trials;

#[doc(hidden)]
pub use array::{Array, Values};
pub use array::{Comparison, Outliers, Tolerance};
#[doc(hidden)]
pub use bench::Bench;
#[doc(hidden)]
pub use case::compare;
pub use case::{Case, MAX_SIDE, Outcome};
#[doc(hidden)]
pub use dice::{Dice, smooth_noise};
pub use trial::Subject;
#[doc(hidden)]
pub use trial::Trial;
pub use trials::subjects;

use crate::{
    error::{Error, Result},
    gpu::{DeviceChoice, Gpu},
    image::Size,
};

/// Sizes that divide by nothing, that are smaller than any filter, that are all edge.
pub const SIZES: [Size; 8] = [
    Size::new(1, 1),
    Size::new(1, 67),
    Size::new(70, 1),
    Size::new(17, 13),
    Size::new(5, 700),
    Size::new(64, 48),
    Size::new(130, 131),
    Size::new(311, 239),
];

/// Those of them for what compiles many kernels for each, which software drivers take seconds for.
const PIPELINE_SIZES: [Size; 4] = [Size::new(1, 1), Size::new(17, 13), Size::new(130, 131), Size::new(311, 239)];

/// Large enough for every kernel to have something to do.
const QUICK_SIZE: Size = Size::new(131, 67);

/// How much is verified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Everything once.
    Quick,
    /// Everything at all [`SIZES`].
    Full,
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
