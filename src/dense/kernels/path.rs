//! A path of semi-global matching (Hirschmueller, PAMI 2008). `shaders/dense/path.wgsl`.

use super::{line_buffers::LineBuffers, volume_band::VolumeBand};
use crate::{
    dense::config::{Direction, Penalties},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: u32 = 16;

/// Operations of a step per disparity: three minima, P1, the matching cost, M, and the minimum that becomes the next M.
pub(super) const STEP_OPERATIONS: u64 = 7;

shader_struct! {
    /// Uniforms of both path kernels, as `path.wgsl` and `select.wgsl` declare them.
    pub(super) struct Params {
        pub(super) width: u32,
        pub(super) rows: u32,
        pub(super) first_row: u32,
        pub(super) path_start: u32,
        pub(super) goes_on: u32,
        pub(super) dx: i32,
        pub(super) dy: i32,
        pub(super) volumes_start: u32,
        pub(super) volume_quads: u32,
        pub(super) min_disparity: i32,
        pub(super) disparities: u32,
        pub(super) uniqueness: u32,
        pub(super) confidence_offset: u32,
        pub(super) key_offset: u32,
    }
}

impl Params {
    /// Uniforms of a path through `band`, whose costs begin at word `start` of the paths. With `goes_on`, lines
    /// continue from the row before the band in the path's direction. The fields of a selection are 0.
    pub(super) fn new(band: &VolumeBand, direction: Direction, start: u32, goes_on: bool) -> Self {
        Self {
            width: band.width,
            rows: band.rows,
            first_row: band.first_row,
            path_start: start / 4,
            goes_on: goes_on.into(),
            dx: direction.dx,
            dy: direction.dy,
            min_disparity: band.range.min,
            disparities: band.range.count,
            ..bytemuck::Zeroable::zeroed()
        }
    }

    /// Workgroups of a kernel with one line per thread.
    pub(super) fn groups(&self) -> [u32; 3] {
        let lines = if self.dy == 0 { self.rows } else { self.width };
        [lines.div_ceil(WORKGROUP), 1, 1]
    }
}

/// Constants of both path kernels.
pub(super) fn line_constants(penalties: &Penalties, words: u32) -> Vec<(&'static str, i64)> {
    let mut constants = vec![("WORKGROUP", WORKGROUP.into()), ("WORDS", words.into()), ("QUADS", (words / 4).into())];
    constants.extend(penalty_constants(penalties));
    constants
}

/// Constants of `shaders/shared/path_step.wgsl`.
pub(super) fn penalty_constants(penalties: &Penalties) -> [(&'static str, i64); 4] {
    [
        ("P1", penalties.p1.into()),
        ("P2", penalties.p2.into()),
        ("LEAST_P2", penalties.least_p2.into()),
        ("P2_SCALE", penalties.p2_scale.into()),
    ]
}

/// The path kernel, for one number of disparities.
#[derive(Debug)]
pub struct Path(Kernel);

impl Path {
    /// Source, bindings and constants of the kernel, for `words` words per pixel.
    pub fn stage(penalties: &Penalties, words: u32) -> Stage {
        Stage {
            name: "path",
            source: include_str!("../../../shaders/dense/path.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: line_constants(penalties, words),
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, penalties: &Penalties, words: u32) -> Self {
        Self(Kernel::new(gpu, &Self::stage(penalties, words)))
    }

    /// Follows all lines of `direction` through `band`. The path's costs begin at word `start` of the paths. With
    /// `goes_on`, lines continue from the row before the band in the path's direction.
    pub fn prepare(
        &self,
        band: &VolumeBand,
        direction: Direction,
        LineBuffers { reference, costs, paths }: LineBuffers<'_>,
        start: u32,
        goes_on: bool,
    ) -> Dispatch {
        let params = Params::new(band, direction, start, goes_on);
        let dispatch = self.0.dispatch(&params, &[reference, costs, paths], params.groups());
        dispatch.moving(band.followed_bytes()).counting(STEP_OPERATIONS * band.values())
    }
}
