//! A path of semi-global matching through cells with ranges of their own. `shaders/dense/cell_path.wgsl`.

use super::{
    cell_layout::{GRAIN, LevelBand, layout_constants},
    line_buffers::LineBuffers,
    path::penalty_constants,
};
use crate::{
    dense::config::{Direction, Penalties},
    gpu::{Binding, Dispatch, Gpu, Kernel, MOST_TURNS, ShaderType, Stage, shader_struct},
};

const WORKGROUP: u32 = 16;

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        top: u32,
        first_row: u32,
        path_start: u32,
        halo_start: u32,
        goes_on: u32,
        skipped: u32,
        steps: u32,
        dx: i32,
        dy: i32,
        columns: u32,
        cells: u32,
    }
}

/// The kernel of a path through cells.
#[derive(Debug)]
pub struct CellPath(Kernel);

impl CellPath {
    /// Source, bindings and constants of the kernel.
    pub fn stage(penalties: &Penalties) -> Stage {
        let mut constants = vec![("WORKGROUP", WORKGROUP.into())];
        constants.extend(penalty_constants(penalties));
        constants.extend(layout_constants());
        Stage {
            name: "cell_path",
            source: include_str!("../../../shaders/dense/cell_path.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write, Binding::Words],
            constants,
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, penalties: &Penalties) -> Self {
        Self(Kernel::new(gpu, &Self::stage(penalties)))
    }

    /// Follows all lines of `direction` through `band`, one part of the lines after the other. The path's costs begin at word `start` of the
    /// paths. Lines continue from the row before the band in the path's direction, whose costs are at word `halo`, if there is one.
    pub fn prepare(
        &self,
        band: &LevelBand<'_>,
        direction: Direction,
        LineBuffers { reference, costs, paths }: LineBuffers<'_>,
        start: u32,
        halo: Option<u32>,
    ) -> Vec<Dispatch> {
        let &LevelBand { layout, width, top, first_row, rows } = band;
        let (lines, length) = if direction.dy == 0 { (rows, width) } else { (width, rows) };
        // A pixel takes a turn, the turns of its loop and that in which the loop ends; the pixel before the part has such a loop too.
        let most_steps = MOST_TURNS / (layout.most_words / GRAIN + 2) - 1;
        let part = |skipped: u32| {
            let params = Params {
                width,
                rows,
                top,
                first_row,
                path_start: start,
                halo_start: halo.unwrap_or(0),
                goes_on: (skipped > 0 || halo.is_some()).into(),
                skipped,
                steps: most_steps.min(length - skipped),
                dx: direction.dx,
                dy: direction.dy,
                columns: layout.columns,
                cells: layout.cells,
            };
            let groups = [lines.div_ceil(WORKGROUP), 1, 1];
            self.0.dispatch(&params, &[reference, costs, paths, &layout.words.view], groups)
        };
        (0..length).step_by(most_steps as usize).map(part).collect()
    }
}
