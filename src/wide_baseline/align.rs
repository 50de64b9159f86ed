//! Alignment: rotates and scales the second view like the first, so that upright descriptors match, and rows correspond
//! if the views are those of a rectified pair.

use std::f64::consts::{PI, TAU};

use glam::{DAffine2, DMat2, DVec2};

use super::{DetectorCache, MAX_DY, View};
use crate::{
    error::Result,
    features::{Feature, FeatureConfig},
    filter::resample,
    image::{Luma, Size},
    matching::{Match, MatchConfig, Seed, match_features},
    seeding::{Rectification, Verdict},
};

/// Largest number of corrections of the alignment, each by the remaining similarity.
const ROUNDS: usize = 4;
/// An aligned view is corrected until rows differ by at most this, in pixels: refinement along rows keeps the
/// difference.
const EXACT: f32 = 0.25;
/// Largest deviation of a match's rotation from the common rotation, in radians.
const SAME_TURN: f64 = PI / 18.0;
/// Largest deviation of the natural logarithm of a match's scale ratio from the common one.
const SAME_SCALE: f64 = 0.3;
/// Largest turn, in radians, and largest logarithm of a scale between views whose descriptors match as those of aligned views.
const SMALL_TURN: f64 = PI / 90.0;
const SMALL_SCALE: f64 = 0.05;
/// Steps of the similarity that features with orientations show: a turn in radians, a logarithm of a scale, and a shift in pixels. These
/// features differ in their last digits between devices, and steps leave nothing of it but in one of dozens of pairs; what the steps
/// leave is small.
const STEPS: (f64, f64, f64) = (1.0 / 64.0, 1.0 / 32.0, 4.0);
/// Smallest number of matches with a common rotation and scale.
const NEEDED: usize = 10;

/// Smallest ratio of the matches in equal rows to the matches that agree with a fit, for rows to count as
/// corresponding.
const LEVEL: f64 = 0.9;

/// The second view, rotated and scaled like the first.
pub(super) struct Aligned {
    pub(super) view: View,
    /// Map from pixels of the second view to pixels of `view`.
    pub(super) map: DAffine2,
    /// The same map without the turn and scale that `view` is left with; that of `view` where it is left with none, or is the second
    /// view itself, which is best as it is.
    pub(super) exact: DAffine2,
    /// Whether rows correspond after the alignment; false for a plane seen obliquely or a scene seen from elsewhere.
    pub(super) rectified: bool,
    /// Matches of the first view with `view`, in any rows.
    pub(super) matches: Vec<Match>,
}

/// What the views are aligned for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Goal {
    /// Rows that correspond, as far as a similarity can do that.
    Rows,
    /// Descriptors that match: views of about one turn and scale.
    Descriptors,
}

/// Rotates and scales the second view by the similarity that matches show, repeatedly, until rows correspond.
///
/// For [`Goal::Descriptors`] a small remaining turn and scale stay.
///
/// The search begins with `start`, a map from pixels of the second view to those of the aligned one, the identity if nothing is
/// known.
///
/// Upright features measure small rotations and all scales by their rows, which do not depend on depth
/// ([`Rectification`]); if they match too rarely, features with orientations are matched once. If rows do not
/// correspond in the end, the last alignment is kept.
pub(super) async fn align(
    detectors: &mut DetectorCache<'_>,
    first: &View,
    second: &Luma,
    features: &FeatureConfig,
    matching: &MatchConfig,
    goal: Goal,
    start: DAffine2,
) -> Result<Aligned> {
    let mut aligned = if start == DAffine2::IDENTITY {
        let view = View::new(detectors, second.clone(), features).await?;
        Aligned { view, map: start, exact: start, rectified: false, matches: Vec::new() }
    } else {
        turned(detectors, &first.luma, second, start, features).await?
    };
    let mut tried_orientations = false;
    for round in 0..=ROUNDS {
        aligned.matches = match_features(&first.features, &aligned.view.features, matching)?;
        let seed = |found: &Match| Seed::from_match(&first.features, &aligned.view.features, found);
        let seeds: Vec<Seed> = aligned.matches.iter().map(seed).collect();
        let rows = Rectification::new(&seeds, first.luma.size());
        log::debug!("turned {round} times: {rows}");
        aligned.rectified = is_level(&rows);
        if round == 0 && !aligned.rectified && are_level(&seeds, &rows) {
            aligned.rectified = true;
            break;
        }
        if round == ROUNDS || aligned.rectified && (round == 0 || rows.largest <= EXACT) {
            break;
        }
        let missing = if has_figures(&rows) {
            let similarity = Similarity {
                turn: f64::from(rows.rotation).to_radians(),
                scale: rows.scale.into(),
                dy: rows.offset.into(),
            };
            let exact = similarity.undone(centre(&first.luma), centre(&first.luma)) * aligned.map;
            if goal == Goal::Descriptors && similarity.is_small() {
                if aligned.map != DAffine2::IDENTITY {
                    aligned.exact = exact;
                }
                break;
            }
            exact
        } else if tried_orientations {
            break;
        } else {
            tried_orientations = true;
            let oriented = FeatureConfig { upright: false, ..features.clone() };
            let views =
                [detectors.features(&first.luma, &oriented).await?, detectors.features(second, &oriented).await?];
            let matches = match_features(&views[0], &views[1], matching)?;
            let centres = [centre(&first.luma), centre(second)];
            let Some(similarity) = Similarity::shown([&views[0], &views[1]], &matches, centres) else { break };
            similarity.undone(centres[0], centres[1])
        };
        aligned = Aligned { rectified: false, ..turned(detectors, &first.luma, second, missing, features).await? };
    }
    Ok(aligned)
}

