//! Trust in a map.
//!
//! Trust was fitted to 240 maps with known truth: 11 scenes, and the scenes with rows off, blur, noise, little light, masks,
//! wrong ranges, and other right views. Maps with under 10 % of the pixels wrong by over 2 px have a trust of at least 0.5, maps
//! with over 30 % wrong less: docs/trust.md.

use crate::{
    config::{Config, Method},
    dense::{Aggregation, Compared, Dense, FILLED, View},
    disparity::pixels,
    seeding::Seeding,
};

/// Trust from which a map is good for use, 0 to 1.
pub const TRUSTED: f32 = 0.5;

/// Evidence of a map at which trust is 1, where confidences come from the support of neighbours.
const FULL_BY_SUPPORT: f32 = 0.62;
/// The same where confidences come from the margin of the costs alone, which is smaller: of luma, and of soft ranks.
const FULL_BY_MARGIN: f32 = 0.49;
const FULL_BY_MARGIN_OF_RANKS: f32 = 0.43;
/// Weight of the pixels that contradict the coarse map.
const CONTRADICTION: f32 = 2.0;
/// Share of the coarse map on surfaces from which it confirms what it does not contradict, 0 to 1.
const COVERED: f32 = 0.5;
/// Part of the evidence that does not depend on the number of seeds, and number of seeds at which half of the rest is there.
const SEEDS: (f32, f32) = (0.6, 400.0);
/// Least confidence of a filled pixel that a surface nearby speaks for and no view against, as in a wall that shows nothing; beyond
/// the frame of the other view it is less.
const FILLED_WITHIN: u8 = 8;
/// Share of such pixels up to which they are the gaps of any map, and how much more of them leave no trust, 0 to 1.
const GAPS: (f32, f32) = (0.21, 0.11);
/// The same share for block matching, which leaves holes where a match is not unique.
const GAPS_OF_BLOCKS: f32 = 0.42;
/// Row error that a distorted lens leaves up to which hardly anything is lost, and how much more of it leaves no trust, in pixels. Six scenes
/// whose right lens alone is distorted, matched as they are, have under 20 % wrong up to 5 px, and over 30 % from 9.3 px on.
const BENT: (f32, f32) = (4.0, 25.0);
/// Largest magnitude of half of the disparities of a pair without parallax, in pixels.
const ZERO: f32 = 0.25;
/// Largest magnitude of nearly all disparities of such a pair, in pixels, and their smallest share, 0 to 1. Six pictures with
/// noise of 4 and 8 grey values have a share of at least 0.945 where trust is at least 0.5.
const NOISE: (f32, f32) = (1.0, 0.9);
/// An object before a background at infinity: smallest magnitude of its disparities in pixels, their smallest confidence, and
/// largest share of such pixels without an object, 0 to 1.
const FAR: (f32, u8, f32) = (2.0, 128, 0.002);
/// Smallest share of measured pixels that show that there is no parallax, 0 to 1.
const SEEN: f64 = 0.05;
/// Largest difference of the shares of disparities above and below [`NOISE`], 0 to 1: noise has up to 0.026, an object on a
/// twentieth of the picture 0.04.
const IMBALANCE: f32 = 0.03;

