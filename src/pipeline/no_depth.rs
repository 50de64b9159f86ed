//! Pairs whose disparities tell no depth.

use glam::DVec2;

use crate::{
    image::Size,
    matching::Seed,
    names::names,
    rectify::{
        Correspondence, RowKind, RowModel,
        epipolar::{Relation, without_depth},
    },
};

/// Why disparities tell no depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoDepth {
    /// Disparities are 0 but for noise, as in pictures from one place.
    NoParallax,
    /// The camera turned, or turned and zoomed, on the spot.
    Turned,
    /// The views show a plane in rows that correspond only after a warp: nothing tells how the cameras stand.
    Plane,
    /// The views show a plane, or the camera turned on the spot.
    Flat,
}

names!(NoDepth, "the reason", {
    NoParallax => "no parallax",
    Turned => "turned on the spot",
    Plane => "plane",
    Flat => "plane or turned on the spot",
});

impl NoDepth {
    /// What matches tell whose rows correspond after a warp by `rows`, in views of `size` px whose points were detected after a reduction
    /// by `factor`. A plane whose rows correspond as they are, or but for a shift, is what a stereo camera sees of a wall.
    pub(super) fn of(seeds: &[Seed], rows: &RowModel, size: Size, factor: u32) -> Option<Self> {
        if matches!(rows.kind(), RowKind::AsIs | RowKind::Shift) {
            return None;
        }
        let point = |seed: &Seed| {
            let [x, y, right] = [seed.x, seed.y, seed.right_x()].map(f64::from);
            Correspondence { left: DVec2::new(x, y), right: DVec2::new(right, rows.right_row(right, y)) }
        };
        let points: Vec<Correspondence> = seeds.iter().map(point).collect();
        match without_depth(&points, [size; 2], factor)? {
            Relation::Turned => Some(Self::Turned),
            Relation::Plane => Some(Self::Plane),
            _ => Some(Self::Flat),
        }
    }
}
