//! Dense matching of one pair on a device.

use super::{
    Dense, Matcher, colours::ReferenceColours, config::DenseConfig, kept, levels, matcher::Views, pyramid::Pyramid,
    uploaded::UploadedPair,
};
#[cfg(feature = "verify")]
use super::{seen::Seen, uploaded::Masks};
use crate::{
    error::{Error, Result},
    gpu::{Gpu, check_limits},
    image::{Luma, Size},
    luma::{check_size, upload},
};

/// Matches one pair on `gpu`, over a [`Pyramid`] where `config` asks for one.
///
/// # Errors
/// [`Error::SizesDiffer`], and as [`Matcher::new`]; [`Error::DeviceLost`].
pub async fn compute(gpu: &Gpu, left: &Luma, right: &Luma, config: &DenseConfig) -> Result<Dense> {
    if left.size() != right.size() {
        return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
    }
    check_size(left.size())?;
    check_limits(gpu)?;
    let luma = [upload(gpu, left).await?, upload(gpu, right).await?];
    compute_uploaded(gpu, left.size(), config, UploadedPair { luma, colours: None, masks: None }, |_| ()).await
}

/// [`compute`] for a pair that is on the device. Calls `progress` with the share of the work that is done, 0 to 1, where the work
/// has parts.
pub(crate) async fn compute_uploaded(
    gpu: &Gpu,
    size: Size,
    config: &DenseConfig,
    mut pair: UploadedPair,
    progress: impl FnMut(f32),
) -> Result<Dense> {
    config.validate()?;
    check_limits(gpu)?;
    if pair.colours.is_none() {
        pair.colours = ReferenceColours::without_colours(gpu, size, config, pair.luma.each_ref()).await?;
    }
    if let Some(pyramid) = Pyramid::of(config, size) {
        return levels::compute(gpu, pair, config, &pyramid, u32::MAX, progress).await;
    }
    if gpu.keeps() {
        return kept::matched(gpu, size, config, &pair, progress).await;
    }
    Matcher::build(gpu, size, config, Views::Uploaded(pair), u32::MAX).await?.run_by_parts(progress).await
}

/// [`compute`] of what is `seen` of a pair, over the levels of `pyramid`, in bands of at most `band_rows` rows.
#[cfg(feature = "verify")]
pub(crate) async fn compute_over(
    gpu: &Gpu,
    [left, right]: [&Luma; 2],
    seen: Option<Seen<'_>>,
    config: &DenseConfig,
    pyramid: &Pyramid,
    band_rows: u32,
) -> Result<Dense> {
    let luma = [upload(gpu, left).await?, upload(gpu, right).await?];
    let colours = ReferenceColours::without_colours(gpu, left.size(), config, luma.each_ref()).await?;
    let masks = seen.map(|seen| Masks::new(gpu, left.size(), seen)).transpose()?;
    levels::compute(gpu, UploadedPair { luma, colours, masks }, config, pyramid, band_rows, |_| ()).await
}
