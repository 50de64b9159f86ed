//! Paths of semi-global matching, several at once, with threads across disparities. `shaders/dense/lane_path.wgsl`.

use super::{
    lanes::Lanes,
    line_buffers::{LineBuffers, PathVolumes},
    path::penalty_constants,
    volume_band::VolumeBand,
};
use crate::{
    dense::config::{Direction, Penalties},
    gpu::{Binding, Dispatch, Exchange, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

/// Pixels of a line that are loaded early.
const AHEAD: i64 = 4;

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_row: u32,
        volumes_start: u32,
        volume_quads: u32,
        quads: u32,
        lanes: u32,
        steps_x: u32,
        steps_y: u32,
        goes_on: u32,
    }
}

/// A path to be followed, and whether its lines continue from the row before the band in its direction.
pub type FollowedPath = (Direction, bool);

/// The kernel of several paths, for any number of disparities that a workgroup can share.
#[derive(Debug)]
pub struct LanePath {
    kernel: Kernel,
    lanes: Lanes,
}

impl LanePath {
    /// Source, bindings and constants of the kernel, with so many threads per workgroup.
    pub fn stage(penalties: &Penalties, threads: u32, exchange: Exchange) -> Stage {
        let mut constants = vec![("WORKGROUP", threads.into()), ("AHEAD", AHEAD)];
        constants.extend(penalty_constants(penalties));
        let source = match exchange {
            Exchange::Memory => {
                concat!("#import exchange_memory\n", include_str!("../../../shaders/dense/lane_path.wgsl"))
            }
            Exchange::Subgroups => {
                concat!("#import exchange_subgroups\n", include_str!("../../../shaders/dense/lane_path.wgsl"))
            }
        };
        Stage {
            name: "lane_path",
            source,
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants,
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, penalties: &Penalties, lanes: Lanes) -> Self {
        Self { kernel: Kernel::new(gpu, &Self::stage(penalties, lanes.threads, lanes.exchange)), lanes }
    }

    /// Follows all lines of `paths` through `band`, one volume per path. Lines that continue find the path costs of the
    /// row before the band in front of the band in their volume, or behind the band.
    pub fn prepare(
        &self,
        band: &VolumeBand,
        paths: &[FollowedPath],
        LineBuffers { reference, costs, paths: volumes }: LineBuffers<'_>,
        PathVolumes { start, volume_words }: PathVolumes,
    ) -> Dispatch {
        let steps = |step: fn(Direction) -> i32| {
            (0..).zip(paths).map(|(number, &(direction, _))| ((step(direction) + 1) as u32) << (2 * number)).sum()
        };
        let params = Params {
            width: band.width,
            rows: band.rows,
            first_row: band.first_row,
            volumes_start: start / 4,
            volume_quads: volume_words / 4,
            quads: self.lanes.quads,
            lanes: self.lanes.lanes,
            steps_x: steps(|direction| direction.dx),
            steps_y: steps(|direction| direction.dy),
            goes_on: (0..).zip(paths).map(|(number, &(_, goes_on))| u32::from(goes_on) << number).sum(),
        };
        let lines = |&(direction, _): &FollowedPath| if direction.dy == 0 { band.rows } else { band.width };
        let most_lines = paths.iter().map(lines).max().unwrap_or(0);
        let groups = [most_lines.div_ceil(self.lanes.per_workgroup()), paths.len() as u32, 1];
        self.kernel.dispatch(&params, &[reference, costs, volumes], groups)
    }
}
