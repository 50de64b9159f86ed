//! Matchers of views as they were taken.

use super::{Matcher, resampling::Views};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    dense::config::DenseConfig,
    error::{Result, check},
    gpu::Gpu,
    rectify::WarpMap,
};

impl Matcher {
    /// A matcher of views as they were taken: [`Self::record`] resamples each of them by its map first, and matches what that makes.
    /// Maps of a rectification are [`crate::rectify::StereoRectification::map`]; both lead from pictures of one size, that of the
    /// matcher, to the views, which [`Self::inputs`] takes.
    ///
    /// Pixels that show nothing of their view have no disparity, and take no part in the refinement; those whose partner shows nothing
    /// have confidence 0. [`Self::outputs`] takes disparities of the resampled reference view, [`Self::outputs_back`] those of the
    /// view as it was taken.
    ///
    /// # Errors
    /// As [`Self::new`]; [`crate::Error::Parameter`] for maps of different sizes, [`crate::Error::TooLarge`] where holes are filled
    /// and the colours of the reference view exceed the buffer limits.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn rectifying(gpu: &Gpu, maps: [&WarpMap; 2], config: &DenseConfig) -> Result<Self> {
        block_on(Self::rectifying_async(gpu, maps, config))
    }

    /// The asynchronous [`Matcher::rectifying`].
    ///
    /// # Errors
    /// See [`Matcher::rectifying`].
    pub async fn rectifying_async(gpu: &Gpu, maps: [&WarpMap; 2], config: &DenseConfig) -> Result<Self> {
        let [left, right] = maps.map(WarpMap::size);
        check(left == right, "the maps", format_args!("for {left} and {right} pixels"), "both must be for one size")?;
        Self::build(gpu, left, config, Views::Resampled(maps), u32::MAX).await
    }
}
