//! What matches frames of one disparity range.

use hsad::{
    dense::{DenseConfig, Matcher},
    features::{Detector, DetectorInput, FeatureConfig},
    gpu::{Gpu, block_on},
    image::Size,
};

/// The kernels for one configuration, shared by the slots that were made for it.
pub struct Engine {
    pub gpu: Gpu,
    pub config: DenseConfig,
    pub matcher: Matcher,
    /// Detectors of the left and the right view, which read the matcher's luma.
    pub detectors: [(Detector, DetectorInput); 2],
}

impl Engine {
    pub fn new(gpu: &Gpu, size: Size, config: DenseConfig) -> hsad::Result<Self> {
        let matcher = Matcher::new(gpu, size, &config)?;
        // A small capacity, so that little has to be read back.
        let features = FeatureConfig { max_features: 2048, ..FeatureConfig::default() };
        let [left, right] = matcher.luma().map(|luma| -> hsad::Result<_> {
            let detector = block_on(Detector::new(gpu, size, &features))?;
            let input = block_on(detector.input(luma))?;
            Ok((detector, input))
        });
        Ok(Self { gpu: gpu.clone(), config, matcher, detectors: [left?, right?] })
    }
}
