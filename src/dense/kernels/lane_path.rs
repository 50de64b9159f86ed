//! Paths of semi-global matching, several at once, with threads across disparities. `shaders/dense/lane_path.wgsl`.

use super::{
    lanes::Lanes,
    line_buffers::{LineBuffers, PathVolumes},
    path::{STEP_OPERATIONS, penalty_constants},
    volume_band::VolumeBand,
};
use crate::{
    dense::config::{Direction, Penalties},
    gpu::{Binding, Dispatch, Exchange, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

/// The text with the parts of an exchange and of a number of words per thread.
macro_rules! text {
    ($exchange:literal, $words:literal) => {
        concat!(
            "#import ",
            $exchange,
            "\n#import ",
            $words,
            "\n",
            include_str!("../../../shaders/dense/lane_path.wgsl")
        )
    };
}

/// Pixels of a line that are loaded early.
const AHEAD: i64 = 4;

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_row: u32,
        volumes_start: u32,
        volume_length: u32,
        elements: u32,
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
    /// Source, bindings and constants of the kernel, with so many words per thread, 1, 2 or 4, and so many threads per workgroup.
    pub fn stage(penalties: &Penalties, words: u32, threads: u32, exchange: Exchange) -> Stage {
        let mut constants = vec![("WORKGROUP", threads.into()), ("AHEAD", AHEAD), ("LANE_WORDS", words.into())];
        constants.extend(penalty_constants(penalties));
        let source = match (exchange, words) {
            (Exchange::Memory, 1) => text!("exchange_memory", "lane_words_1"),
            (Exchange::Memory, 2) => text!("exchange_memory", "lane_words_2"),
            (Exchange::Memory, _) => text!("exchange_memory", "lane_words_4"),
            (Exchange::Subgroups, 1) => text!("exchange_subgroups", "lane_words_1"),
            (Exchange::Subgroups, 2) => text!("exchange_subgroups", "lane_words_2"),
            (Exchange::Subgroups, _) => text!("exchange_subgroups", "lane_words_4"),
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
        Self { kernel: Kernel::new(gpu, &Self::stage(penalties, lanes.words, lanes.threads, lanes.exchange)), lanes }
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
            volumes_start: start / self.lanes.words,
            volume_length: volume_words / self.lanes.words,
            elements: self.lanes.busy,
            lanes: self.lanes.lanes,
            steps_x: steps(|direction| direction.dx),
            steps_y: steps(|direction| direction.dy),
            goes_on: (0..).zip(paths).map(|(number, &(_, goes_on))| u32::from(goes_on) << number).sum(),
        };
        let lines = |&(direction, _): &FollowedPath| if direction.dy == 0 { band.rows } else { band.width };
        let most_lines = paths.iter().map(lines).max().unwrap_or(0);
        let groups = [most_lines.div_ceil(self.lanes.per_workgroup()), paths.len() as u32, 1];
        let dispatch = self.kernel.dispatch(&params, &[reference, costs, volumes], groups);
        let paths = paths.len() as u64;
        dispatch.moving(paths * band.followed_bytes()).counting(paths * STEP_OPERATIONS * band.values())
    }
}
