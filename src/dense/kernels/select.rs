//! The last path, and from the costs of all paths to disparities. `shaders/dense/select.wgsl`.

use super::{
    answer::{Wanted, answer_constants},
    path::{Params, line_constants},
    volume_band::VolumeBand,
};
use crate::{
    dense::config::{Direction, Interpolation, Penalties, SUM_INDEX_BITS},
    gpu::{Binding, Context, Dispatch, Kernel, ShaderType, Stage, uniform_buffer},
};

/// What is selected, and from what.
#[derive(Clone, Copy, Debug)]
pub struct Selection {
    /// How many paths stand in the volumes; one more is followed on the way.
    pub stored: u32,
    /// Sub-pixel interpolation.
    pub interpolation: Interpolation,
    /// Matches or winners.
    pub wanted: Wanted,
    /// Whether the winners' keys are wanted as well.
    pub keys: bool,
    /// Per cent by which the rival's cost must exceed the winner's.
    pub uniqueness: u32,
}

/// Where in their buffers things stand, in words.
#[derive(Clone, Copy, Debug)]
pub struct Places {
    /// The band's first row in the first path's volume.
    pub start: u32,
    /// From one path's volume to the next.
    pub volume_words: u32,
    /// The confidences.
    pub confidence_offset: u32,
    /// The winners' keys.
    pub key_offset: u32,
}

/// The kernel that follows the last path, sums the costs of all of them up, and decides.
pub struct Select {
    kernel: Kernel,
    selection: Selection,
}

impl Select {
    /// What the kernel is made of, for `words` words a pixel.
    pub fn stage(penalties: &Penalties, words: u32, selection: Selection) -> Stage {
        let mut constants = line_constants(penalties, words);
        constants.extend([("STORED", selection.stored.into()), ("KEYS", selection.keys.into())]);
        constants.extend(answer_constants(selection.interpolation, selection.wanted, SUM_INDEX_BITS));
        Stage {
            name: "select",
            source: include_str!("../../../shaders/dense/select.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write, Binding::Write],
            constants,
        }
    }

    /// Compiles it.
    pub fn new(device: &Context<'_>, penalties: &Penalties, words: u32, selection: Selection) -> Self {
        Self { kernel: Kernel::new(device, &Self::stage(penalties, words, selection)), selection }
    }

    /// Follows the last path, in `direction`, through a band of `costs`, as [`super::Path::prepare`] does, and decides. Its
    /// own costs are not stored. `matches` must be 0 before; the results stand there
    /// as [`super::BlockMatch::prepare`] leaves them, then the winners' keys.
    #[expect(clippy::too_many_arguments, reason = "four buffers, each of one kind")]
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        band: &VolumeBand,
        direction: Direction,
        places: Places,
        reference: &wgpu::Buffer,
        costs: &wgpu::Buffer,
        paths: &wgpu::Buffer,
        matches: &wgpu::Buffer,
    ) -> Dispatch {
        let Places { start, volume_words, confidence_offset, key_offset } = places;
        let params = Params {
            volumes_start: start,
            volume_words,
            uniqueness: self.selection.uniqueness,
            confidence_offset,
            key_offset,
            ..Params::new(band, direction, 0, false)
        };
        let uniforms = uniform_buffer(device, "select", &params);
        self.kernel.dispatch(device, &[&uniforms, reference, costs, paths, matches], params.groups())
    }
}
