//! Doubts about an outcome, in words: warnings, and the reason for which a map is not to be trusted.
//!
//! Sentences write options between backticks, so that each surface can put its own spelling there.

use super::{Mirrored, NoDepth, Outcome, RangeSource, RectifiedPair, TRUSTED};
use crate::{
    config::Config,
    disparity::DisparityRange,
    io::{Calibration, Picture},
    matching::Seed,
    rectify::{Residual, RowKind, StereoRectification},
    seeding::Verdict,
};

/// Number of seeds below which they tell nothing of the range.
const FEW: usize = 20;

/// Disparity of points behind the cameras, in pixels, with a margin for what is far away.
const BEYOND: f64 = 1.0;
/// Largest constant of the disparities that a turn of the right camera to the side may leave, in pixels.
const ASIDE: f64 = 2.0;

/// Largest row difference that a calibration of the pictures leaves, as a share of their height. Seven scenes, turned and with a distorted lens,
/// have at most 0.001 with theirs. With a mistake (Teddy, focal length off by 20 to 50 %, centre by 30 px, a camera turned by 3 degrees) the least
/// is 0.012, and half of the depths are off by at least 4 to 48 %.
const MISFIT: f32 = 0.01;

/// Why a map is not to be trusted, in words; `None` for a map that is. `calibration` is that of the disparities.
pub fn not_trusted(outcome: &Outcome, calibration: Option<&Calibration>) -> Option<String> {
    if let Some(why) = outcome.no_depth {
        return Some(without_depth(why).into());
    }
    if outcome.trust >= TRUSTED {
        return calibration.and_then(|calibration| behind(outcome, calibration));
    }
    let reason = if let Some(reason) = without_detail(outcome.points_found) {
        reason
    } else if outcome.seeding.rectification.verdict == Verdict::Unknown {
        "nothing tells whether the rows of the views correspond"
    } else if outcome.seeding.seeds.len() < FEW {
        "hardly any interest point was found in both views"
    } else if outcome.repetition > 4 {
        "disparities come in steps of many pixels"
    } else if outcome.seeding.rectification.is_distorted() {
        "rows do not correspond in parts of the picture, as with a distorted lens"
    } else {
        "the views correspond in too little of the picture"
    };
    Some(format!("the map is not to be trusted (trust {:.2} of 1): {reason}", outcome.trust))
}

/// Views that show nothing, by the number of interest points in each, in words.
const fn without_detail(points: [usize; 2]) -> Option<&'static str> {
    match points {
        [0, 0] => Some("neither view shows any detail"),
        [0, _] => Some("the left view shows no detail"),
        [_, 0] => Some("the right view shows no detail"),
        _ => None,
    }
}

/// Why depth does not follow from a map whose surfaces lie behind the cameras by the calibration, if most do.
fn behind(outcome: &Outcome, calibration: &Calibration) -> Option<String> {
    let seeds = &outcome.seeding.seeds;
    let beyond = |seed: &&Seed| f64::from(seed.disparity) + calibration.doffs < -BEYOND;
    let count = seeds.iter().filter(beyond).count();
    (seeds.len() >= FEW && 4 * count > 3 * seeds.len()).then(|| {
        format!(
            "{count} of {} matched points lie behind the cameras by the calibration, at disparities below {:.0} px: exchange left and \
             right, or correct doffs",
            seeds.len(),
            0.0 - calibration.doffs
        )
    })
}

/// A camera that looks to the side, as rows tell: then disparities have a constant that rows tell but roughly, and depth does not follow.
struct Aside {
    degrees: f64,
    /// The constant, in pixels.
    off: f64,
}

impl Aside {
    /// The right camera's turn to the side against the `calibration` of the rectified pair, if rows tell one.
    fn of(outcome: &Outcome, calibration: &Calibration) -> Option<Self> {
        let found = &outcome.seeding.rectification;
        let off = calibration.focal * calibration.focal * found.rows.parameters()[3];
        // The distortion of a lens looks like a turn, too.
        let is_turned = found.rows.kind() == RowKind::Projective && !found.is_distorted() && outcome.no_depth.is_none();
        let degrees = (off / calibration.focal).abs().atan().to_degrees();
        (is_turned && off.abs() > ASIDE).then_some(Self { degrees, off: off.abs() })
    }
}

/// A warning if the rows of a pair whose calibration is given for rectified pictures are those of a camera that looks to the side.
pub fn looks_to_the_side(outcome: &Outcome, calibration: &Calibration) -> Option<String> {
    let Aside { degrees, off } = Aside::of(outcome, calibration)?;
    Some(format!(
        "the pictures are not those of a rectified pair: by its rows the right camera looks {degrees:.1} degrees to the side, so that \
         disparities are off by about {off:.0} px and no depth follows; rectify the pair by the calibration of the cameras as they \
         stand, or take it as rectified with `no_align`"
    ))
}

