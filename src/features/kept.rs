//! Detectors that serve one pair after the other.

use super::{Detected, Detector, FeatureConfig};
use crate::{error::Result, gpu::Gpu, image::Size};

/// The interest points of two pictures of one size, by a detector that `gpu` has kept, or that it keeps.
///
/// # Errors
/// See [`super::detect`].
pub(crate) async fn detect_both(
    gpu: &Gpu,
    size: Size,
    config: &FeatureConfig,
    [left, right]: [&wgpu::Buffer; 2],
) -> Result<[Detected; 2]> {
    let build = |gpu: Gpu| async move { Detector::new(&gpu, size, config).await };
    let detector = gpu.kept_or_built(|kept: &Detector| kept.serves(size, config), build).await?;
    let detected = [detector.detect(left).await?, detector.detect(right).await?];
    let bytes = detector.memory();
    gpu.keep(detector, bytes);
    Ok(detected)
}
