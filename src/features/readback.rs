//! Features copied back to the host.

use super::{DESCRIPTOR_LENGTH, Feature, collect, keypoints::Keypoint};
use crate::{
    error::{Error, Result},
    gpu::Readback,
};

/// Staging buffers for the features of one frame: see [`super::Detector::readback`].
#[derive(Debug)]
pub struct FeatureReadback {
    pub(super) capacity: u32,
    /// Integral image of the detector that the readback was allocated for.
    pub(super) detector: wgpu::Buffer,
    pub(super) count: Readback,
    pub(super) keypoints: Readback,
    pub(super) descriptors: Readback,
}

impl FeatureReadback {
    /// Waits for the submitted work and returns the features, sorted by octave, layer, row and column. The future polls
    /// the device itself. Until it is finished, no other copy to these buffers may be submitted.
    ///
    /// # Errors
    /// [`Error::TooManyFeatures`] if more features were found than [`super::FeatureConfig::max_features`];
    /// [`Error::DeviceLost`].
    pub async fn read(&mut self) -> Result<Vec<Feature>> {
        let keypoint_count = self.count.read::<u32>(1).await?[0];
        if keypoint_count > self.capacity {
            return Err(Error::TooManyFeatures { found: keypoint_count as usize, room: self.capacity });
        }
        let keypoints = self.keypoints.read::<Keypoint>(keypoint_count as usize).await?;
        let descriptors = self.descriptors.read::<[f32; DESCRIPTOR_LENGTH]>(keypoint_count as usize).await?;
        Ok(collect(&keypoints, &descriptors))
    }
}
