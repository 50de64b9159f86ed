//! The pipeline from two pictures to a disparity map.

mod back;
mod clock;
mod confidence;
pub mod doubts;
#[cfg(feature = "calibrations")]
mod geometry;
mod judgement;
mod known;
mod metric;
mod mirror;
mod no_depth;
mod precedent;
mod range;
mod rectified;
mod reduction;
mod search;
mod taken;
mod taken_pair;
mod task;
#[cfg(not(target_arch = "wasm32"))]
mod tiled;
mod trust;
mod upright;
mod views;
mod way;

pub use back::WayBack;
#[cfg(feature = "calibrations")]
pub use geometry::Geometry;
pub use judgement::Judgement;
#[cfg(not(target_arch = "wasm32"))]
pub use mirror::mirrored;
pub use mirror::{Mirrored, mirrored_async};
pub use no_depth::NoDepth;
pub use precedent::Precedent;
pub use range::RangeSource;
#[cfg(not(target_arch = "wasm32"))]
pub use rectified::rectify_by;
pub use rectified::{RectifiedPair, rectify_by_async};
use reduction::geometry_reduction;
pub use reduction::reduction;
#[cfg(not(target_arch = "wasm32"))]
pub use taken_pair::rectify;
pub use taken_pair::{TakenPair, rectify_async};
pub use task::{Activity, Matched, Task};
#[cfg(not(target_arch = "wasm32"))]
pub use tiled::{cut_tiles, merge_tiles};
pub use trust::TRUSTED;
pub use way::Way;

use web_time::Duration;

use clock::Clock;
use known::{Known, brightness, repetition_of};
use range::range_to_search;
use views::Views;

#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    backend::Backend,
    config::Config,
    dense::{Brightness, Dense},
    disparity::DisparityRange,
    error::{Error, Result},
    features::{Detected, Feature, FeatureConfig},
    image::{Plane, Size},
    io::Picture,
    names::names,
    rectify::RowModel,
    seeding::{RawMatches, Rectification, Seeding, Verdict, enlarged_feature},
};

/// Largest row difference that is matched without alignment, in pixels.
const LARGEST_AS_IS: f32 = 1.5;
/// A step of the pipeline, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Conversion of both pictures to luma on the backend.
    Luma,
    /// Detection and description of interest points.
    Features,
    /// Matching of interest points, alignment of rows, brightness, coarse map and disparity range.
    Seeding,
    /// Dense matching, or Kamencay's method.
    Dense,
}

names!(Step, "the step", { Luma => "luma", Features => "features", Seeding => "seeding", Dense => "dense" });

/// Results of the pipeline.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Interest points of the left and of the right view. Points with orientations, against
    /// [`FeatureConfig::upright`], if upright points left rectification unknown and points with orientations did not.
    pub features: [Vec<Feature>; 2],
    /// Number of interest points of the left and of the right view; more than there are [`Self::features`] if only the
    /// [`FeatureConfig::max_features`] strongest were kept.
    pub points_found: [usize; 2],
    /// The factor by which the views were downscaled before interest points were detected: [`reduction`], or more for a rectified pair.
    pub reduction: u32,
    /// Seeds, coarse map, disparity range, rectification, brightness relation and agreement.
    pub seeding: Seeding,
    /// Searched disparity range, without the disparities that the width of the picture rules out.
    pub range: DisparityRange,
    /// Origin of the range.
    pub range_source: RangeSource,
    /// Shares of the map's disparities within 1.5 px of the smallest and of the largest disparity of the range, 0 to 1, among those whose
    /// partners the other view shows.
    pub at_ends: [f32; 2],
    /// Change of the right view's brightness before dense matching.
    pub brightness: Brightness,
    /// Which pixels of the left and of the right view show the scene: 255, or 0 for a pixel in a constant border or with an
    /// alpha of 0; `None` if all do.
    pub masks: [Option<Plane<u8>>; 2],
    /// Whether the left and the right view are raw mosaics of a Bayer colour filter array; the luma of their colours was
    /// matched then.
    pub mosaics: [bool; 2],
    /// Factor by which both views were enlarged without interpolation, by repeating pixels, so that disparities come in such steps; 1
    /// for other views.
    pub repetition: u32,
    /// Disparities and confidences of the reference view; confidence 0 also where a disparity lies at an end of the range or the view is
    /// constant around the pixel, less where the view has little detail, and below 192 where [`Self::trust`] is below [`TRUSTED`].
    pub dense: Dense,
    /// Trust in the map, 0 to 1; a map with less than [`TRUSTED`] is likely to be wrong in large parts. 0 where there is
    /// [`Self::no_depth`].
    pub trust: f32,
    /// Why disparities tell no depth, if they do not.
    pub no_depth: Option<NoDepth>,
    /// Duration of each step, with the compilation of its kernels and the wait for its results.
    pub times: Vec<(Step, Duration)>,
}

