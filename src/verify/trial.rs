//! A trial: one kernel or a sequence of kernels, with all inputs.

use std::fmt;

pub(super) use super::{array::Array, bench::Bench, dice::Dice};
use crate::{error::Result, image::Size};

/// A trial: one kernel or a sequence of kernels, with all inputs.
pub trait Trial {
    /// Parameters beside the input arrays, as text.
    fn parameters(&self) -> String;

    /// The input arrays.
    fn input(&self) -> Vec<Array>;

    /// The outputs of the device.
    ///
    /// # Errors
    /// The errors of the device.
    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>>;

    /// The outputs of the CPU twins.
    ///
    /// # Errors
    /// The errors that the device should report too.
    fn twin(&self) -> Result<Vec<Array>>;
}

/// A subject of verification: a kernel, named like its stage, or a whole pipeline.
pub struct Subject {
    /// Name of the subject.
    pub name: &'static str,
    /// Whether the subject runs several kernels.
    pub is_pipeline: bool,
    pub(super) draw: fn(Size, &mut Dice) -> Box<dyn Trial>,
}

impl fmt::Debug for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Subject").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Subject {
    /// A kernel; `draw` draws its trials for a picture of the given size.
    pub const fn kernel(name: &'static str, draw: fn(Size, &mut Dice) -> Box<dyn Trial>) -> Self {
        Self { name, is_pipeline: false, draw }
    }

    /// A pipeline of several kernels; `draw` draws its trials for a picture of the given size.
    pub const fn pipeline(name: &'static str, draw: fn(Size, &mut Dice) -> Box<dyn Trial>) -> Self {
        Self { name, is_pipeline: true, draw }
    }
}
