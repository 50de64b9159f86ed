//! Mean-shift filtering. `shaders/kamencay/mean_shift.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [8, 8];

/// Convergence threshold: a mean has converged when it moves by at most this, in 1/16 of a pixel and of a grey level
/// together.
pub const STILL: i32 = 8;

/// Mean-shift filtering over position and colour (Comaniciu and Meer, PAMI 2002).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModeSeeking {
    /// Radius of the window, (side - 1) / 2, 1 to 15 pixels; 5 by default.
    pub radius: u32,
    /// Largest distance of two similar colours in RGB, 1 to 255 grey levels; 10 by default.
    pub range: u32,
    /// Most iterations per pixel, 1 to 65; 10 by default.
    pub turns: u32,
}

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
    }
}

/// The mean-shift kernel.
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

    /// Writes the colour of each pixel's mode. Both buffers hold one `u32` per pixel, red in its lowest byte.
    pub fn prepare(&self, Size { width, height }: Size, pixels: &wgpu::Buffer, modes: &wgpu::Buffer) -> Dispatch {
        let params = Params { width, height };
        let groups = [width.div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[pixels, modes], groups)
    }
}
