//! A path of semi-global matching. `shaders/dense/path.wgsl`.

use super::{line_buffers::LineBuffers, volume_band::VolumeBand};
use crate::{
    dense::config::{Direction, Penalties},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: u32 = 16;

shader_struct! {
    /// The uniforms of both kernels that follow lines, as `path.wgsl` and `select.wgsl` declare them.
    pub(super) struct Params {
        pub(super) width: u32,
        pub(super) rows: u32,
        pub(super) first_row: u32,
        pub(super) path_start: u32,
        pub(super) goes_on: u32,
        pub(super) dx: i32,
        pub(super) dy: i32,
        pub(super) volumes_start: u32,
        pub(super) volume_words: u32,
        pub(super) min_disparity: i32,
        pub(super) disparities: u32,
        pub(super) uniqueness: u32,
        pub(super) confidence_offset: u32,
        pub(super) key_offset: u32,
    }
}

impl Params {
    /// For a path through `band`, whose costs stand from word `start` of the paths on; with `goes_on` the row
    /// before the band in the path's direction holds where lines come from. What concerns a selection is 0.
    pub(super) fn new(band: &VolumeBand, direction: Direction, start: u32, goes_on: bool) -> Self {
        Self {
            width: band.width,
            rows: band.rows,
            first_row: band.first_row,
            path_start: start,
            goes_on: goes_on.into(),
            dx: direction.dx,
            dy: direction.dy,
            min_disparity: band.range.min,
            disparities: band.range.count,
            ..bytemuck::Zeroable::zeroed()
        }
    }

    /// Workgroups of a kernel with a line a thread.
    pub(super) fn groups(&self) -> [u32; 3] {
        let lines = if self.dy == 0 { self.rows } else { self.width };
        [lines.div_ceil(WORKGROUP), 1, 1]
    }
}

/// The constants of all kernels that follow lines.
pub(super) fn line_constants(penalties: &Penalties, words: u32) -> Vec<(&'static str, i64)> {
    vec![
        ("WORKGROUP", WORKGROUP.into()),
        ("WORDS", words.into()),
        ("P1", penalties.p1.into()),
        ("P2", penalties.p2.into()),
        ("LEAST_P2", penalties.least_p2.into()),
        ("P2_SCALE", penalties.p2_scale.into()),
    ]
}

/// The kernel of a path, for one number of disparities.
#[derive(Debug)]
pub struct Path(Kernel);

impl Path {
    /// What the kernel is made of, for `words` words a pixel.
    pub fn stage(penalties: &Penalties, words: u32) -> Stage {
        Stage {
            name: "path",
            source: include_str!("../../../shaders/dense/path.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: line_constants(penalties, words),
        }
    }

    /// Compiles it.
    pub fn new(gpu: &Gpu, penalties: &Penalties, words: u32) -> Self {
        Self(Kernel::new(gpu, &Self::stage(penalties, words)))
    }

    /// Follows all lines of a direction through a band. The path's costs stand from word `start` of the paths on; with
    /// `goes_on` the row before it in the path's direction holds where lines come from.
    pub fn prepare(
        &self,
        band: &VolumeBand,
        direction: Direction,
        LineBuffers { reference, costs, paths }: LineBuffers<'_>,
        start: u32,
        goes_on: bool,
    ) -> Dispatch {
        let params = Params::new(band, direction, start, goes_on);
        self.0.dispatch(&params, &[reference, costs, paths], params.groups())
    }
}
