//! The planes that block matching compares.

use super::Plan;
use crate::{
    dense::{
        config::{Compared, View},
        kernels::{Layout, Pad, SoftRank},
    },
    gpu::{Gpu, WordTexture},
};

/// The kernel that makes the bytes that are compared.
pub(super) enum ComparedBytes {
    Luma(Pad),
    SoftRank(SoftRank),
}

impl ComparedBytes {
    pub(super) fn new(gpu: &Gpu, compared: Compared) -> Self {
        match compared {
            Compared::Luma => Self::Luma(Pad::new(gpu)),
            Compared::SoftRank => Self::SoftRank(SoftRank::new(gpu)),
        }
    }

    /// Plans the padded planes of packed luma, left and right, of `layout`.
    pub(super) fn plan(
        &self,
        plan: &mut Plan,
        layout: &Layout,
        luma: [&wgpu::Buffer; 2],
        (buffer, texture): &(wgpu::Buffer, WordTexture),
    ) {
        for ((params, view), luma) in layout.padding().into_iter().zip(View::ALL).zip(luma) {
            plan.run(match self {
                Self::Luma(pad) => pad.prepare(params, &plan.brightness(view), luma, buffer),
                Self::SoftRank(soft_rank) => soft_rank.prepare(params, luma, buffer),
            });
        }
        plan.fill_texture(buffer, texture);
    }
}
