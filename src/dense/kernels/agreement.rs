//! Agreement: the removal of disparities that too few of eight neighbours share. `shaders/dense/agreement.wgsl`.

use super::{
    map_buffer::{MapBuffer, MapLayout},
    rows_per_thread::{ROWS_HARDWARE, ROWS_SOFTWARE},
};
use crate::{
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ROW_BITS, ShaderType, Stage, WordTexture, shader_struct},
};

const WORKGROUP: [u32; 2] = [8, 8];

/// Distance of the neighbours along rows and columns, in pixels.
pub const AGREEMENT_REACH: u32 = 3;

/// Largest difference of disparities that agree, in 1/256 px: a road seen from a car changes by 1.5 px over the reach.
pub const AGREEMENT_TOLERANCE: i32 = 2 * SCALE;

/// A sentinel that differs from every disparity by more than the tolerance.
const FAR: i64 = 1 << 30;

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        confidence_offset: u32,
        least: u32,
    }
}

/// The pixels of a thread: quads of four neighbouring pixels per row, and rows, [`AGREEMENT_REACH`] apart. Software drivers
/// load from textures for eight threads at once: a wide thread shares most of its loads.
#[derive(Clone, Copy, Debug)]
pub struct AgreementTile {
    /// Quads of four neighbouring pixels per row.
    pub quads: u32,
    /// Rows.
    pub rows: u32,
}

impl AgreementTile {
    /// For lavapipe.
    pub const SOFTWARE: Self = Self { quads: 4, rows: ROWS_SOFTWARE };

    /// For all other devices: GPUs prefer many threads.
    pub const HARDWARE: Self = Self { quads: 1, rows: ROWS_HARDWARE };
}

/// The kernel that drops disparities without agreement.
#[derive(Debug)]
pub struct Agreement {
    kernel: Kernel,
    tile: AgreementTile,
}

impl Agreement {
    /// Source, bindings and constants of the kernel.
    pub fn stage(AgreementTile { quads, rows }: AgreementTile) -> Stage {
        Stage {
            name: "agreement",
            source: include_str!("../../../shaders/dense/agreement.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Words, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("REACH", AGREEMENT_REACH.into()),
                ("QUADS", quads.into()),
                ("SPAN", (4 * quads + 2 * AGREEMENT_REACH).into()),
                ("ROWS", rows.into()),
                ("TOLERANCE", AGREEMENT_TOLERANCE.into()),
                ("ROW_BITS", ROW_BITS.into()),
                ("NONE", NONE.into()),
                ("FAR", FAR),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        let tile = if gpu.is_lavapipe() { AgreementTile::SOFTWARE } else { AgreementTile::HARDWARE };
        Self { kernel: Kernel::new(gpu, &Self::stage(tile)), tile }
    }

    /// Drops from `matches` the disparities that fewer than `least` of the nine pixels share. `words` holds the words of
    /// `matches`.
    pub fn prepare(&self, words: &WordTexture, least: u32, matches: MapBuffer<'_>) -> Dispatch {
        let MapLayout { width, rows: height } = matches.layout;
        let AgreementTile { quads, rows } = self.tile;
        let params = Params { width, height, confidence_offset: matches.layout.confidence_offset(), least };
        let threads = height.div_ceil(AGREEMENT_REACH * rows) * AGREEMENT_REACH;
        let groups = [width.div_ceil(4 * quads * WORKGROUP[0]), threads.div_ceil(WORKGROUP[1]), 1];
        self.kernel.dispatch(&params, &[&words.view, matches.buffer], groups)
    }
}