/// Runs the pipeline on a pair, and calls `begin` at the beginning of each step.
///
/// # Errors
/// [`Error::SizesDiffer`]; [`Error::Parameter`]; [`Error::TooSmall`] for pictures that hold no window;
/// [`Error::NotRectified`] unless [`Config::force`]; [`Error::NoRange`] if the disparities found lie below
/// [`Config::least`]; the errors of [`crate::Pair`] and of [`Backend::kamencay`].
#[cfg(not(target_arch = "wasm32"))]
pub fn run(
    backend: &Backend,
    views: (&Picture, &Picture),
    config: &Config,
    mut begin: impl FnMut(Step),
) -> Result<Outcome> {
    blocking(backend, views, config, &mut begin)
}

/// [`run`] for any `begin`: code that is compiled once, and not for each call.
#[cfg(not(target_arch = "wasm32"))]
fn blocking(
    backend: &Backend,
    views: (&Picture, &Picture),
    config: &Config,
    begin: &mut dyn FnMut(Step),
) -> Result<Outcome> {
    block_on(run_async(backend, views, config, begin))
}

/// The asynchronous [`run`]. Work on the host blocks.
///
/// # Errors
/// See [`run`].
pub async fn run_async(
    backend: &Backend,
    views: (&Picture, &Picture),
    config: &Config,
    begin: impl FnMut(Step),
) -> Result<Outcome> {
    run_with_progress(backend, views, config, begin, |_| ()).await
}

/// [`run_async`] with calls of `progress` with the share of [`Step::Dense`] that a device has done, 0 to 1: several per
/// second on a slow device, and from 0 again for each search over a wider range.
///
/// # Errors
/// See [`run`].
pub async fn run_with_progress(
    backend: &Backend,
    (left, right): (&Picture, &Picture),
    config: &Config,
    begin: impl FnMut(Step),
    progress: impl FnMut(f32),
) -> Result<Outcome> {
    let given = Given { pictures: [left, right], rectified: None };
    run_on(backend, given, config, |_| false, begin, progress).await.map(with_fit_rows)
}

/// [`run_with_progress`], unless `is_unfit` says of how rows correspond that the pair is not to be matched: nothing is matched densely
/// then.
///
/// # Errors
/// See [`run`].
pub async fn run_unless(
    backend: &Backend,
    (left, right): (&Picture, &Picture),
    config: &Config,
    is_unfit: impl FnOnce(&Rectification) -> bool,
    begin: impl FnMut(Step),
    progress: impl FnMut(f32),
) -> Result<Option<Outcome>> {
    let given = Given { pictures: [left, right], rectified: None };
    run_on(backend, given, config, is_unfit, begin, progress).await
}

/// [`run_with_progress`] on a rectified pair. Where its rows are still slightly off, the right view is resampled from the view as it
/// was taken, and not a second time.
///
/// # Errors
/// See [`run`].
pub async fn run_rectified(
    backend: &Backend,
    pair: &RectifiedPair,
    config: &Config,
    begin: impl FnMut(Step),
    progress: impl FnMut(f32),
) -> Result<Outcome> {
    let pictures = pair.pictures.each_ref();
    let given = Given { pictures, rectified: Some(pair) };
    run_on(backend, given, config, |_| false, begin, progress).await.map(with_fit_rows)
}

fn with_fit_rows(outcome: Option<Outcome>) -> Outcome {
    outcome.expect("rows that nobody says to be unfit")
}

/// What is matched: two pictures, those of a rectified pair or others.
struct Given<'a> {
    pictures: [&'a Picture; 2],
    rectified: Option<&'a RectifiedPair>,
}