/// Trust in a map, 0 to 1: mean confidence, which is less where the view has little detail, and 0 where a pixel was filled; reduced by the
/// share of the map that contradicts the coarse map, for a coarse map that shows little, for few seeds, where much of what the other
/// view should show was filled, and for rows that a distorted lens leaves.
pub(super) fn trust(dense: &Dense, config: &Config, seeding: &Seeding) -> f32 {
    let around = seeding.coarse.around();
    let (mut known, mut sure, mut contradicted, mut filled) = (0u64, 0u64, 0u64, 0u64);
    for ((x, y), disparity) in known_pixels(dense) {
        known += 1;
        let confidence = dense.confidence.get(x, y);
        sure += u64::from(if confidence > FILLED { confidence } else { 0 });
        filled += u64::from((FILLED_WITHIN..=FILLED).contains(&confidence));
        let shift = if config.reference == View::Left { 0.0 } else { disparity };
        contradicted += u64::from(around.contradicts(x as f32 + shift, y, disparity));
    }
    if known == 0 {
        return 0.0;
    }
    let share = |count: u64| count as f32 / known as f32;
    let seeds = seeding.seeds.len() as f32;
    let by_seeds = SEEDS.0 + (1.0 - SEEDS.0) * seeds / (seeds + SEEDS.1);
    let covered = (seeding.coarse.coverage() / COVERED).min(1.0);
    let is_of_blocks =
        matches!(&config.method, Method::Hsad(found) if matches!(found.aggregation, Aggregation::Sad { .. }));
    let usual = if is_of_blocks { GAPS_OF_BLOCKS } else { GAPS.0 };
    let gaps = (1.0 - (share(filled) - usual).max(0.0) / GAPS.1).max(0.0);
    let consistent = (1.0 - CONTRADICTION * share(contradicted)).max(0.0);
    let level = (1.0 - (seeding.rectification.unexplained - BENT.0).max(0.0) / BENT.1).max(0.0);
    let evidence = share(sure) / 255.0 * consistent * by_seeds * covered * gaps * level;
    let full = match &config.method {
        Method::Hsad(parameters) if parameters.refinement.is_none() => match parameters.aggregation {
            Aggregation::Sad { compared: Compared::SoftRank, .. } => FULL_BY_MARGIN_OF_RANKS,
            Aggregation::Sad { .. } | Aggregation::Costs(_) => FULL_BY_MARGIN,
        },
        Method::Hsad(_) | Method::Kamencay(_) => FULL_BY_SUPPORT,
    };
    (evidence / full).min(1.0)
}

/// Part of a map's disparities that can be right to 2 px where they come in steps of so many pixels, 0 to 1.
pub(super) fn of_steps(step: u32) -> f32 {
    (4.0 / step as f32).min(1.0)
}

/// Whether a map shows no parallax: its measured disparities are 0 but for noise, which spreads to both sides alike.
pub(super) fn shows_no_parallax(dense: &Dense) -> bool {
    let [mut measured, mut at_zero, mut near_zero, mut above, mut below, mut sure] = [0_u64; 6];
    for ((x, y), disparity) in known_pixels(dense) {
        let confidence = dense.confidence.get(x, y);
        if confidence > FILLED {
            measured += 1;
            at_zero += u64::from(disparity.abs() <= ZERO);
            near_zero += u64::from(disparity.abs() <= NOISE.0);
            above += u64::from(disparity > NOISE.0);
            below += u64::from(disparity < -NOISE.0);
        }
        // Noise leaves no sure disparity far from 0.
        sure += u64::from(disparity.abs() > FAR.0 && confidence >= FAR.1);
    }
    let share = |count: u64| count as f32 / measured.max(1) as f32;
    measured as f64 >= SEEN * dense.disparity.data().len() as f64
        && sure as f32 <= FAR.2 * measured as f32
        && share(at_zero) >= 0.5
        && share(near_zero) >= NOISE.1
        && (share(above) - share(below)).abs() <= IMBALANCE
}

