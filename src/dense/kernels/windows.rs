//! The texts of a kernel, one per place where threads keep the windows of their pixels: see [`crate::gpu::Windows`].

use super::rows_per_thread::ROWS_SOFTWARE;
use crate::gpu::{Binding, Stage};

/// The text of a kernel for one way to keep windows.
pub(super) struct Text {
    pub(super) name: &'static str,
    pub(super) source: &'static str,
    /// Threads per workgroup along x and y.
    pub(super) workgroup: [u32; 2],
    /// Pixels per thread along x and y.
    pub(super) pixels: [u32; 2],
    /// Constants of this text alone, besides the workgroup's size.
    pub(super) constants: Vec<(&'static str, i64)>,
}

impl Text {
    /// A text for [`crate::gpu::Windows::Rows`].
    pub(super) fn rows(name: &'static str, source: &'static str, mut constants: Vec<(&'static str, i64)>) -> Self {
        constants.push(("ROWS", ROWS_SOFTWARE.into()));
        Self { name, source, workgroup: [16, 4], pixels: [4, ROWS_SOFTWARE], constants }
    }

    /// Pixels per workgroup along x and y.
    pub(super) fn tile(&self) -> [u32; 2] {
        [self.workgroup[0] * self.pixels[0], self.workgroup[1] * self.pixels[1]]
    }

    /// The stage, with the constants that both texts have.
    pub(super) fn stage(self, bindings: &'static [Binding], constants: Vec<(&'static str, i64)>) -> Stage {
        let [width, height] = self.workgroup.map(i64::from);
        let size = [("WORKGROUP_WIDTH", width), ("WORKGROUP_HEIGHT", height)];
        let constants = size.into_iter().chain(self.constants).chain(constants).collect();
        Stage { name: self.name, source: self.source, bindings, constants }
    }
}
