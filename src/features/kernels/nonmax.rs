//! Non-maximum suppression over position and scale, with sub-sample interpolation.
//! `shaders/features/nonmax.wgsl`.

use super::hessian::{DETERMINANT_SCALE, FILTER_SIZES, Grid};
use crate::{
    features::{FeatureConfig, keypoints::KeypointList},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
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

/// Converts a threshold on OpenSURF's scale to a determinant of the kernels, at least 1.
pub fn integer_threshold(threshold: f32) -> i32 {
    (f64::from(threshold) * DETERMINANT_SCALE).round().max(1.0) as i32
}

/// The non-maximum suppression kernel, for one octave.
#[derive(Debug)]
pub struct Nonmax(Kernel);

impl Nonmax {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// Appends the maxima of an octave's `responses`, from [`super::hessian`] with `config`, to the `list`.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        octave: u32,
        config: &FeatureConfig,
        responses: &wgpu::Buffer,
        list: &KeypointList,
    ) -> Dispatch {
        let grid = Grid::new((width, height), config.step, octave);
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
        let groups = [grid.width.div_ceil(2).div_ceil(WORKGROUP[0]), grid.height.div_ceil(2).div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[responses, list.count(), list.keypoints()], groups)
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
