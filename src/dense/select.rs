//! From the costs of all paths to disparities. `shaders/select.wgsl`.

use bytemuck::{Pod, Zeroable};

use super::{band::VolumeBand, block_match::Wanted, config::Interpolation};
use crate::{
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Kernel, Stage, uniform_buffer},
};

const WORKGROUP: [u32; 2] = [16, 4];

/// The bits of a key that hold the disparity's index.
pub(super) const INDEX_BITS: u32 = 16;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Params {
    width: u32,
    rows: u32,
    words: u32,
    start: u32,
    volume_words: u32,
    min_disparity: i32,
    disparities: u32,
    uniqueness: u32,
    confidence_offset: u32,
    key_offset: u32,
}

/// The kernel that sums the costs of all paths up and decides.
pub struct Select {
    kernel: Kernel,
    uniqueness: u32,
}

impl Select {
    /// What the kernel is made of, for so many paths; `keys`: the winners' keys are wanted as well.
    pub fn stage(paths: u32, interpolation: Interpolation, wanted: Wanted, keys: bool) -> Stage {
        Stage {
            name: "select",
            source: concat!(
                include_str!("../../shaders/shared/quotient.wgsl"),
                include_str!("../../shaders/shared/selection.wgsl"),
                include_str!("../../shaders/select.wgsl")
            ),
            bindings: &[Binding::Uniform(size_of::<Params>() as u64), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("PATHS", paths.into()),
                ("SHIFT", INDEX_BITS.into()),
                ("SCALE", SCALE.into()),
                ("NONE", NONE.into()),
                ("FULL", (wanted == Wanted::Matches).into()),
                ("KEYS", keys.into()),
                ("PARABOLA", 1),
                ("EQUIANGULAR", 2),
                ("INTERPOLATION", interpolation.code()),
            ],
        }
    }

    /// Compiles it.
    pub fn new(
        device: &wgpu::Device,
        paths: u32,
        interpolation: Interpolation,
        wanted: Wanted,
        keys: bool,
        uniqueness: u32,
    ) -> Self {
        Self { kernel: Kernel::new(device, &Self::stage(paths, interpolation, wanted, keys)), uniqueness }
    }

    /// Decides a band, whose first volume begins at word `start` of `volumes` and each further one
    /// `volume_words` words later; the results as [`super::BlockMatch::prepare`] leaves them, with the
    /// winners' keys from word `key_offset` on if they are wanted.
    #[expect(clippy::too_many_arguments, reason = "two buffers, and places in them")]
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        band: &VolumeBand,
        volumes: &wgpu::Buffer,
        start: u32,
        volume_words: u32,
        matches: &wgpu::Buffer,
        [confidence_offset, key_offset]: [u32; 2],
    ) -> Dispatch {
        let params = Params {
            width: band.width,
            rows: band.rows,
            words: band.words(),
            start,
            volume_words,
            min_disparity: band.range.min,
            disparities: band.range.count,
            uniqueness: self.uniqueness,
            confidence_offset,
            key_offset,
        };
        let groups = [band.width.div_ceil(4 * WORKGROUP[0]), band.rows.div_ceil(WORKGROUP[1]), 1];
        let params = uniform_buffer(device, "select", &params);
        self.kernel.dispatch(device, &[&params, volumes, matches], groups)
    }
}