/// A warning if the rows of a pair that was rectified by a calibration tell that it is not that of the pictures. What rows show was
/// aligned; columns are off by as much, which nothing shows, and depth does not follow.
pub fn misfit(outcome: &Outcome, pair: &RectifiedPair) -> Option<String> {
    let calibration = pair.rectification.calibration()?;
    let Residual { points, right, .. } = pair.residual;
    let is_of_most = pair.residual.is_of_most();
    let rows = outcome.seeding.rectification.largest;
    let most = MISFIT * pair.rectification.size().height as f32;
    let found = match Aside::of(outcome, calibration) {
        Some(Aside { degrees, off }) if is_of_most => {
            format!(
                "the right camera looks {degrees:.1} degrees to the side, by the rows, and disparities are off by about {off:.0} px"
            )
        }
        None if rows <= most && (points < FEW || is_of_most) => return None,
        _ => format!("rows of {right} of {points} matches correspond, and rows differ by up to {rows:.1} px"),
    };
    Some(format!(
        "the calibration does not fit the pictures, and no depth follows: after the rectification {found}; calibrate the cameras anew, or \
         take the calibration of these pictures"
    ))
}

/// A warning unless disparities of the pair are plainly those of the views as they were taken.
pub fn of_rectified(pair: &RectifiedPair) -> Option<String> {
    let StereoRectification::Uncalibrated(found) = &pair.rectification else { return None };
    let [left, right] = found.sources();
    if !found.keeps_columns {
        return Some(
            "the constant of the disparities is unknown, since matches do not tell columns of one view against those of the other: only \
             differences of disparities hold, and no depth follows"
                .into(),
        );
    }
    if found.shift != 0.0 {
        return Some(format!("disparities are {} px less than those of the views as they were taken", found.shift));
    }
    (left != right).then(|| {
        format!(
            "the left view is {left} and the right view {right} pixels: disparities are those of the views as they are, and off by what \
             was cut from the left side of one alone"
        )
    })
}

/// A warning if the pair was rectified as one of two lenses that differ.
pub fn of_lenses(pair: &RectifiedPair) -> Option<String> {
    let [left, right] = pair.rectification.distortion();
    (left != right).then(|| {
        format!(
            "the lenses of the views differ by the matches (k1 {left:.2} and {right:.2}), with their centres in the middle of the pictures: \
             of a cropped picture rows are off; calibrate the cameras for certainty"
        )
    })
}

/// The reason for which a pair fails of which one view is a mirror image.
pub fn mirrored(sides: Mirrored) -> String {
    format!("one view is a mirror image of the other, {sides} exchanged: mirror one of the views back")
}

/// Why disparities tell no depth, in words.
fn without_depth(why: NoDepth) -> &'static str {
    match why {
        NoDepth::NoParallax => "the views show no parallax, as pictures from one place do: no depth follows from them",
        NoDepth::Turned => {
            "the camera turned on the spot, and disparities tell no depth: take the second picture from another place"
        }
        NoDepth::Plane => {
            "the views show a plane, which does not tell how the cameras stand, and disparities tell no depth: take a scene with \
             depth, or rectify the pair by a calibration"
        }
        NoDepth::Flat => {
            "the views show a plane, or the camera turned on the spot, and disparities tell no depth: take both pictures of a scene \
             with depth, from two places"
        }
    }
}

/// Warnings about the outcome of a pair: identical views, raw mosaics, pictures enlarged without interpolation, weak interest points
/// left out, a guessed or cut disparity range, a distorted lens, matches outside the range, surfaces at an end of the range, and a
/// difference in brightness. `rectified` is the pair if it was rectified first, and `views` are its pictures then.
pub fn warnings(
    (left, right): (&Picture, &Picture),
    config: &Config,
    outcome: &Outcome,
    rectified: Option<&RectifiedPair>,
) -> Vec<String> {
    let mut warnings = Vec::new();
    if left == right {
        warnings.push("both views are the same picture, which shows no depth; a file with both views is named once, and unless it is an MPO \
             `side_by_side` or `top_bottom` tells their order"
                .into());
    }
    warnings.extend(mosaics(outcome.mosaics));
    warnings.extend(repetition(outcome.repetition));
    warnings.extend(left_out(outcome));
    if let RangeSource::Fallback(thin) = outcome.range_source {
        warnings.push(format!(
            "the disparity range could not be found: {thin}; name it with `min_disparity` and `disparities`; {} were searched instead",
            span(outcome.range)
        ));
    }
    if let Some(asked) = config.range.filter(|&asked| asked != outcome.range) {
        let reason = "no pixel has a partner further away than the picture is wide";
        warnings.push(format!("{} were searched, not {}: {reason}", span(outcome.range), span(asked)));
    }
    warnings.extend(distortion(outcome, rectified));
    warnings.extend(outside(config, outcome));
    warnings.extend(at_end(config, outcome));
    warnings.extend(brightness(outcome));
    warnings
}

/// A warning if views are raw mosaics, whose luma is less sharp than that of a picture from the camera.
fn mosaics(found: [bool; 2]) -> Option<String> {
    let (views, them) = match found {
        [true, true] => ("both views are raw Bayer mosaics", "them"),
        [true, false] => ("the left view is a raw Bayer mosaic", "it"),
        [false, true] => ("the right view is a raw Bayer mosaic", "it"),
        [false, false] => return None,
    };
    Some(format!(
        "{views}: the luma of the colours was matched; demosaic {them} to colour pictures for a sharper result"
    ))
}

