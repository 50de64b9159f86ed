//! How unlike both views look where disparities say that they show the same. `shaders/dense/residual.wgsl`.

use crate::{
    dense::config::{Brightness, View},
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [32, 8];

/// The largest residual, in grey levels: a larger difference tells no more.
pub const MAX_RESIDUAL: u8 = 31;

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_row: u32,
        direction: i32,
    }
}

/// Both views of a pair, as a kernel that compares them has them.
#[derive(Clone, Copy, Debug)]
pub struct Views<'b> {
    /// Packed luma, left and right.
    pub luma: [&'b wgpu::Buffer; 2],
    /// How the right view's brightness is changed: a [`Brightness`] in a uniform buffer.
    pub brightness: &'b wgpu::Buffer,
    /// The one whose map it is.
    pub reference: View,
}

/// The kernel of the photometric residuals.
#[derive(Debug)]
pub struct Residual(Kernel);

impl Residual {
    /// What the kernel is made of.
    pub fn stage() -> Stage {
        Stage {
            name: "residual",
            source: include_str!("../../../shaders/dense/residual.wgsl"),
            bindings: &[
                Binding::Uniform(Params::SHAPE),
                Binding::Uniform(Brightness::SHAPE),
                Binding::Read,
                Binding::Read,
                Binding::Read,
                Binding::Write,
            ],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("SCALE", SCALE.into()),
                ("SCALE_BITS", SCALE.ilog2().into()),
                ("NONE", NONE.into()),
                ("LIMIT", MAX_RESIDUAL.into()),
            ],
        }
    }

    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Compares the `views` at the disparities of `width` x `rows` pixels, which are those of the pictures from `first_row`
    /// on. The residuals are packed as luma is.
    pub fn prepare(
        &self,
        Size { width, height: rows }: Size,
        first_row: u32,
        views: Views<'_>,
        disparities: &wgpu::Buffer,
        residuals: &wgpu::Buffer,
    ) -> Dispatch {
        let Views { luma: [left, right], brightness, reference } = views;
        let params = Params { width, rows, first_row, direction: reference.direction() };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[brightness, left, right, disparities, residuals], groups)
    }
}
