//! Where a matcher's answers go.

use super::word_copy::WordCopy;
use crate::gpu::Dispatch;

/// Where the caller wants the disparities.
#[derive(Clone, Copy, Debug)]
pub enum Destination<'a> {
    /// In a buffer with `COPY_DST`: an `i32` a pixel, row by row, in 1/256 px or [`crate::disparity::NONE`].
    Buffer(&'a wgpu::Buffer),
    /// In a texture with `STORAGE_BINDING`, in the mip level that the view shows, which has the pair's size. `R32Sint`
    /// holds what a buffer does, `R32Float` pixels or [`crate::disparity::NONE_IN_PIXELS`].
    Texture(&'a wgpu::TextureView),
}

/// Where the answers go, prepared for a [`super::Matcher`]: see [`super::Matcher::outputs`].
#[derive(Debug)]
pub struct Outputs {
    pub(super) disparities: Disparities,
    pub(super) confidences: Option<wgpu::Buffer>,
    /// The first buffer of the matcher that it was made for.
    pub(super) of: wgpu::Buffer,
}

#[derive(Debug)]
pub(super) enum Disparities {
    Buffer(wgpu::Buffer),
    /// For each of the plan's answers what brings it to the texture.
    Texture(Vec<Dispatch>),
}

impl Disparities {
    /// Where they go, if not to a texture.
    pub(super) fn buffer(&self) -> Option<&wgpu::Buffer> {
        match self {
            Self::Buffer(buffer) => Some(buffer),
            Self::Texture(_) => None,
        }
    }
}

impl Outputs {
    /// Records what `copy`, the plan's answer of this `index`, is to be for the caller.
    pub(super) fn record_disparities(&self, encoder: &mut wgpu::CommandEncoder, copy: &WordCopy, index: usize) {
        match &self.disparities {
            Disparities::Buffer(to) => copy.record(encoder, to),
            Disparities::Texture(dispatches) => dispatches[index].record(encoder),
        }
    }

    /// Records a copy of confidences, if they are wanted.
    pub(super) fn record_confidences(&self, encoder: &mut wgpu::CommandEncoder, copy: &WordCopy) {
        if let Some(to) = &self.confidences {
            copy.record(encoder, to);
        }
    }
}
