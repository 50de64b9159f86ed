//! The census transform, with the luma beside it. `shaders/census.wgsl`.

use bytemuck::{Pod, Zeroable};

use super::pad::PadParams;
use crate::{
    error::{Error, Result},
    gpu::{Binding, Dispatch, Kernel, Stage, uniform_buffer},
};

const WORKGROUP: [u32; 2] = [16, 4];

/// A change of brightness: a luma v becomes (gain v + offset + 128) >> 8, cut off at 0 and 255.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Brightness {
    /// In 1/256, up to 2^20 either way.
    pub gain: i32,
    /// In 1/256, up to 2^20 either way.
    pub offset: i32,
}

impl Brightness {
    /// No change.
    pub const SAME: Self = Self { gain: 256, offset: 0 };

    /// Refuses what 32 bits do not hold.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the rule.
    pub fn validate(&self) -> Result<()> {
        for (name, value) in [("the gain", self.gain), ("the offset", self.offset)] {
            if value.unsigned_abs() > 1 << 20 {
                let expected = "it must be -2^20 to 2^20, in 1/256".into();
                return Err(Error::Parameter { name, value: value.to_string(), expected });
            }
        }
        Ok(())
    }
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Params {
    width: u32,
    rows: u32,
    stride: u32,
}

/// The census kernel.
pub struct Census(Kernel);

impl Census {
    /// What the kernel is made of.
    pub fn stage() -> Stage {
        Stage {
            name: "census",
            source: include_str!("../../shaders/census.wgsl"),
            bindings: &[Binding::Uniform(size_of::<Params>() as u64), Binding::Read, Binding::Write],
            constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
        }
    }

    /// Compiles it.
    pub fn new(device: &wgpu::Device) -> Self {
        Self(Kernel::new(device, &Self::stage()))
    }

    /// How a picture is padded for it, after a change of brightness, the plane beginning at the buffer's first word.
    pub fn padding((width, height): (u32, u32), brightness: Brightness) -> PadParams {
        PadParams {
            width,
            height,
            first_word: -1,
            first_row: -2,
            rows: height + 4,
            stride: width.div_ceil(4) + 2,
            offset: 0,
            brightness,
        }
    }

    /// Transforms the picture that stands in `padded` as [`Self::padding`] says: a word a pixel, the 24
    /// bits of its window above its luma.
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        (width, height): (u32, u32),
        padded: &wgpu::Buffer,
        census: &wgpu::Buffer,
    ) -> Dispatch {
        let padding = Self::padding((width, height), Brightness::SAME);
        let params = Params { width, rows: height, stride: padding.stride };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(device, &[&uniform_buffer(device, "census", &params), padded, census], groups)
    }
}
