//! Padding: a picture whose edge pixels are repeated, laid out for block matching. `shaders/dense/pad.wgsl`.

use crate::{
    dense::config::Brightness,
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: [u32; 2] = [64, 4];

shader_struct! {
    /// Place of a padded plane in the picture and in the buffer. Words and rows are counted in the picture and can lie
    /// outside of it.
    pub struct PadParams {
        /// Width of the picture in pixels.
        pub width: u32,
        /// Height of the picture in pixels.
        pub height: u32,
        /// First padded word of four pixels, counted from the picture's first word.
        pub first_word: i32,
        /// Row of the picture of the first padded row.
        pub first_row: i32,
        /// Number of padded rows.
        pub rows: u32,
        /// Words per padded row, four pixels each.
        pub stride: u32,
        /// Offset of the plane in the buffer, in words.
        pub offset: u32,
    }
}

/// The padding kernel.
#[derive(Debug)]
pub struct Pad(Kernel);

impl Pad {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "pad",
            source: include_str!("../../../shaders/dense/pad.wgsl"),
            bindings: &[
                Binding::Uniform(PadParams::SHAPE),
                Binding::Uniform(Brightness::SHAPE),
                Binding::Read,
                Binding::Write,
            ],
            constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Pads packed `luma` into `padded`, as `params` say, and changes its brightness by the uniform `brightness`, read
    /// when the kernel runs.
    pub fn prepare(
        &self,
        params: PadParams,
        brightness: &wgpu::Buffer,
        luma: &wgpu::Buffer,
        padded: &wgpu::Buffer,
    ) -> Dispatch {
        let groups = [params.stride.div_ceil(WORKGROUP[0]), params.rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[brightness, luma, padded], groups)
    }
}
