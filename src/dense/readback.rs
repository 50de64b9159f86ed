//! A map on its way back to the host.

use super::{Dense, Outputs};
use crate::{
    error::Result,
    gpu::Readback,
    image::{Plane, Size},
    luma::unpack,
};

/// Memory of the host for a matcher's map: see [`super::Matcher::readback`].
#[derive(Debug)]
pub struct MapReadback {
    pub(super) size: Size,
    pub(super) outputs: Outputs,
    pub(super) disparities: Readback,
    pub(super) confidences: Readback,
}

impl MapReadback {
    /// The outputs that [`super::Matcher::record`] writes to.
    pub fn outputs(&self) -> &Outputs {
        &self.outputs
    }

    /// The map, once the recorded work was submitted and is done. The future drives the device itself. Until the future
    /// is finished, nothing else may be submitted that writes to these outputs.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub async fn read(&mut self) -> Result<Dense> {
        let Size { width, height } = self.size;
        let disparity = Plane::new((width, height), self.disparities.read(width as usize * height as usize).await?)?;
        let words: Vec<u32> = self.confidences.read(width.div_ceil(4) as usize * height as usize).await?;
        Ok(Dense { disparity, confidence: unpack((width, height), &words) })
    }
}