/// Whether the rows' fit has figures: cameras above each other and too few matches have none.
fn has_figures(rows: &Rectification) -> bool {
    !matches!(rows.verdict, Verdict::Unknown | Verdict::Vertical)
}

/// Whether a search along rows finds corresponding points, by the fit.
fn is_level(rows: &Rectification) -> bool {
    has_figures(rows) && rows.largest <= MAX_DY
}

/// Whether rows correspond although the fit says otherwise. If all matches lie close together, the fit extrapolates a
/// random rotation to the rest of the picture; then as many matches lie in equal rows as agree with the fit.
fn are_level(seeds: &[Seed], rows: &Rectification) -> bool {
    let level = seeds.iter().filter(|seed| seed.dy.abs() <= MAX_DY).count();
    has_figures(rows) && level as f64 >= LEVEL * rows.agreeing as f64
}

/// The second view resampled by `map`, with the rows of the first view and all columns that it covers, limited to one
/// width of the first view beyond either side.
async fn turned(
    detectors: &mut DetectorCache<'_>,
    first: &Luma,
    second: &Luma,
    map: DAffine2,
    features: &FeatureConfig,
) -> Result<Aligned> {
    let [width, height] = [second.width(), second.height()].map(|side| f64::from(side - 1));
    let corners = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)];
    let columns = corners.map(|(x, y)| map.transform_point2(DVec2::new(x, y)).x);
    let reach = f64::from(first.width());
    let left = columns.iter().copied().fold(f64::INFINITY, f64::min).floor().clamp(-reach, reach);
    let right = columns.iter().copied().fold(f64::NEG_INFINITY, f64::max).ceil().clamp(left, 2.0 * reach);
    let map = DAffine2::from_translation(DVec2::new(-left, 0.0)) * map;
    let size = Size::new((right - left) as u32 + 1, first.height());
    let fill = mean(second);
    let luma = resample(&second.map(|&grey| [grey]), map, size, [fill]).0.map(|&[grey]| grey);
    let view = View::new(detectors, luma, features).await?;
    Ok(Aligned { view, map, exact: map, rectified: false, matches: Vec::new() })
}

fn mean(luma: &Luma) -> u8 {
    (luma.data().iter().map(|&grey| u64::from(grey)).sum::<u64>() / luma.data().len() as u64) as u8
}

fn centre(luma: &Luma) -> DVec2 {
    DVec2::new(f64::from(luma.width() - 1), f64::from(luma.height() - 1)) / 2.0
}

/// Rotation, scale and vertical shift of the second view against the first, about the centres of both.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Similarity {
    /// Rotation in radians, clockwise on the screen.
    turn: f64,
    /// Size of the second view's structures divided by that of the first's.
    scale: f64,
    /// Shift downwards, in pixels of the first view.
    dy: f64,
}

impl Similarity {
    /// Whether descriptors hardly change.
    fn is_small(self) -> bool {
        self.turn.abs() <= SMALL_TURN && libm::log(self.scale).abs() <= SMALL_SCALE
    }

    /// The inverse similarity, from pixels of the second view to pixels of the first; both centres in pixels.
    fn undone(self, first: DVec2, second: DVec2) -> DAffine2 {
        let linear = DMat2::from_angle(-self.turn) * (1.0 / self.scale);
        DAffine2::from_mat2_translation(linear, first - linear * second - DVec2::new(0.0, self.dy))
    }

