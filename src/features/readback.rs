//! Features on their way back to the host.

use super::{DESCRIPTOR_LENGTH, Feature, collect, keypoints::Keypoint};
use crate::{
    error::{Error, Result},
    gpu::Readback,
};

/// Memory of the host for what a detector finds in a frame: see [`super::Detector::readback`].
#[derive(Debug)]
pub struct FeatureReadback {
    pub(super) capacity: u32,
    pub(super) count: Readback,
    pub(super) keypoints: Readback,
    pub(super) descriptors: Readback,
}

impl FeatureReadback {
    /// The features, sorted by octave, layer, row and column, once the recorded work was submitted and is done. The future
    /// drives the device itself. Until the future is finished, nothing else may be submitted that copies to this memory.
    ///
    /// # Errors
    /// [`Error::TooManyFeatures`] where more was found than there is room for; [`Error::DeviceLost`].
    pub async fn read(&self) -> Result<Vec<Feature>> {
        let found = self.count.read::<u32>(1).await?[0];
        if found > self.capacity {
            return Err(Error::TooManyFeatures { found: found as usize, room: self.capacity });
        }
        let keypoints = self.keypoints.read::<Keypoint>(found as usize).await?;
        let descriptors = self.descriptors.read::<[f32; DESCRIPTOR_LENGTH]>(found as usize).await?;
        Ok(collect(&keypoints, &descriptors))
    }
}
