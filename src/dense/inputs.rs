//! The input views of a matcher.

use crate::luma::Input;

/// Left and right view bound to a [`super::Matcher`]: see [`super::Matcher::inputs`].
#[derive(Debug)]
pub struct Inputs {
    pub(super) views: [Input; 2],
    /// First luma buffer of the matcher that the inputs were prepared for.
    pub(super) matcher: wgpu::Buffer,
}
