//! Views of which one is a mirror image of the other.

#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    backend::Backend,
    error::Result,
    image::{Luma, Plane, Size},
    io::Picture,
    names::names,
    rectify::{
        Correspondence,
        epipolar::{Similarity, agreeing},
    },
    wide_baseline::match_points,
};

use super::{
    rectified::{config, larger},
    reduction::geometry_reduction,
    taken::TakenView,
};

/// Smallest number of points that agree once one view is mirrored back, and how many times as many they are as in the views as given.
const LEAST: (usize, usize) = (20, 2);

/// Which sides of one view are exchanged against the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mirrored {
    /// Left and right.
    Columns,
    /// Top and bottom.
    Rows,
}

names!(Mirrored, "the mirror image", { Columns => "left and right", Rows => "top and bottom" });

/// Whether one of two views is a mirror image, as far as their matches tell: interest points do not match their mirror images. It takes
/// as long as matching both views twice, and is meant for pairs that no map was found of.
///
/// # Errors
/// As [`super::rectify`].
#[cfg(not(target_arch = "wasm32"))]
pub fn mirrored(backend: &Backend, views: (&Picture, &Picture)) -> Result<Option<Mirrored>> {
    block_on(mirrored_async(backend, views))
}

/// The asynchronous [`mirrored`]. Work on the host blocks.
///
/// # Errors
/// See [`mirrored`].
pub async fn mirrored_async(backend: &Backend, (left, right): (&Picture, &Picture)) -> Result<Option<Mirrored>> {
    let factor = geometry_reduction(larger([left.size(), right.size()]));
    let [left, right] = TakenView::both(left, right)?.map(|view| view.seen.reduced(factor).luma);
    let back = flipped(&right);
    let as_given = points(backend, [&left, &right]).await?.len();
    let found = points(backend, [&left, &back]).await?;
    let is_mirrored = found.len() >= LEAST.0 && found.len() >= LEAST.1 * as_given;
    let kind = if Similarity::between(&found).turn.abs() < std::f64::consts::FRAC_PI_2 {
        Mirrored::Columns
    } else {
        Mirrored::Rows
    };
    Ok(is_mirrored.then_some(kind))
}

/// Points of two views that agree on how the cameras stand.
async fn points(backend: &Backend, views: [&Luma; 2]) -> Result<Vec<Correspondence>> {
    let found = match_points(backend, views, &config(), glam::DAffine2::IDENTITY).await?;
    Ok(agreeing(&found, views.map(Plane::size)))
}

fn flipped(view: &Luma) -> Luma {
    let Size { width, .. } = view.size();
    Plane::from_fn(view.size(), |x, y| view.get(width - 1 - x, y))
}
