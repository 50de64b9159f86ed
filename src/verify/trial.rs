//! A kernel, or several in a row, with everything they are given.

use std::fmt;

use super::{array::Array, bench::Bench, dice::Dice};
use crate::{error::Result, image::Size};

/// A kernel, or several in a row, with everything they are given.
pub trait Trial {
    /// What is given beside arrays, for people.
    fn parameters(&self) -> String;

    /// The arrays that are given.
    fn input(&self) -> Vec<Array>;

    /// What the device leaves.
    ///
    /// # Errors
    /// What the device says.
    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>>;

    /// What the CPU twins leave.
    ///
    /// # Errors
    /// As the device should, too.
    fn twin(&self) -> Result<Vec<Array>>;
}

/// What is verified: a kernel by its stage's name, or a whole half of the pipeline.
pub struct Subject {
    /// Its name.
    pub name: &'static str,
    /// Whether it is made of several kernels.
    pub is_pipeline: bool,
    pub(super) draw: fn(Size, &mut Dice) -> Box<dyn Trial>,
}

impl fmt::Debug for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Subject").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Subject {
    /// The kernel whose trials `draw` draws for a picture of a size.
    pub const fn kernel(name: &'static str, draw: fn(Size, &mut Dice) -> Box<dyn Trial>) -> Self {
        Self { name, is_pipeline: false, draw }
    }

    /// The same of several kernels in a row.
    pub const fn pipeline(name: &'static str, draw: fn(Size, &mut Dice) -> Box<dyn Trial>) -> Self {
        Self { name, is_pipeline: true, draw }
    }
}
