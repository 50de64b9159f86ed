//! What of a pair shows the scene.

use super::kernels::Loss;
use crate::image::Luma;

/// What does not show the scene in the dense matching of a pair.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'m> {
    /// Which pixels of the reference view and of the other one show the scene: 255 or 0; `None`: all do.
    pub masks: [Option<&'m Luma>; 2],
    /// What a pixel with a hidden partner loses before the refinement; after it the confidence.
    pub loss: Loss,
}
