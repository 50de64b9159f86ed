//! The input views of a matcher.

use crate::{gpu::Dispatch, luma::Input};

/// Left and right view bound to a [`super::Matcher`]: see [`super::Matcher::inputs`].
#[derive(Debug)]
pub struct Inputs {
    pub(super) views: [Input; 2],
    /// The conversion of the reference view's colours, if they matter and the view has some.
    pub(super) colours: Option<Vec<Dispatch>>,
    /// First luma buffer of the matcher that the inputs were prepared for.
    pub(super) matcher: wgpu::Buffer,
}

impl Inputs {
    /// Panics unless the inputs were prepared for the matcher whose first buffer is `matcher`.
    pub(super) fn assert_of(&self, matcher: &wgpu::Buffer) {
        assert!(self.matcher == *matcher, "inputs of another matcher: use this matcher's `inputs`");
    }
}
