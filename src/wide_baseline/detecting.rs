//! Interest points of one picture after the other.

use crate::{
    backend::Backend,
    cpu,
    error::Result,
    features::{Detector, Feature, FeatureConfig},
    gpu::Gpu,
    image::Luma,
    luma::{pack, upload},
};

/// Finds interest points, and keeps the last detector: to build one takes longer than to use it, and most pictures have
/// the size of the one before. No more than the last one, as it holds memory for each pixel.
pub(super) struct Detecting<'b> {
    backend: &'b Backend,
    last: Option<Built>,
}

/// A detector with what it is for and the picture that it reads.
struct Built {
    size: (u32, u32),
    config: FeatureConfig,
    luma: wgpu::Buffer,
    detector: Detector,
}

impl<'b> Detecting<'b> {
    pub(super) fn new(backend: &'b Backend) -> Self {
        Self { backend, last: None }
    }

    /// As [`Backend::features`].
    pub(super) async fn features(&mut self, luma: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
        match self.backend {
            Backend::Cpu => cpu::features::detector::detect(luma, config),
            Backend::Gpu(gpu) => self.on_device(gpu, luma, config).await,
        }
    }

    async fn on_device(&mut self, gpu: &Gpu, luma: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
        let built = match self.last.take().filter(|last| last.size == luma.size() && last.config == *config) {
            Some(last) => {
                gpu.queue.write_buffer(&last.luma, 0, bytemuck::cast_slice(&pack(luma)));
                last
            }
            None => Built::new(gpu, luma, config).await?,
        };
        let Built { detector, luma, .. } = self.last.insert(built);
        detector.detect(luma).await
    }
}

impl Built {
    async fn new(gpu: &Gpu, luma: &Luma, config: &FeatureConfig) -> Result<Self> {
        let (size, buffer) = (luma.size(), upload(gpu, luma).await?);
        let detector = Detector::new(gpu, size, config).await?;
        Ok(Self { size, config: config.clone(), luma: buffer, detector })
    }
}