async fn run_on(
    backend: &Backend,
    given: Given<'_>,
    config: &Config,
    is_unfit: impl FnOnce(&Rectification) -> bool,
    begin: impl FnMut(Step),
    progress: impl FnMut(f32),
) -> Result<Option<Outcome>> {
    let mut clock = Clock::new(begin);
    let Some((views, known)) = seeded(backend, &given, config, is_unfit, &mut clock).await? else { return Ok(None) };
    clock.enter(Step::Dense);
    let outcome = known.matched(views, &given, config, progress).await?;
    Ok(Some(Outcome { times: clock.finish(), ..outcome }))
}

/// The views with aligned rows, and what is known of them before they are matched densely; `None` if `is_unfit` says so of their rows.
async fn seeded<'a>(
    backend: &'a Backend,
    given: &Given<'a>,
    config: &Config,
    is_unfit: impl FnOnce(&Rectification) -> bool,
    clock: &mut Clock<impl FnMut(Step)>,
) -> Result<Option<(Views<'a>, Known)>> {
    config.validate()?;
    let [left, right] = given.pictures;
    check_window(left.size(), config)?;
    clock.enter(Step::Luma);
    let views = match given.rectified {
        Some(pair) => Views::of_rectified(backend, pair, config).await?,
        None => Views::new(backend, [left, right], config).await?,
    };
    let size = views.size();
    let repetition = given.rectified.map_or_else(|| repetition_of(&views), |pair| pair.repetition);

    clock.enter(Step::Features);
    // The rows of a rectified pair correspond, as far as points in pictures of half a megapixel tell.
    let factor = if given.rectified.is_some() { geometry_reduction(size) } else { reduction(size) };
    let detected = views.features(factor, &config.features).await?;

    clock.enter(Step::Seeding);
    let (detected, mut matches) = matched(&views, factor, detected, config).await?;
    let points_found = detected.each_ref().map(|view| view.found);
    let features = detected.map(|view| view.features);
    if !config.align {
        matches.rectification.rows = RowModel::AS_IS;
    }
    let rows = matches.rectification.enlarged(factor);
    if !config.force && (rows.rows_differ() || !config.align && rows.largest > LARGEST_AS_IS) {
        return Err(Error::NotRectified { diagnosis: rows.to_string() });
    }
    if is_unfit(&rows) {
        return Ok(None);
    }
    let views = views.aligned(&rows.rows).await?;
    let seeding = {
        let [left, right] = views.reduced(factor);
        let [seen, _] = views.masks(factor);
        matches.seeding((&left, &right), seen.as_ref(), (&features[0], &features[1]), &config.seeding)?
    };
    let seeding = seeding.enlarged(factor);
    let features = features.map(|view| view.into_iter().map(|point| enlarged_feature(point, factor)).collect());
    let brightness = brightness(config, &seeding);
    let (range, range_source) = range_to_search(config, &seeding, size.width)?;

    let known =
        Known { features, points_found, seeding, range, range_source, widens: true, brightness, repetition, factor };
    Ok(Some((views, known)))
}

/// Matches the features of the views in any row, or features with orientations where upright ones do not tell how rows
/// correspond; returns the features that were matched, too.
async fn matched(
    views: &Views<'_>,
    factor: u32,
    detected: [Detected; 2],
    config: &Config,
) -> Result<([Detected; 2], RawMatches)> {
    let size = views.size().reduced(factor);
    let anywhere =
        |[left, right]: &[Detected; 2]| RawMatches::new((&left.features, &right.features), size, &config.seeding);
    let matches = anywhere(&detected)?;
    if matches.rectification.is_certain() || !config.features.upright {
        return Ok((detected, matches));
    }
    // Upright descriptors of views that are rotated against each other do not match, or rarely.
    let turned = views.features(factor, &FeatureConfig { upright: false, ..config.features.clone() }).await?;
    let found = anywhere(&turned)?;
    let unknown = |matches: &RawMatches| matches.rectification.verdict == Verdict::Unknown;
    if found.rectification.is_certain() || unknown(&matches) && !unknown(&found) {
        return Ok((turned, found));
    }
    Ok((detected, matches))
}

fn check_window(size: Size, config: &Config) -> Result<()> {
    if size.width.min(size.height) >= config.smallest_side() {
        return Ok(());
    }
    Err(Error::TooSmall {
        size,
        what: format!("a window of {0}x{0}", config.smallest_side()),
        way_out: "use a larger picture or a smaller window".into(),
    })
}
