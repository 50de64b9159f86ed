//! A first look at two views, in small copies of them.

use glam::{DAffine2, DVec2};

use super::{DetectorCache, View, WideBaselineConfig, align};
use crate::{
    backend::Backend,
    error::Result,
    image::{Luma, reduced},
    matching::{Match, Seed},
    seeding::Rectification,
};

/// Factor by which views are reduced.
const FACTOR: u32 = 3;
/// Smallest number of points that must agree on how the rows correspond: fewer, as in small pictures, leave nothing certain.
const LEAST: usize = 50;

/// What a first look at two views tells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Glance {
    /// How the rows of the views correspond as they are, in pixels of the views; `None` unless that is certain.
    pub rows: Option<Rectification>,
    /// The map from pixels of the second view to pixels of one that is turned and scaled like the first; the identity where
    /// nothing is certain.
    pub map: DAffine2,
}

/// Matches small copies of two views, which takes a small part of the time to match the views themselves.
///
/// # Errors
/// As [`super::match_views`].
pub(crate) async fn glance(
    backend: &Backend,
    views: [&Luma; 2],
    WideBaselineConfig { features, matching, .. }: &WideBaselineConfig,
) -> Result<Glance> {
    let mut detectors = DetectorCache::new(backend);
    let [first, second] = views.map(|view| reduced(view, FACTOR));
    let first = View::new(&mut detectors, first, features).await?;
    let (goal, start) = (align::Goal::Descriptors, DAffine2::IDENTITY);
    let align::Aligned { view: second, map, exact, matches, .. } =
        align::align(&mut detectors, &first, &second, features, matching, goal, start).await?;
    let back = map.inverse();
    let as_given = |found: &Match| {
        let seed = Seed::from_match(&first.features, &second.features, found);
        let right = back.transform_point2(DVec2::new(seed.right_x().into(), seed.right_y().into())).as_vec2();
        Seed { disparity: seed.x - right.x, dy: right.y - seed.y, ..seed }
    };
    let seeds: Vec<Seed> = matches.iter().map(as_given).collect();
    let rows = Rectification::new(&seeds, first.luma.size());
    let is_certain = rows.is_certain() && rows.agreeing >= LEAST;
    let map = if is_certain { grown(exact, FACTOR.into()) } else { DAffine2::IDENTITY };
    Ok(Glance { rows: is_certain.then(|| rows.enlarged(FACTOR)), map })
}

/// A map between pixels of two views, as one between pixels of the views enlarged by `factor`.
pub(crate) fn grown(map: DAffine2, factor: f64) -> DAffine2 {
    let enlarge =
        DAffine2::from_translation(DVec2::splat((factor - 1.0) / 2.0)) * DAffine2::from_scale(DVec2::splat(factor));
    enlarge * map * enlarge.inverse()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_grows_about_the_corner_of_the_first_pixel() {
        let map = DAffine2::from_scale_angle_translation(DVec2::new(0.5, 2.0), 0.3, DVec2::new(3.0, -4.0));
        let whole = grown(map, 2.0);
        // Pixel 3 of a view is the middle of pixels 6 and 7 of the view enlarged twice.
        let place = |pixel: DVec2| 2.0 * pixel + 0.5;
        let pixel = DVec2::new(3.0, 7.0);
        assert!(whole.transform_point2(place(pixel)).distance(place(map.transform_point2(pixel))) < 1e-12);
    }
}