/// A warning if views were enlarged by repeating pixels.
fn repetition(factor: u32) -> Option<String> {
    (factor > 1).then(|| {
        format!(
            "both views were enlarged by {factor} without interpolation, so that disparities come in steps of {factor} px: match the \
             pictures in their own size"
        )
    })
}

/// A warning if a view has more interest points than are kept.
fn left_out(outcome: &Outcome) -> Option<String> {
    let kept = outcome.features.each_ref().map(Vec::len);
    (kept != outcome.points_found).then(|| {
        format!(
            "of {} interest points in the left and {} in the right view the strongest {} and {} were used, spread over the \
             picture: `max_features` raises their number, and `threshold` leaves out weak ones",
            outcome.points_found[0], outcome.points_found[1], kept[0], kept[1]
        )
    })
}

/// A disparity range as text, `MIN to MAX px`.
pub fn span(range: DisparityRange) -> String {
    format!("{} to {} px", range.min, range.last())
}

/// A warning if rows differ as the rows of a distorted lens do.
fn distortion(outcome: &Outcome, rectified: Option<&RectifiedPair>) -> Option<String> {
    let rows = &outcome.seeding.rectification;
    let is_by_calibration = rectified.is_some_and(|pair| pair.rectification.calibration().is_some());
    let advice = match is_by_calibration {
        true => ", whose distortion the calibration does not have: calibrate the cameras anew",
        false => ": remove the distortion from both pictures first",
    };
    rows.is_distorted().then(|| {
        format!(
            "rows are off by up to {:.1} px in parts of the picture, as by a distorted lens{advice}",
            rows.unexplained
        )
    })
}

/// A warning if most matches lie outside the searched range, or have negative disparities: the range is wrong, or the
/// views are exchanged. Where disparities tell no depth, neither do their signs.
fn outside(config: &Config, outcome: &Outcome) -> Option<String> {
    if outcome.no_depth.is_some() || outcome.seeding.seeds.len() < FEW {
        return None;
    }
    let disparities: Vec<f32> = outcome.seeding.seeds.iter().map(|seed| seed.disparity).collect();
    let share = |wanted: &dyn Fn(f32) -> bool| {
        disparities.iter().filter(|&&disparity| wanted(disparity)).count() as f32 / disparities.len() as f32
    };
    let least = disparities.iter().copied().reduce(f32::min)?;
    let most = disparities.iter().copied().reduce(f32::max)?;
    let within = share(&|disparity| outcome.range.contains(disparity.round() as i32));
    let negative = share(&|disparity| disparity < 0.0);
    let mixed_up = "if left and right are mixed up, exchange them";
    if within < 0.5 {
        let (percent, range) = (100.0 * within, span(outcome.range));
        let advice = match outcome.range_source {
            _ if negative > 0.5 => mixed_up,
            RangeSource::Asked => "leave `disparities` out to have the range found",
            _ if config.least.is_some_and(|min| least < min as f32) => "lower `min_disparity`",
            _ => "name the range with `min_disparity` and `disparities`",
        };
        Some(format!(
            "only {percent:.0} % of the matches lie in {range}, their disparities are {least:.0} to {most:.0} px: {advice}"
        ))
    } else if negative > 0.75 {
        Some(format!("disparities are {least:.0} to {most:.0} px, mostly negative: {mixed_up}"))
    } else {
        None
    }
}

/// A warning if surfaces lie at an end of the searched range. A map that is not to be trusted, of a range that was found and
/// widened already, says nothing of its range.
fn at_end(config: &Config, outcome: &Outcome) -> Option<String> {
    /// Share of the map at an end of a range that holds the scene, in per cent.
    const USUAL: f32 = 2.0;
    let Outcome { range, at_ends: [low, high], .. } = outcome;
    let (share, end) = if high >= low { (100.0 * high, range.last()) } else { (100.0 * low, range.min) };
    let seen_there = end == 0 && outcome.seeding.range.is_ok();
    let named = config.range.is_some() || config.least == Some(range.min);
    (share > USUAL && !seen_there && (named || outcome.trust >= TRUSTED)).then(|| {
        format!("{share:.0} % of the disparities lie at {end} px, an end of the range: name a wider one with `min_disparity` and `disparities`")
    })
}

/// A warning if the views differ notably in brightness, which absolute differences suffer from.
fn brightness(outcome: &Outcome) -> Option<String> {
    /// Difference in grey values that most pairs from two cameras of one kind stay below.
    const NOTABLE: f32 = 8.0;
    let found = outcome.seeding.brightness?;
    let difference = |grey: f32| found.gain * grey + found.offset - grey;
    let largest = [64.0, 192.0].map(difference).into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let word = if largest > 0.0 { "brighter" } else { "darker" };
    (largest.abs() > NOTABLE).then(|| {
        format!(
            "the right view is up to {:.0} grey values {word} than the left (x {:.2} {:+.0}): take both with one \
             exposure for a better result",
            largest.abs(),
            found.gain,
            found.offset
        )
    })
}
