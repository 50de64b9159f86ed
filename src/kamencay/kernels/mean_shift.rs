//! Mean-shift filtering. `shaders/kamencay/mean_shift.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [8, 8];

/// A mean that moves by no more than this, in 1/16 pixels and grey levels together, has arrived.
pub const STILL: i32 = 8;

/// Mean-shift filtering in places and colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModeSeeking {
    /// Half the side of the window without its centre, in pixels, 1 to 15.
    pub radius: u32,
    /// The largest distance of two colours (red, green and blue) that count as alike, in grey levels, 1 to 255.
    pub range: u32,
    /// The most steps of a pixel, 1 to 100.
    pub turns: u32,
}

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
    }
}

/// The kernel of mean-shift filtering.
#[derive(Debug)]
pub struct MeanShift(Kernel);

impl MeanShift {
    /// Source, bindings and constants of the kernel.
    pub fn stage(seeking: &ModeSeeking) -> Stage {
        Stage {
            name: "mean_shift",
            source: include_str!("../../../shaders/kamencay/mean_shift.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("RADIUS", seeking.radius.into()),
                ("SQUARED_RANGE", i64::from(16 * seeking.range).pow(2)),
                ("TURNS", seeking.turns.into()),
                ("STILL", STILL.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, seeking: &ModeSeeking) -> Self {
        Self(Kernel::new(gpu, &Self::stage(seeking)))
    }

    /// Writes the colour of each pixel's mode; both buffers hold a word a pixel, red in its lowest byte.
    pub fn prepare(&self, Size { width, height }: Size, pixels: &wgpu::Buffer, modes: &wgpu::Buffer) -> Dispatch {
        let params = Params { width, height };
        let groups = [width.div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[pixels, modes], groups)
    }
}
