//! The last path, and the selection of disparities by the summed costs of all paths. `shaders/dense/select.wgsl`.

use super::{
    line_buffers::{LineBuffers, PathVolumes},
    map_buffer::MapBuffer,
    path::{Params, STEP_OPERATIONS, line_constants},
    selection::{ResultKind, SELECTION_OPERATIONS, selection_constants},
    volume_band::VolumeBand,
};
use crate::{
    dense::config::{Direction, Interpolation, Penalties, SUM_INDEX_BITS},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage},
};

/// Inputs and outputs of the selection.
#[derive(Clone, Copy, Debug)]
pub struct Selection {
    /// Number of stored paths; [`Select`] follows one more itself.
    pub stored: u32,
    /// Sub-pixel interpolation.
    pub interpolation: Interpolation,
    /// Matches or winners.
    pub kind: ResultKind,
    /// Whether the winners' keys are written too.
    pub keys: bool,
    /// Uniqueness: percentage by which the rival's cost must exceed the winner's, 0 to 100.
    pub uniqueness: u32,
}

/// The kernel that follows the last path, sums the costs of all paths and selects disparities.
#[derive(Debug)]
pub struct Select {
    kernel: Kernel,
    selection: Selection,
}

impl Select {
    /// Source, bindings and constants of the kernel, for `words` words per pixel.
    pub fn stage(penalties: &Penalties, words: u32, selection: Selection) -> Stage {
        let mut constants = line_constants(penalties, words);
        constants.extend([("STORED", selection.stored.into()), ("KEYS", selection.keys.into())]);
        constants.extend(selection_constants(selection.interpolation, selection.kind, SUM_INDEX_BITS));
        Stage {
            name: "select",
            source: include_str!("../../../shaders/dense/select.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write, Binding::Write],
            constants,
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, penalties: &Penalties, words: u32, selection: Selection) -> Self {
        Self { kernel: Kernel::new(gpu, &Self::stage(penalties, words, selection)), selection }
    }

    /// Follows the last path, in `direction`, through `band`, as [`super::Path::prepare`] does, and selects
    /// disparities. Costs of the last path are not stored. `matches` must be cleared to 0 before; results are written
    /// by its layout, the winners' keys behind them.
    pub fn prepare(
        &self,
        band: &VolumeBand,
        direction: Direction,
        LineBuffers { reference, costs, paths }: LineBuffers<'_>,
        volumes: PathVolumes,
        matches: MapBuffer<'_>,
    ) -> Dispatch {
        let params = Params {
            volumes_start: volumes.start / 4,
            volume_quads: volumes.volume_words / 4,
            uniqueness: self.selection.uniqueness,
            confidence_offset: matches.layout.confidence_offset(),
            key_offset: matches.layout.key_offset(),
            ..Params::new(band, direction, 0, false)
        };
        let operations = STEP_OPERATIONS + u64::from(self.selection.stored) + SELECTION_OPERATIONS;
        let dispatch = self.kernel.dispatch(&params, &[reference, costs, paths, matches.buffer], params.groups());
        dispatch.counting(operations * band.values())
    }
}
