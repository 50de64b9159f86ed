//! Padding: a picture with its edges continued, laid out for block matching. `shaders/pad.wgsl`.

use bytemuck::{Pod, Zeroable};

use super::census::Brightness;
use crate::gpu::{Binding, Dispatch, Kernel, Stage, uniform_buffer};

const WORKGROUP: [u32; 2] = [64, 4];

/// Where a padded plane lies: in the picture, and in the buffer. All words and rows are those of
/// the picture, and may lie outside of it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PadParams {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// The first padded word: of four pixels, counted from the picture's first.
    pub first_word: i32,
    /// Row of the first padded row.
    pub first_row: i32,
    /// Padded rows.
    pub rows: u32,
    /// Words of a padded row, four pixels each.
    pub stride: u32,
    /// Word of the buffer at which the plane begins.
    pub offset: u32,
    /// The change of brightness on the way.
    pub brightness: Brightness,
}

/// The padding kernel.
pub struct Pad(Kernel);

impl Pad {
    /// What the kernel is made of.
    pub fn stage() -> Stage {
        Stage {
            name: "pad",
            source: include_str!("../../shaders/pad.wgsl"),
            bindings: &[Binding::Uniform(size_of::<PadParams>() as u64), Binding::Read, Binding::Write],
            constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
        }
    }

    /// Compiles it.
    pub fn new(device: &wgpu::Device) -> Self {
        Self(Kernel::new(device, &Self::stage()))
    }

    /// Pads packed `luma` into `padded`, as `params` say.
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        params: PadParams,
        luma: &wgpu::Buffer,
        padded: &wgpu::Buffer,
    ) -> Dispatch {
        let groups = [params.stride.div_ceil(WORKGROUP[0]), params.rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(device, &[&uniform_buffer(device, "pad", &params), luma, padded], groups)
    }
}
