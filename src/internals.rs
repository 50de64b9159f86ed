//! Kernels, twins and stages, for the regression suite and the tests of this crate. Nothing here is stable.

pub use crate::fnv::fnv1a;
pub use crate::gpu::{
    kernel::Dispatch,
    shader_struct::{Member, ShaderType, Shape},
    stage::{Binding, Stage},
    word_texture::WordTexture,
};

/// The CPU twins.
pub mod cpu {
    pub use crate::cpu::*;
}

/// The kernels that make luma.
pub mod luma {
    pub use crate::luma::kernels::*;
}

/// The kernels that resample a view.
pub mod rectify {
    pub use crate::rectify::kernels::*;
}

/// The kernels of interest points.
pub mod features {
    pub use crate::features::kernels::*;
}

/// The kernels of dense matching.
pub mod dense {
    pub use crate::dense::{
        config::{Direction, MAX_COST, WEIGHT_BITS},
        kernels::*,
        pyramid::{CellRange, CellTable, SIDE},
        reprojection::DepthTable,
        seen::Seen,
    };
}

/// The kernels of Kamencay's method, and its steps on the host.
pub mod kamencay {
    pub use crate::kamencay::{
        grid::{FAR, MAX_MESSAGE_BYTES, OVERLAP, Strip},
        kernels::*,
        links::Links,
        matcher::compute_within,
        method::described,
        segments::Segments,
    };
}

/// Every stage there is, for checks that need no GPU.
pub fn stages() -> Vec<Stage> {
    [
        crate::luma::kernels::stages(),
        crate::rectify::kernels::stages(),
        crate::features::kernels::stages(),
        crate::dense::kernels::stages(),
        crate::kamencay::kernels::stages(),
    ]
    .concat()
}
