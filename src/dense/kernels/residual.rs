//! Photometric residuals: the difference of both views at corresponding pixels. `shaders/dense/residual.wgsl`.

use crate::{
    dense::config::{Brightness, View},
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [32, 8];

/// The largest residual, in grey levels; larger differences are truncated, since they carry no more information.
pub const MAX_RESIDUAL: u8 = 31;

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_row: u32,
        direction: i32,
    }
}

/// The two views that the residual kernel compares.
#[derive(Clone, Copy, Debug)]
pub struct ComparedViews<'b> {
    /// Packed luma of the left and of the right view.
    pub luma: [&'b wgpu::Buffer; 2],
    /// Change of the right view's brightness: a [`Brightness`] in a uniform buffer.
    pub brightness: &'b wgpu::Buffer,
    /// The reference view, to which the map belongs.
    pub reference: View,
}

/// The kernel of the photometric residuals.
#[derive(Debug)]
pub struct Residual(Kernel);

impl Residual {
    /// Source, bindings and constants of the kernel.
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

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Compares the `views` at the disparities of `width` x `rows` pixels, which begin in row `first_row` of the
    /// pictures. Residuals are packed as luma is, four per `u32`.
    pub fn prepare(
        &self,
        Size { width, height: rows }: Size,
        first_row: u32,
        views: ComparedViews<'_>,
        disparities: &wgpu::Buffer,
        residuals: &wgpu::Buffer,
    ) -> Dispatch {
        let ComparedViews { luma: [left, right], brightness, reference } = views;
        let params = Params { width, rows, first_row, direction: reference.direction() };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[brightness, left, right, disparities, residuals], groups)
    }
}
