//! The last path, and from the costs of all paths to disparities. `shaders/dense/select.wgsl`.

use super::{
    line_buffers::{LineBuffers, PathVolumes},
    map_buffer::MapBuffer,
    path::{Params, line_constants},
    selection::{ResultKind, selection_constants},
    volume_band::VolumeBand,
};
use crate::{
    dense::config::{Direction, Interpolation, Penalties, SUM_INDEX_BITS},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage},
};

/// What is selected, and from what.
#[derive(Clone, Copy, Debug)]
pub struct Selection {
    /// How many paths stand in the volumes; one more is followed on the way.
    pub stored: u32,
    /// Sub-pixel interpolation.
    pub interpolation: Interpolation,
    /// Matches or winners.
    pub wanted: ResultKind,
    /// Whether the winners' keys are wanted as well.
    pub keys: bool,
    /// Per cent by which the rival's cost must exceed the winner's.
    pub uniqueness: u32,
}

/// The kernel that follows the last path, sums the costs of all of them up, and decides.
#[derive(Debug)]
pub struct Select {
    kernel: Kernel,
    selection: Selection,
}

impl Select {
    /// What the kernel is made of, for `words` words a pixel.
    pub fn stage(penalties: &Penalties, words: u32, selection: Selection) -> Stage {
        let mut constants = line_constants(penalties, words);
        constants.extend([("STORED", selection.stored.into()), ("KEYS", selection.keys.into())]);
        constants.extend(selection_constants(selection.interpolation, selection.wanted, SUM_INDEX_BITS));
        Stage {
            name: "select",
            source: include_str!("../../../shaders/dense/select.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write, Binding::Write],
            constants,
        }
    }

    /// Compiles it.
    pub fn new(gpu: &Gpu, penalties: &Penalties, words: u32, selection: Selection) -> Self {
        Self { kernel: Kernel::new(gpu, &Self::stage(penalties, words, selection)), selection }
    }

    /// Follows the last path, in `direction`, through a band, as [`super::Path::prepare`] does, and decides. The path's own
    /// costs are not stored. The `matches` must be 0 before; the results stand there as their layout says, the winners' keys
    /// behind them.
    pub fn prepare(
        &self,
        band: &VolumeBand,
        direction: Direction,
        LineBuffers { reference, costs, paths }: LineBuffers<'_>,
        volumes: PathVolumes,
        matches: MapBuffer<'_>,
    ) -> Dispatch {
        let params = Params {
            volumes_start: volumes.start,
            volume_words: volumes.volume_words,
            uniqueness: self.selection.uniqueness,
            confidence_offset: matches.layout.confidence_offset(),
            key_offset: matches.layout.key_offset(),
            ..Params::new(band, direction, 0, false)
        };
        self.kernel.dispatch(&params, &[reference, costs, paths, matches.buffer], params.groups())
    }
}
