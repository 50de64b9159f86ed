//! Matchers that serve one pair after the other.

use super::{
    Dense, Matcher,
    config::{Brightness, DenseConfig},
    kernels::Loss,
    matcher::Views,
    readback::MapReadback,
    uploaded::UploadedPair,
};
use crate::{
    error::Result,
    gpu::{Gpu, guarded},
    image::Size,
    luma::Colours,
};

/// A matcher with memory of its own for a pair and for its map.
struct Kept {
    purpose: Purpose,
    matcher: Matcher,
    readback: MapReadback,
    bytes: u64,
}

/// What a matcher is built for. The brightness is not among it, which each pair sets.
#[derive(Clone, PartialEq)]
struct Purpose {
    size: Size,
    config: DenseConfig,
    masks: Option<Loss>,
}

/// Matches a pair over its whole range, with its colours where holes are filled, by a matcher that `gpu` has kept, or that it keeps. The
/// result is the same.
///
/// # Errors
/// As [`Matcher::new`]; [`crate::Error::DeviceLost`].
pub(super) async fn matched(
    gpu: &Gpu,
    size: Size,
    config: &DenseConfig,
    pair: &UploadedPair,
    progress: impl FnMut(f32),
) -> Result<Dense> {
    let purpose = &Purpose {
        size,
        config: DenseConfig { brightness: Brightness::SAME, ..config.clone() },
        masks: pair.masks.as_ref().map(|masks| masks.loss),
    };
    let build = |gpu: Gpu| async move { Kept::new(&gpu, purpose, pair).await };
    let mut kept = gpu.kept_or_built(|kept: &Kept| kept.purpose == *purpose, build).await?;
    // A matcher whose work failed is not kept.
    let dense = kept.matcher.run_on(pair, config.brightness, &mut kept.readback, progress).await?;
    let bytes = kept.bytes;
    gpu.keep(kept, bytes);
    Ok(dense)
}

impl Kept {
    /// A matcher for pairs such as `pair`, on a `gpu` that keeps nothing.
    async fn new(gpu: &Gpu, purpose: &Purpose, pair: &UploadedPair) -> Result<Self> {
        let Purpose { size, config, .. } = purpose;
        let own = guarded(gpu, "the pair", || pair.another(gpu, *size)).await?;
        let of_colours = own.colours.as_ref().map_or(0, Colours::bytes);
        let matcher = Matcher::build(gpu, *size, config, Views::Uploaded(own), u32::MAX).await?;
        let readback = matcher.readback().await?;
        let bytes = matcher.memory() + of_colours;
        Ok(Self { purpose: purpose.clone(), matcher, readback, bytes })
    }
}
