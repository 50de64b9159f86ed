//! Detection of interest points in one picture after the other.

use crate::{
    backend::Backend,
    cpu,
    error::Result,
    features::{Detector, Feature, FeatureConfig},
    gpu::Gpu,
    image::{Luma, Size},
    luma::{pack, upload},
};

/// Finds interest points and keeps the last detector: building one takes longer than using it, and most pictures have
/// the size of the previous one. Only one detector is kept, as it holds memory for each pixel.
pub(super) struct DetectorCache<'b> {
    backend: &'b Backend,
    last: Option<SizedDetector>,
}

/// A detector, the picture size (width and height in pixels) and configuration it was built for, and its luma buffer.
struct SizedDetector {
    size: Size,
    config: FeatureConfig,
    luma: wgpu::Buffer,
    detector: Detector,
}

impl<'b> DetectorCache<'b> {
    pub(super) fn new(backend: &'b Backend) -> Self {
        Self { backend, last: None }
    }

    /// The features of one picture that [`Backend::features`] detects.
    pub(super) async fn features(&mut self, luma: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
        match self.backend {
            Backend::Cpu => Ok(cpu::features::detector::detect(luma, config)?.features),
            Backend::Gpu(gpu) => self.on_device(gpu, luma, config).await,
        }
    }

    async fn on_device(&mut self, gpu: &Gpu, luma: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
        let detector = match self.last.take().filter(|last| last.size == luma.size() && last.config == *config) {
            Some(last) => {
                gpu.queue.write_buffer(&last.luma, 0, bytemuck::cast_slice(&pack(luma)));
                last
            }
            None => SizedDetector::new(gpu, luma, config).await?,
        };
        let SizedDetector { detector, luma, .. } = self.last.insert(detector);
        Ok(detector.detect(luma).await?.features)
    }
}

impl SizedDetector {
    async fn new(gpu: &Gpu, luma: &Luma, config: &FeatureConfig) -> Result<Self> {
        let (size, buffer) = (luma.size(), upload(gpu, luma).await?);
        let detector = Detector::new(gpu, size, config).await?;
        Ok(Self { size, config: config.clone(), luma: buffer, detector })
    }
}
