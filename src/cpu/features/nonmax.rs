//! Non-maximum suppression in 3x3x3 samples, and interpolation of a maximum's position between them.

use rayon::prelude::*;

use crate::{
    cpu::features::hessian::{FILTER_SIZES, Octave, RESPONSE_SCALE, Response, fits},
    image::Size,
};

/// Standard deviation, in pixels, of the Gaussian that the smallest filter approximates (Bay et al., section 3.3).
const SMALLEST_SCALE: f32 = 1.2;

/// A sample whose response exceeds its 26 neighbours. The derived order is that of the final list.
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

/// The interpolated position of a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum {
    /// Column, in pixels.
    pub x: f32,
    /// Row, in pixels.
    pub y: f32,
    /// Scale, in pixels: the standard deviation of the Gaussian that the filter approximates.
    pub scale: f32,
    /// Determinant of the sample, on OpenSURF's scale.
    pub response: f32,
    /// Whether the trace of the Hessian is positive.
    pub dark: bool,
}

/// Converts a threshold on OpenSURF's scale to the least accepted determinant, at least 1, since 0 is flat.
pub fn integer_threshold(threshold: f32) -> i32 {
    (f64::from(threshold) * RESPONSE_SCALE).round().max(1.0) as i32
}

/// The maxima of an octave that reach `threshold`, in the order of [`Candidate`].
///
/// `width` and `height` are those of the picture, in pixels.
pub fn candidates(octave: &Octave, width: u32, height: u32, threshold: i32) -> Vec<Candidate> {
    let Size { width: columns, height: rows } = octave.layers[0].size();
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
    // The largest of the three filters decides: next to a sample that could not be computed, a maximum cannot be told.
    let size = octave.sizes()[at.layer as usize + 1];
    let inside = |i: u32, j: u32| fits(width, height, i * octave.spacing, j * octave.spacing, size);
    if !inside(at.i - 1, at.j - 1) || !inside(at.i + 1, at.j + 1) {
        return false;
    }
    // The first of equal neighbours is the maximum, so that a plateau has only one.
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

/// Interpolates the position of a candidate's maximum.
pub fn locate(octave: &Octave, at: Candidate) -> Extremum {
    let along = |[layer, j, i]: [i32; 3]| {
        let value = determinant(octave, at, [0, 0, 0]);
        vertex(determinant(octave, at, [-layer, -j, -i]), value, determinant(octave, at, [layer, j, i]))
    };
    let sizes = octave.sizes().map(|size| size as f32);
    let layer = at.layer as usize;
    let size = sizes[layer] + (sizes[layer] - sizes[layer - 1]) * along([1, 0, 0]);
    let response = response(octave, at, [0, 0, 0]);
    Extremum {
        x: (at.i as f32 + along([0, 0, 1])) * octave.spacing as f32,
        y: (at.j as f32 + along([0, 1, 0])) * octave.spacing as f32,
        scale: SMALLEST_SCALE * size / FILTER_SIZES[0][0] as f32,
        response: (f64::from(response.determinant()) / RESPONSE_SCALE) as f32,
        dark: response.dark(),
    }
}

/// The vertex of the parabola through three samples, relative to the middle one, -0.5 to 0.5.
///
/// Axes are interpolated one at a time instead of by one quadric in three dimensions (Brown and Lowe, BMVC 2002): on
/// real pairs as accurate within half a percent of the matches, never singular, never far off, and the same on every
/// device but for the rounding of one division.
fn vertex(before: i32, value: i32, after: i32) -> f32 {
    let (before, value, after) = (i64::from(before), i64::from(value), i64::from(after));
    let curvature = 2 * value - before - after;
    if curvature == 0 { 0.0 } else { 0.5 * (after - before) as f32 / curvature as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        cpu::features::integral::IntegralImage,
        image::{Luma, Plane},
    };

    /// A first octave with determinants `f(x, y, layer)`.
    fn octave(width: u32, height: u32, f: impl Fn(i32, i32, i32) -> i32) -> Octave {
        let layers = [0, 1, 2, 3]
            .map(|layer| Plane::from_fn((width, height), |x, y| Response(f(x as i32, y as i32, layer) << 1)));
        Octave { index: 0, spacing: 1, layers }
    }

    fn places(candidates: &[Candidate]) -> Vec<(u32, u32, u32)> {
        candidates.iter().map(|candidate| (candidate.i, candidate.j, candidate.layer)).collect()
    }

    #[test]
    fn a_peak_is_found_if_it_reaches_the_threshold() {
        let peak = octave(41, 41, |x, y, s| if (x, y, s) == (20, 22, 1) { 500 } else { 0 });
        assert_eq!(places(&candidates(&peak, 41, 41, 500)), [(20, 22, 1)]);
        assert_eq!(places(&candidates(&peak, 41, 41, 501)), []);
    }

    #[test]
    fn any_greater_neighbour_suppresses() {
        for offset in neighbours() {
            let pair = octave(61, 61, |x, y, s| match [s - 1, y - 30, x - 30] {
                [0, 0, 0] => 500,
                other if other == offset => 501,
                _ => 0,
            });
            assert!(!places(&candidates(&pair, 61, 61, 500)).contains(&(30, 30, 1)), "{offset:?}");
        }
    }

    #[test]
    fn a_plateau_has_exactly_one_maximum() {
        let plateau = octave(61, 61, |x, y, s| {
            i32::from((29..=31).contains(&x) && (29..=31).contains(&y) && (1..=2).contains(&s)) * 500
        });
        assert_eq!(places(&candidates(&plateau, 61, 61, 1)), [(29, 29, 1)]);
    }

    #[test]
    fn flat_has_none() {
        assert_eq!(candidates(&octave(61, 61, |_, _, _| 0), 61, 61, integer_threshold(f32::MIN_POSITIVE)), []);
    }

    #[test]
    fn the_larger_filter_must_fit_around_the_neighbours_too() {
        // Layer 1 of the first octave: its neighbours need 21 / 2 = 10 px on each side, so the maximum needs 11.
        let every = |x: i32, y: i32| octave(41, 41, move |px, py, s| i32::from((px, py, s) == (x, y, 1)));
        let found = |x, y| candidates(&every(x, y), 41, 41, 1).len();
        assert_eq!((found(11, 29), found(10, 29), found(11, 30), found(29, 11), found(29, 10)), (1, 0, 0, 1, 0));
    }

    #[test]
    fn a_picture_without_inner_points_has_none() {
        for (width, height) in [(1, 1), (2, 9), (9, 2)] {
            assert_eq!(candidates(&octave(width, height, |_, _, _| 9), width, height, 1), []);
        }
    }

    #[test]
    fn the_list_is_in_order() {
        let peaks = octave(81, 81, |x, y, s| i32::from((x % 7, y % 9, s % 3) == (3, 4, 1 + (x + y) % 2)) * 9);
        let found = candidates(&peaks, 81, 81, 1);
        assert!(found.len() > 20 && found.is_sorted());
    }

    #[test]
    fn the_vertex_of_a_parabola_by_hand() {
        // 1000 - 100 (t - 0.25)^2 in sixteenths: 100 * 25 / 16, 100 / 16, 100 * 9 / 16 below.
        assert_eq!(vertex(16000 - 2500, 16000 - 100, 16000 - 900), 0.25);
        assert_eq!(vertex(7, 7, 7), 0.0);
        assert_eq!(vertex(-5, 7, 7), 0.5);
        // The largest possible difference of determinants.
        assert_eq!(vertex(-(1 << 30), (1 << 30) - 1, -(1 << 30)), 0.0);
    }

    #[test]
    fn between_samples_a_paraboloid_is_found_exactly() {
        let peak = octave(61, 61, |x, y, s| {
            let (x, y, s) = (4 * (x - 30) - 1, 4 * (y - 25) + 1, 4 * (s - 2) - 2);
            100_000 - 10 * (x * x + y * y) - 20 * s * s
        });
        let [candidate] = candidates(&peak, 61, 61, 90_000)[..] else { panic!("not one candidate") };
        assert_eq!(places(&[candidate]), [(30, 25, 2)]);
        let extremum = locate(&peak, candidate);
        // Filter 21, plus half of the 6 px to the next filter: 1.2 * 24 / 9.
        assert_eq!((extremum.x, extremum.y, extremum.scale), (30.25, 24.75, 3.2));
        assert!(!extremum.dark);
    }

    #[test]
    fn a_symmetric_blob_is_found_at_its_centre() {
        for (light, ground) in [(200, 40), (40, 200)] {
            let blob = Luma::from_fn((61, 61), |x, y| {
                let (dx, dy) = (x as f32 - 30.0, y as f32 - 30.0);
                (ground as f32 + (light - ground) as f32 * (-(dx * dx + dy * dy) / 18.0).exp()) as u8
            });
            let octave = Octave::new(&IntegralImage::new(&blob), 0, 1);
            let strongest = candidates(&octave, 61, 61, integer_threshold(0.001))
                .into_iter()
                .map(|candidate| locate(&octave, candidate))
                .max_by(|a, b| a.response.total_cmp(&b.response))
                .unwrap();
            assert_eq!((strongest.x, strongest.y, strongest.dark), (30.0, 30.0, light < ground));
            assert!((2.0..4.0).contains(&strongest.scale), "scale {} of a blob of sigma 3", strongest.scale);
        }
    }
}
