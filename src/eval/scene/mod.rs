//! Stereo pairs with ground truth, in the file layouts of the benchmarks.
//!
//! | folder | views | ground truth of the left and the right view | non-occlusion mask (255: both views see the pixel) |
//! |---|---|---|---|
//! | as in `data/` | `left.png`, `right.png` (or .jpg, .ppm, .pgm) | `disp_left.pfm`, `disp_right.pfm` | `nonocc.png`, `nonocc_right.png` |
//! | Middlebury 2014 and 2021, ETH3D | `im0.png`, `im1.png` | `disp0.pfm` (or `disp0GT.pfm`), `disp1.pfm` (or `disp1GT.pfm`) | `mask0nocc.png`, `mask1nocc.png` |
//! | Middlebury 2001 and 2003 | `im2.png`, `im6.png` (or .ppm, .pgm) | `disp2.png`, `disp6.png` (or .pgm), scaled | none |
//! | Middlebury 2005 and 2006 | `view1.png`, `view5.png` | `disp1.png`, `disp5.png`, scaled | none |
//! | KITTI 2015 | `image_2/N_10.png`, `image_3/N_10.png` | `disp_occ_0/N_10.png`, none | where `disp_noc_0/N_10.png` is known |
//! | KITTI 2012 | `colored_0/N_10.png`, `colored_1/N_10.png`, or `image_0`, `image_1` | `disp_occ/N_10.png`, none | where `disp_noc/N_10.png` is known |
//! | SceneFlow | `frames_cleanpass/.../left/N.png`, `.../right/N.png` | `disparity/.../left/N.pfm`, `.../right/N.pfm` | none |
//!
//! Masks may be missing, and so may the ground truth of a view that is not read. The pictures' height tells by what Middlebury's data
//! sets up to 2006 scaled their disparities, from 1 for the full size to 8 for 2001's.

mod files;
mod find;
mod layouts;
mod scene_flow;
#[cfg(test)]
mod tests;

use glam::DVec2;

pub use self::files::SceneFiles;
use super::{Score, conditions::Changed, score_pixels};
use crate::{dense::View, error::Result, image::Plane, io::Picture};

/// Error thresholds of the wrong-pixel shares, in pixels.
pub const THRESHOLDS: [f32; 4] = [0.5, 1.0, 2.0, 4.0];

/// A pair of views and the ground truth of one of them.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The left view.
    pub left: Picture,
    /// The right view.
    pub right: Picture,
    /// The reference view, which the ground truth belongs to.
    pub reference: View,
    /// True disparities of the reference view, in pixels, +inf where unknown; positive if the right view's pixel lies
    /// further to the left.
    pub truth: Plane<f32>,
    /// Non-occlusion mask of the reference view, 255 where both views see the same point; `None` if there is no mask.
    pub non_occluded: Option<Plane<u8>>,
}

/// Scores of a map over all pixels and over the non-occluded ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Scores {
    /// Score over all pixels with ground truth.
    pub all: Score,
    /// Score over the non-occluded pixels with ground truth; `None` without a mask.
    pub non_occluded: Option<Score>,
}

impl Scene {
    /// The scene with its right view changed, of which the left view is the reference: pixels whose partner the changed view does not
    /// show have no ground truth.
    #[must_use]
    pub fn changed(self, changed: &Changed) -> Self {
        let partner = |x: u32, y: u32| DVec2::new(f64::from(x) - f64::from(self.truth.get(x, y)), y.into());
        let truth = Plane::from_fn(self.truth.size(), |x, y| {
            if changed.shows(partner(x, y)) { self.truth.get(x, y) } else { f32::INFINITY }
        });
        Self { right: changed.picture.clone(), truth, ..self }
    }

    /// The picture of the reference view.
    pub fn reference_view(&self) -> &Picture {
        match self.reference {
            View::Left => &self.left,
            View::Right => &self.right,
        }
    }

    /// Scores `map`, in pixels and not finite where there is no estimate, with the thresholds [`THRESHOLDS`].
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if the size of `map` differs from that of the scene.
    pub fn score(&self, map: &Plane<f32>) -> Result<Scores> {
        let score = |mask| score_pixels(map, &self.truth, mask, &THRESHOLDS);
        Ok(Scores {
            all: score(None)?,
            non_occluded: self.non_occluded.as_ref().map(|mask| score(Some(mask))).transpose()?,
        })
    }
}
