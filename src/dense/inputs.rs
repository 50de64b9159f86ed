//! The views that a matcher matches.

use crate::luma::Input;

/// Left and right view on their way into a [`super::Matcher`]: see [`super::Matcher::inputs`].
#[derive(Debug)]
pub struct Inputs(pub(super) [Input; 2]);

impl Inputs {
    /// Records the conversion of both views to the matcher's packed luma.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.0.iter().for_each(|view| view.record(encoder));
    }
}