    /// The similarity that most matches of features with orientations share, in [`STEPS`]; `None` for fewer than [`NEEDED`].
    fn shown([first, second]: [&[Feature]; 2], matches: &[Match], centres: [DVec2; 2]) -> Option<Self> {
        let pairs: Vec<(&Feature, &Feature)> =
            matches.iter().map(|found| (&first[found.left], &second[found.right])).collect();
        let turn = |(a, b): &(&Feature, &Feature)| f64::from(b.orientation - a.orientation);
        let growth = |(a, b): &(&Feature, &Feature)| libm::log(f64::from(b.scale / a.scale));
        let agreeing = |angle: f64| pairs.iter().filter(move |pair| half_turn(turn(pair) - angle).abs() < SAME_TURN);
        let most = pairs.iter().map(turn).max_by_key(|&angle| agreeing(angle).count())?;
        let alike: Vec<_> = agreeing(most).collect();
        let scale = median(alike.iter().map(|pair| growth(pair)).collect())?;
        let alike: Vec<_> = alike.into_iter().filter(|pair| (growth(pair) - scale).abs() < SAME_SCALE).collect();
        if alike.len() < NEEDED {
            return None;
        }
        let in_steps = |value: f64, step: f64| (value / step).round() * step;
        let turn = most + median(alike.iter().map(|pair| half_turn(turn(pair) - most)).collect())?;
        let scale = median(alike.iter().map(|pair| growth(pair)).collect())?;
        let found =
            Self { turn: in_steps(half_turn(turn), STEPS.0), scale: libm::exp(in_steps(scale, STEPS.1)), dy: 0.0 };
        let undone = found.undone(centres[0], centres[1]);
        let place = |feature: &Feature| DVec2::new(feature.x.into(), feature.y.into());
        let rows = alike.iter().map(|(a, b)| undone.transform_point2(place(b)).y - place(a).y);
        Some(Self { dy: in_steps(median(rows.collect())?, STEPS.2), ..found })
    }
}

/// Wraps an angle in radians to the range from -pi to below pi.
fn half_turn(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// Median, the upper middle value of an even number; `None` without values.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::DESCRIPTOR_LENGTH;

    #[test]
    fn rows_are_level_unless_more_matches_show_otherwise() {
        let size = (640, 480);
        let seeds = |middle: f32, rows: fn(f32) -> f32| -> Vec<Seed> {
            let place = |i: u16| (middle * (f32::from(i * 37 % 100) - 50.0) / 50.0, f32::from(i * 61 % 100) - 50.0);
            let seed = |(x, y): (f32, f32)| Seed {
                x: 320.0 + x,
                y: 240.0 + y,
                disparity: 9.0,
                dy: rows(x) + 0.4 * (y * 7.0).sin(),
                confidence: 0.5,
            };
            (0..40).map(|i| seed(place(i))).collect()
        };
        // A rotation by one degree: matches near the centre differ by half a row at most, matches all over the picture
        // by more.
        for (middle, level) in [(30.0, true), (300.0, false)] {
            let seeds = seeds(middle, |x| 0.0175 * x);
            let rows = Rectification::new(&seeds, size);
            assert_eq!((is_level(&rows), are_level(&seeds, &rows)), (level, level), "{rows}");
        }
        let unrelated: Vec<Seed> =
            seeds(300.0, |_| 0.0).into_iter().map(|seed| Seed { dy: seed.x * seed.y % 97.0, ..seed }).collect();
        assert!(!are_level(&unrelated, &Rectification::new(&unrelated, size)));
    }

    #[test]
    fn what_most_matches_show_is_found_and_undone() {
        let (first_centre, second_centre) = (DVec2::new(50.0, 40.0), DVec2::new(60.0, 70.0));
        let true_map =
            |p: DVec2| DMat2::from_angle(2.8) * (p - first_centre - DVec2::new(0.0, -3.0)) * 1.25 + second_centre;
        let feature = |p: DVec2, scale, orientation| Feature {
            x: p.x as f32,
            y: p.y as f32,
            scale,
            response: 1.0,
            dark: false,
            orientation,
            descriptor: [0.0; DESCRIPTOR_LENGTH],
        };
        let (mut first, mut second) = (Vec::new(), Vec::new());
        for i in 0..30u16 {
            let p = DVec2::new(f64::from(i) * 3.0, f64::from(i * 37 % 80));
            first.push(feature(p, 2.0, 5.0));
            // Every third match is wrong.
            let wrong = if i % 3 == 0 { f32::from(i) * 0.2 } else { 0.0 };
            second.push(feature(true_map(p), 2.5, (5.0 + 2.8 + wrong) % (TAU as f32)));
        }
        let matches: Vec<Match> =
            (0..30).map(|i| Match { left: i, right: i, distance: 0.1, confidence: 0.5 }).collect();
        let found = Similarity::shown([&first, &second], &matches, [first_centre, second_centre]).unwrap();
        // In steps: 2.8 lies between 179 and 180 of 1/64, the logarithm of 1.25 between 7 and 8 of 1/32, and 3 between 0 and 4.
        assert!((half_turn(found.turn - 179.0 / 64.0)).abs() < 1e-6 && found.dy == 4.0, "{found:?}");
        assert!((found.scale - (7.0_f64 / 32.0).exp()).abs() < 1e-6, "{found:?}");
        let p = DVec2::new(10.0, 20.0);
        let back = found.undone(first_centre, second_centre).transform_point2(true_map(p));
        assert!((back.y - p.y).abs() < 2.5, "{back}");
        assert_eq!(Similarity::shown([&first, &second], &matches[..9], [first_centre, second_centre]), None);
    }
}
