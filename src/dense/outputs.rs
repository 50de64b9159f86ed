//! The destinations of a matcher's results.

use super::word_copy::WordCopy;
use crate::gpu::Dispatch;

/// Destination of the disparities.
#[derive(Clone, Copy, Debug)]
pub enum Destination<'a> {
    /// A buffer with `COPY_DST`: one `i32` per pixel, row by row, in 1/256 px or [`crate::disparity::NONE`].
    Buffer(&'a wgpu::Buffer),
    /// A texture with `STORAGE_BINDING`; the mip level that the view shows has the size of the pair. `R32Sint`: values as in
    /// a buffer. `R32Float`: pixels, or [`crate::disparity::NONE_IN_PIXELS`].
    Texture(&'a wgpu::TextureView),
}

/// Destinations bound to a [`super::Matcher`]: see [`super::Matcher::outputs`].
#[derive(Debug)]
pub struct Outputs {
    pub(super) disparities: Disparities,
    pub(super) confidences: Option<wgpu::Buffer>,
    /// First buffer of the matcher that the outputs were prepared for.
    pub(super) matcher: wgpu::Buffer,
    /// What becomes of a map that is taken back, once it is whole.
    pub(super) back: Option<Box<Back>>,
}

/// The way of a whole map to the view as it was taken, and from there to the destinations.
#[derive(Debug)]
pub(super) struct Back {
    pub(super) dispatch: Dispatch,
    /// Disparities and confidences.
    pub(super) copies: [WordCopy; 2],
    pub(super) to: Outputs,
}

#[derive(Debug)]
pub(super) enum Disparities {
    Buffer(wgpu::Buffer),
    /// One dispatch per copy of disparities in the plan.
    Texture(Vec<Dispatch>),
}

impl Disparities {
    /// The buffer, unless the destination is a texture.
    pub(super) fn buffer(&self) -> Option<&wgpu::Buffer> {
        match self {
            Self::Buffer(buffer) => Some(buffer),
            Self::Texture(_) => None,
        }
    }

    /// The dispatches that write a texture.
    pub(super) fn dispatches(&self) -> &[Dispatch] {
        match self {
            Self::Buffer(_) => &[],
            Self::Texture(dispatches) => dispatches,
        }
    }
}

impl Outputs {
    /// Panics unless the outputs were prepared for the matcher whose first buffer is `matcher`.
    pub(super) fn assert_of(&self, matcher: &wgpu::Buffer) {
        assert!(self.matcher == *matcher, "outputs of another matcher: use this matcher's `outputs`");
    }

    /// Records `copy`, the plan's copy of disparities number `index`, to the destination.
    pub(super) fn record_disparities(&self, encoder: &mut wgpu::CommandEncoder, copy: &WordCopy, index: usize) {
        match &self.disparities {
            Disparities::Buffer(to) => copy.record(encoder, to),
            Disparities::Texture(dispatches) => dispatches[index].record(encoder),
        }
    }

    /// Records what follows when the map is whole.
    pub(super) fn record_back(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(Back { dispatch, copies: [disparities, confidences], to }) = self.back.as_deref() {
            dispatch.record(encoder);
            to.record_disparities(encoder, disparities, 0);
            to.record_confidences(encoder, confidences);
        }
    }

    /// The dispatches that write to destinations.
    pub(super) fn dispatches(&self) -> impl Iterator<Item = &Dispatch> {
        let back = self.back.as_deref();
        let of_back =
            back.into_iter().flat_map(|back| std::iter::once(&back.dispatch).chain(back.to.disparities.dispatches()));
        self.disparities.dispatches().iter().chain(of_back)
    }

    /// Records a copy of confidences, if there is a buffer for them.
    pub(super) fn record_confidences(&self, encoder: &mut wgpu::CommandEncoder, copy: &WordCopy) {
        if let Some(to) = &self.confidences {
            copy.record(encoder, to);
        }
    }
}