/// Column and row of each pixel with a disparity, and the disparity in pixels.
fn known_pixels(dense: &Dense) -> impl Iterator<Item = ((u32, u32), f32)> {
    let width = dense.disparity.width() as usize;
    let place = move |index: usize| ((index % width) as u32, (index / width) as u32);
    let disparities = dense.disparity.data().iter().enumerate();
    disparities.filter_map(move |(index, &disparity)| Some((place(index), pixels(disparity)?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        config::Preset,
        disparity::{NONE, SCALE},
        image::{Luma, Plane},
        seeding::SeedingConfig,
    };

    /// A map of two halves, 10 and 20 px, with `confidence` everywhere.
    fn map(confidence: u8) -> Dense {
        Dense {
            disparity: Plane::from_fn((40, 10), |x, _| if x < 20 { 10 * SCALE } else { 20 * SCALE }),
            confidence: Plane::filled((40, 10), confidence),
        }
    }

    #[test]
    fn steps_of_up_to_four_pixels_are_right_to_two() {
        assert_eq!([1, 4, 5, 8].map(of_steps), [1.0, 1.0, 0.8, 0.5]);
    }

    #[test]
    fn parallax_is_what_noise_does_not_explain() {
        // Of 400 pixels with a disparity of a quarter of a pixel.
        let with = |others: &[(usize, i32)]| {
            let mut dense = map(90);
            dense.disparity.data_mut().fill(SCALE / 4);
            let mut pixels = dense.disparity.data_mut().iter_mut();
            for &(count, disparity) in others {
                pixels.by_ref().take(count).for_each(|pixel| *pixel = disparity);
            }
            shows_no_parallax(&dense)
        };
        // Noise within a pixel, and a few wrong pixels on both sides.
        assert!(with(&[(200, -SCALE)]) && !with(&[(201, -SCALE)]));
        assert!(with(&[(20, -SCALE - 1), (20, SCALE + 1)]) && !with(&[(21, -SCALE - 1), (20, SCALE + 1)]));
        // Hardly anything measured shows nothing.
        let part = |pixels: usize| {
            let confidence =
                Plane::from_fn((40, 10), |x, y| if y as usize * 40 + (x as usize) < pixels { 90 } else { FILLED });
            shows_no_parallax(&Dense { disparity: Plane::filled((40, 10), 0), confidence })
        };
        assert!(part(20) && !part(19));
        // An object before a background at infinity, and the same with exchanged views.
        for side in [-9 * SCALE, 9 * SCALE] {
            assert!(with(&[(12, side)]) && !with(&[(13, side)]));
        }
        assert!(!shows_no_parallax(&map(90)) && !shows_no_parallax(&map(0)));
    }

    #[test]
    fn trust_by_hand() {
        // No seeds; surfaces of disparity 0 in most of the view.
        let texture = |x: u32, y: u32| (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).rotate_left(9) >> 24;
        let view = Luma::from_fn((80, 40), |x, y| texture(x / 2, y / 2) as u8);
        let seeding = Seeding::find((&view, &view), (&[], &[]), &SeedingConfig::default()).unwrap();
        assert!(seeding.coarse.coverage() > COVERED, "{}", seeding.coarse.coverage());
        let flat = |confidence: u8| Dense { disparity: Plane::filled((40, 10), 0), ..map(confidence) };
        let config = Preset::Balanced.config();
        let expected = 102.0 / 255.0 * 0.6 / 0.62;
        assert!((trust(&flat(102), &config, &seeding) - expected).abs() < 1e-6);
        for (preset, full) in [(Preset::Fast, 0.43), (Preset::Paper, 0.49)] {
            let by_margin = trust(&flat(102), &preset.config(), &seeding);
            assert!((by_margin - expected * 0.62 / full).abs() < 1e-6, "{preset}");
        }
        // Gaps of a fifth are those of any map, of a third are the most of what both views show.
        let gaps = |columns: u32, config: &Config| {
            let confidence = Plane::from_fn((40, 10), |x, _| if x < columns { FILLED } else { 102 });
            trust(&Dense { confidence, ..flat(102) }, config, &seeding)
        };
        let with_gaps = |columns| gaps(columns, &config);
        assert!((with_gaps(8) - 0.8 * expected).abs() < 1e-6);
        assert!((with_gaps(10) - 0.75 * expected * (1.0 - 0.04 / 0.11)).abs() < 1e-6);
        assert_eq!(with_gaps(13), 0.0);
        // Of block matching, twice as many.
        let mut of_blocks = Preset::Fast.config();
        if let (Method::Hsad(blocks), Method::Hsad(balanced)) = (&mut of_blocks.method, &config.method) {
            blocks.refinement = balanced.refinement;
        }
        assert!((gaps(16, &of_blocks) - 0.6 * expected).abs() < 1e-6);
        assert!((gaps(18, &of_blocks) - 0.55 * expected * (1.0 - 0.03 / 0.11)).abs() < 1e-6);
        // Rows off by up to 16.5 px.
        let mut bent = seeding.clone();
        bent.rectification.unexplained = 16.5;
        assert!((trust(&flat(102), &config, &bent) - 0.5 * expected).abs() < 1e-6);
        // What the surfaces contradict, and views without content, are not trusted.
        assert_eq!(trust(&map(255), &config, &seeding), 0.0);
        let grey = Luma::filled((40, 10), 90);
        let empty = Seeding::find((&grey, &grey), (&[], &[]), &SeedingConfig::default()).unwrap();
        assert_eq!(trust(&flat(255), &config, &empty), 0.0);
        let nothing = Dense { disparity: map(0).disparity.map(|_| NONE), ..map(0) };
        assert_eq!(trust(&nothing, &config, &seeding), 0.0);
    }
}
