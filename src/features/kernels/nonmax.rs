//! Non-maximum suppression over position and scale, with sub-sample interpolation.
//! `shaders/features/nonmax.wgsl`.

use super::hessian::{DETERMINANT_SCALE, FILTER_SIZES, Grid, Hessian};
use crate::{
    error::Result,
    features::{FeatureConfig, keypoints::KeypointList},
    gpu::{Binding, Context, Dispatch, Kernel, ShaderType, Stage, shader_struct, uniform_buffer},
};

const WORKGROUP: [u32; 2] = [16, 4];

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        step: u32,
        grid_width: u32,
        grid_height: u32,
        octave: u32,
        threshold: i32,
        padding: u32,
        sizes: [u32; 4],
    }
}

/// The stage.
pub fn stage() -> Stage {
    Stage {
        name: "nonmax",
        source: include_str!("../../../shaders/features/nonmax.wgsl"),
        bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write, Binding::Write],
        constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
    }
}

/// A threshold on OpenSURF's scale as a determinant of the kernels, at least 1.
pub fn integer_threshold(threshold: f32) -> i32 {
    (f64::from(threshold) * DETERMINANT_SCALE).round().max(1.0) as i32
}

/// The keypoints of all octaves for pictures of one size.
pub struct Nonmax {
    octaves: Vec<Dispatch>,
    list: KeypointList,
}

impl Nonmax {
    /// Reads the responses of `hessian`, which was made for the same size and `config`.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] where the device cannot bind the list.
    pub fn new(
        device: &Context<'_>,
        hessian: &Hessian,
        width: u32,
        height: u32,
        config: &FeatureConfig,
    ) -> Result<Self> {
        let kernel = Kernel::new(device, &stage());
        let list = KeypointList::new(device, config.max_features)?;
        let octaves = (0..config.octaves)
            .map(|octave| {
                let grid = Grid::new(width, height, config.step, octave);
                let params = Params {
                    width,
                    height,
                    step: grid.step,
                    grid_width: grid.width,
                    grid_height: grid.height,
                    octave,
                    threshold: integer_threshold(config.threshold),
                    padding: 0,
                    sizes: FILTER_SIZES[octave as usize],
                };
                let params = uniform_buffer(device, "suppression in an octave", &params);
                let groups =
                    [grid.width.div_ceil(2).div_ceil(WORKGROUP[0]), grid.height.div_ceil(2).div_ceil(WORKGROUP[1]), 1];
                let buffers = [&params, hessian.responses(octave), list.found(), list.keypoints()];
                kernel.dispatch(device, &buffers, groups)
            })
            .collect();
        Ok(Self { octaves, list })
    }

    /// Records the emptying of the list, then one pass for each octave.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(self.list.found(), 0, None);
        for octave in &self.octaves {
            octave.record(encoder);
        }
    }

    /// The list of keypoints.
    pub fn list(&self) -> &KeypointList {
        &self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_determinants_of_1_256_grey_level() {
        // 0.0004 * 65280^2 = 1704591.36
        assert_eq!(integer_threshold(0.0004), 1_704_591);
        assert_eq!(integer_threshold(1e-12), 1);
        assert_eq!(integer_threshold(1.0), i32::MAX);
    }
}
