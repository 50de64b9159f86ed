//! Every kernel of a device against its CPU twin, and the twins against stored hashes: a regression suite for drivers,
//! shader compilers and these shaders.
//!
//! A [`Case`] is a kernel or a whole pipeline, a size and a seed, which determine all its inputs. Tests of single
//! kernels build their own [`Trial`]s. This module prints nothing.

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

/// Sizes of cases: sizes without common divisors, smaller than any filter, or with nothing but edges.
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

/// Sizes of pipelines, which compile many kernels each: software drivers take seconds for that.
const PIPELINE_SIZES: [Size; 4] = [Size::new(1, 1), Size::new(17, 13), Size::new(130, 131), Size::new(311, 239)];

/// The size of [`Extent::Quick`], large enough to exercise every kernel.
const QUICK_SIZE: Size = Size::new(131, 67);

/// The extent of verification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Every subject at one size.
    Quick,
    /// Every subject at all [`SIZES`].
    Full,
}

/// The cases verified by default.
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

/// Verifies all subjects on a device, at one size. `choice` is the choice by which the device was opened, for the
/// command that repeats a failure.
///
/// # Errors
/// [`Error::WrongResults`] if any case fails.
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
