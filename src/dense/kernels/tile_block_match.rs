//! Block matching with a tile per workgroup. `shaders/dense/tile_block_match.wgsl`.

use super::{
    block_match::{Tile, margin, search_constants},
    selection::ResultKind,
};
use crate::{
    dense::config::{DenseParameters, View},
    gpu::{Binding, ShaderType, Stage},
};

/// Columns of pixels per workgroup.
const COLUMNS: u32 = 4 * Tile::HARDWARE.quads;

/// Source, bindings and constants of the kernel of [`Tile::HARDWARE`].
pub(super) fn stage(parameters: &DenseParameters, view: View, kind: ResultKind) -> Stage {
    let radius = parameters.radius();
    let mut constants = vec![
        ("COLUMNS", COLUMNS.into()),
        ("ROWS", Tile::HARDWARE.height.into()),
        ("SIDE", parameters.window().into()),
        ("FIRST", (margin(radius) - radius).into()),
    ];
    constants.extend(search_constants(parameters, view, kind));
    Stage {
        name: "tile_block_match",
        source: include_str!("../../../shaders/dense/tile_block_match.wgsl"),
        bindings: &[
            Binding::Uniform(super::block_match::Params::SHAPE),
            Binding::Words,
            Binding::Read,
            Binding::Words,
            Binding::Write,
        ],
        constants,
    }
}
