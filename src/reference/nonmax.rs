//! Non-maximum suppression in 3x3x3, and where between the samples a maximum lies.

use rayon::prelude::*;

use crate::reference::hessian::{Octave, RESPONSE_SCALE, Response, fits};

/// A sample of the response that beats its 26 neighbours. The derived order is that of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Candidate {
    /// Octave, from 0.
    pub octave: u32,
    /// Middle interval, 1 or 2.
    pub layer: u32,
    /// Row of the octave's grid.
    pub j: u32,
    /// Column of the octave's grid.
    pub i: u32,
}

/// A candidate's place between the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum {
    /// Column in pixels.
    pub x: f32,
    /// Row in pixels.
    pub y: f32,
    /// Standard deviation of the Gaussian that the filter stands for, in pixels.
    pub scale: f32,
    /// The sample's determinant on OpenSURF's scale.
    pub response: f32,
    /// Whether the trace of the Hessian is positive.
    pub dark: bool,
}

/// A threshold on OpenSURF's scale as the least determinant that passes; never 0, which is flat.
pub fn integer_threshold(threshold: f32) -> i32 {
    (f64::from(threshold) * RESPONSE_SCALE).round().max(1.0) as i32
}

/// The maxima of an octave that reach `threshold`, in the order of [`Candidate`].
///
/// `width` and `height` are the picture's.
pub fn candidates(octave: &Octave, width: u32, height: u32, threshold: i32) -> Vec<Candidate> {
    let (columns, rows) = octave.layers[0].size();
    let inner = |length: u32| 1..length.max(1) - 1;
    [1, 2]
        .into_iter()
        .flat_map(|layer| inner(rows).map(move |j| (layer, j)))
        .collect::<Vec<_>>()
        .into_par_iter()
        .flat_map_iter(|(layer, j)| inner(columns).map(move |i| Candidate { octave: octave.index, layer, j, i }))
        .filter(|&candidate| is_maximum(octave, width, height, candidate, threshold))
        .collect()
}

fn is_maximum(octave: &Octave, width: u32, height: u32, at: Candidate, threshold: i32) -> bool {
    let value = determinant(octave, at, [0, 0, 0]);
    if value < threshold {
        return false;
    }
    // The largest of the three filters decides: next to a sample that could not be computed there
    // is no telling a maximum.
    let size = octave.sizes()[at.layer as usize + 1];
    let inside = |i: u32, j: u32| fits(width, height, i * octave.spacing, j * octave.spacing, size);
    if !inside(at.i - 1, at.j - 1) || !inside(at.i + 1, at.j + 1) {
        return false;
    }
    // Of equal neighbours the last one is the maximum, so that a plateau has exactly one.
    neighbours().all(|offset| {
        let neighbour = determinant(octave, at, offset);
        if offset < [0, 0, 0] { value > neighbour } else { value >= neighbour }
    })
}

/// The 26 offsets `[layer, j, i]`.
fn neighbours() -> impl Iterator<Item = [i32; 3]> {
    let around = -1..=1;
    let offsets = around.clone().flat_map(move |layer| {
        let around = -1..=1;
        around.clone().flat_map(move |j| around.clone().map(move |i| [layer, j, i]))
    });
    offsets.filter(|&offset| offset != [0, 0, 0])
}

fn response(octave: &Octave, at: Candidate, [layer, j, i]: [i32; 3]) -> Response {
    let plane = &octave.layers[at.layer.wrapping_add_signed(layer) as usize];
    plane.get(at.i.wrapping_add_signed(i), at.j.wrapping_add_signed(j))
}

fn determinant(octave: &Octave, at: Candidate, offset: [i32; 3]) -> i32 {
    response(octave, at, offset).determinant()
}

/// Where the quadric through a candidate and its neighbours has its maximum (Brown and Lowe,
/// 'Invariant Features from Interest Point Groups', BMVC 2002); `None` where that is not near.
pub fn locate(octave: &Octave, at: Candidate) -> Option<Extremum> {
    let [dx, dy, ds] = offset(octave, at)?;
    if [dx, dy, ds].iter().any(|offset| offset.abs() > 0.5) {
        return None;
    }
    let sizes = octave.sizes().map(|size| size as f32);
    let layer = at.layer as usize;
    let size = sizes[layer] + (sizes[layer] - sizes[layer - 1]) * ds;
    let response = response(octave, at, [0, 0, 0]);
    Some(Extremum {
        x: (at.i as f32 + dx) * octave.spacing as f32,
        y: (at.j as f32 + dy) * octave.spacing as f32,
        scale: 1.2 * size / 9.0,
        response: (f64::from(response.determinant()) / RESPONSE_SCALE) as f32,
        dark: response.dark(),
    })
}

/// `[x, y, layer]` of the quadric's extremum from the candidate, in samples.
fn offset(octave: &Octave, at: Candidate) -> Option<[f32; 3]> {
    let d = |x: i32, y: i32, s: i32| determinant(octave, at, [s, y, x]) as f32;
    let centre = d(0, 0, 0);
    let gradient = glam::Vec3::new(
        (d(1, 0, 0) - d(-1, 0, 0)) / 2.0,
        (d(0, 1, 0) - d(0, -1, 0)) / 2.0,
        (d(0, 0, 1) - d(0, 0, -1)) / 2.0,
    );
    let xx = d(1, 0, 0) + d(-1, 0, 0) - 2.0 * centre;
    let yy = d(0, 1, 0) + d(0, -1, 0) - 2.0 * centre;
    let ss = d(0, 0, 1) + d(0, 0, -1) - 2.0 * centre;
    let xy = (d(1, 1, 0) - d(-1, 1, 0) - d(1, -1, 0) + d(-1, -1, 0)) / 4.0;
    let xs = (d(1, 0, 1) - d(-1, 0, 1) - d(1, 0, -1) + d(-1, 0, -1)) / 4.0;
    let ys = (d(0, 1, 1) - d(0, -1, 1) - d(0, 1, -1) + d(0, -1, -1)) / 4.0;
    let hessian = glam::Mat3::from_cols_array(&[xx, xy, xs, xy, yy, ys, xs, ys, ss]);
    if hessian.determinant() == 0.0 {
        return None;
    }
    Some((hessian.inverse() * -gradient).to_array())
}
