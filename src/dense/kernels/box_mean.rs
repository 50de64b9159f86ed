//! The mean cost over a square window. `shaders/dense/box_mean.wgsl`.

use std::ops::Range;

use super::volume_band::VolumeBand;
use crate::gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct};

const WORKGROUP: [u32; 2] = [8, 8];

shader_struct! {
    struct Params {
        words: u32,
        lines: u32,
        line_step: u32,
        pixel_step: u32,
        length: u32,
        first: u32,
        wanted: u32,
    }
}

/// The averaging kernel, for windows of one size.
#[derive(Debug)]
pub struct BoxMean(Kernel);

impl BoxMean {
    /// Source, bindings and constants of the kernel, for windows of `side` pixels, odd and at most 31.
    pub fn stage(side: u32) -> Stage {
        Stage {
            name: "box_mean",
            source: include_str!("../../../shaders/dense/box_mean.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("SIDE", side.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, side: u32) -> Self {
        Self(Kernel::new(gpu, &Self::stage(side)))
    }

    /// Averages the costs of each disparity over the windows of the pixels of `band`: first along rows, from `costs` to
    /// `means`, then along columns, back to the beginning of `costs`, where only the rows `wanted` of the band are
    /// kept. Windows beyond the band repeat its edge pixels.
    pub fn prepare(
        &self,
        band: &VolumeBand,
        wanted: Range<u32>,
        costs: &wgpu::Buffer,
        means: &wgpu::Buffer,
    ) -> [Dispatch; 2] {
        let (words, row) = (band.words(), band.row_words());
        let along_rows = Params {
            words,
            lines: band.rows,
            line_step: row,
            pixel_step: words,
            length: band.width,
            first: 0,
            wanted: band.width,
        };
        let along_columns = Params {
            words,
            lines: band.width,
            line_step: words,
            pixel_step: row,
            length: band.rows,
            first: wanted.start,
            wanted: wanted.end - wanted.start,
        };
        [(along_rows, costs, means), (along_columns, means, costs)].map(|(params, from, to)| {
            let groups = [words.div_ceil(WORKGROUP[0]), params.lines.div_ceil(WORKGROUP[1]), 1];
            self.0.dispatch(&params, &[from, to], groups)
        })
    }
}
