//! The pipeline from two pictures to a disparity map.

use web_time::{Duration, Instant};

#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    backend::Backend,
    config::{Config, Method},
    dense::{Brightness, Dense, DenseConfig, View},
    disparity::DisparityRange,
    error::{Error, Result},
    features::{Feature, FeatureConfig},
    image::{Plane, Size},
    io::Picture,
    kamencay::KamencayConfig,
    mask::{self, extended, mask_of},
    names::names,
    pair::Pair,
    seeding::{FoundRange, RangeEnd, Seeding, ThinSupport, Verdict, enlarged_feature},
};

/// Largest number of pixels of a picture in which interest points are detected; larger pictures are downscaled first.
const MAX_SPARSE_PIXELS: u64 = 1 << 21;

/// A step of the pipeline, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Conversion of both pictures to luma on the backend.
    Luma,
    /// Detection and description of interest points.
    Features,
    /// Matching of interest points; disparity range, rectification and brightness from the matches.
    Seeding,
    /// Dense matching, or Kamencay's method.
    Dense,
}

names!(Step, "the step", { Luma => "luma", Features => "features", Seeding => "seeding", Dense => "dense" });

/// Origin of the disparity range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RangeSource {
    /// Set by [`Config::range`].
    Asked,
    /// Found from the seeds and the coarse map: origin of the smallest and of the largest disparity.
    Found([RangeEnd; 2]),
    /// Unknown: a quarter of the width of the picture, from [`Config::least`] or 0 upwards.
    Fallback(ThinSupport),
}

/// Results of the pipeline.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Interest points of the left and of the right view. Points with orientations, against
    /// [`FeatureConfig::upright`], if upright points left rectification unknown and points with orientations did not.
    pub features: [Vec<Feature>; 2],
    /// Seeds, disparity range, rectification, brightness relation and trust, from the matches of the interest points.
    pub seeding: Seeding,
    /// Searched disparity range, without the disparities that the width of the picture rules out.
    pub range: DisparityRange,
    /// Origin of the range.
    pub range_source: RangeSource,
    /// Change of the right view's brightness before dense matching.
    pub brightness: Brightness,
    /// Which pixels of the left and of the right view show the scene: 255, or 0 for a pixel in a constant border or with an
    /// alpha of 0; `None` if all do.
    pub masks: [Option<Plane<u8>>; 2],
    /// Disparities and confidences of the reference view.
    pub dense: Dense,
    /// Duration of each step, with the compilation of its kernels and the wait for its results.
    pub times: Vec<(Step, Duration)>,
}

/// Runs the pipeline on a pair, and calls `begin` at the beginning of each step.
///
/// # Errors
/// [`Error::SizesDiffer`]; [`Error::Parameter`]; [`Error::TooSmall`] for pictures that hold no window;
/// [`Error::NotRectified`] unless [`Config::force`]; [`Error::NoRange`] if the range of the seeds lies below
/// [`Config::least`]; the errors of [`Pair`] and of [`Backend::kamencay`].
#[cfg(not(target_arch = "wasm32"))]
pub fn run(
    backend: &Backend,
    views: (&Picture, &Picture),
    config: &Config,
    begin: impl FnMut(Step),
) -> Result<Outcome> {
    block_on(run_async(backend, views, config, begin))
}

/// The asynchronous [`run`]. Work on the host blocks.
///
/// # Errors
/// See [`run`].
pub async fn run_async(
    backend: &Backend,
    (left, right): (&Picture, &Picture),
    config: &Config,
    mut begin: impl FnMut(Step),
) -> Result<Outcome> {
    let mut times = Vec::new();
    let mut begun = None;
    let mut enter = |step: Option<Step>| {
        if let Some((step, start)) = begun.replace((step, Instant::now())) {
            times.extend(step.map(|step| (step, Instant::elapsed(&start))));
        }
        step.into_iter().for_each(&mut begin);
    };

    config.validate()?;
    check_window(left.size(), config)?;
    enter(Some(Step::Luma));
    let pair = Pair::new(backend, left, right).await?;
    let views = pair.views();
    let masks = [mask_of(left, views.0), mask_of(right, views.1)];
    let shown = [(views.0, &masks[0]), (views.1, &masks[1])];
    let extended = shown.map(|(view, mask)| mask.as_ref().map(|mask| extended(view, mask)));
    let pair = pair.with_views(extended).await?;
    enter(Some(Step::Features));
    let factor = reduction(pair.size());
    let reduced = if factor == 1 { None } else { Some(pair.reduced(factor).await?) };
    let sparse = reduced.as_ref().unwrap_or(&pair);
    let reduced_masks = masks.each_ref().map(|mask| mask.as_ref().map(|mask| mask::reduced(mask, factor)));
    let seen_features = async |config: &FeatureConfig| -> Result<[Vec<Feature>; 2]> {
        let mut features = sparse.features(config).await?;
        for (points, mask) in features.iter_mut().zip(&reduced_masks) {
            points.retain(|point| mask.as_ref().is_none_or(|mask| mask::is_seen(mask, point)));
        }
        Ok(features)
    };
    let mut features = seen_features(&config.features).await?;
    enter(Some(Step::Seeding));
    let find =
        |features: &[Vec<Feature>; 2]| Seeding::find(sparse.views(), (&features[0], &features[1]), &config.seeding);
    let mut seeding = find(&features)?;
    if seeding.rectification.verdict == Verdict::Unknown && config.features.upright {
        // Upright descriptors of views that are rotated against each other do not match.
        let turned = seen_features(&FeatureConfig { upright: false, ..config.features.clone() }).await?;
        let found = find(&turned)?;
        if found.rectification.verdict != Verdict::Unknown {
            (features, seeding) = (turned, found);
        }
    }
    let seeding = seeding.enlarged(factor);
    let features = features.map(|view| view.into_iter().map(|point| enlarged_feature(point, factor)).collect());
    if seeding.rectification.verdict == Verdict::NotRectified && !config.force {
        return Err(Error::NotRectified { diagnosis: seeding.rectification.to_string() });
    }
    let (range, range_source) = match (config.range, seeding.range) {
        (Some(range), _) => (range, RangeSource::Asked),
        (None, Ok(found)) => (not_below(&found, config.least)?, RangeSource::Found(found.ends)),
        (None, Err(thin)) => {
            let range = DisparityRange::new(config.least.unwrap_or(0), left.width().div_ceil(4))?;
            (range, RangeSource::Fallback(thin))
        }
    };
    let brightness = match seeding.brightness {
        Some(found) if config.equalise => found.equalising(),
        _ => Brightness::SAME,
    };
    let (range, dense) = match &config.method {
        Method::Hsad(parameters) => {
            let dense = config.dense(parameters, range, brightness);
            let range = dense.searched(left.width())?;
            enter(Some(Step::Dense));
            (range, pair.dense(&DenseConfig { range, ..dense }).await?)
        }
        Method::Kamencay(parameters) => {
            let task = config.kamencay(parameters, range, brightness);
            let range = task.searched(left.width())?;
            enter(Some(Step::Dense));
            (range, backend.kamencay(left, right, &KamencayConfig { range, ..task }).await?)
        }
    };
    let [own, other] = if config.reference == View::Left { [0, 1] } else { [1, 0] };
    let dense = mask::masked(dense, config.reference, masks[own].as_ref(), masks[other].as_ref());
    enter(None);
    Ok(Outcome { features, seeding, range, range_source, brightness, masks, dense, times })
}

/// The integer factor by which a pair is downscaled before interest points are detected. A few thousand points determine
/// range, rectification and brightness, and the time to match points grows with the square of their number.
pub fn reduction(size: impl Into<Size>) -> u32 {
    let pixels = size.into().pixels();
    (1..).find(|&factor| pixels <= MAX_SPARSE_PIXELS * u64::from(factor).pow(2)).unwrap_or(1)
}

/// The part of a found range that lies above `least`.
fn not_below(found: &FoundRange, least: Option<i32>) -> Result<DisparityRange> {
    let range = found.range;
    let Some(least) = least.filter(|&least| least > range.min) else { return Ok(range) };
    // A margin alone above the limit is no range.
    if (least as f32) < found.seen[1].max(1.0) {
        return DisparityRange::inclusive(least, range.last());
    }
    Err(Error::NoRange {
        reason: format!(
            "the views show {:.0} to {:.0} px and nothing below {least} is to be searched; if left and right are mixed up, \
             exchange them",
            found.seen[0], found.seen[1],
        ),
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_pictures_are_reduced() {
        assert_eq!(reduction((1, 1)), 1);
        assert_eq!(reduction((2048, 1024)), 1);
        assert_eq!(reduction((2048, 1025)), 2);
        // 24 megapixels in blocks of 16 are 1.5.
        assert_eq!(reduction((6000, 4000)), 4);
    }

    #[test]
    fn a_found_range_is_cut_at_the_limit() {
        let range = DisparityRange::inclusive(-9, 40).unwrap();
        let found = FoundRange { range, seen: [-5.0, 36.0], ends: [RangeEnd::Seeds, RangeEnd::CoarseMap] };
        assert_eq!(not_below(&found, None).unwrap(), range);
        assert_eq!(not_below(&found, Some(-20)).unwrap(), range);
        assert_eq!(not_below(&found, Some(0)).unwrap(), DisparityRange::inclusive(0, 40).unwrap());
        let error = not_below(&found, Some(36)).unwrap_err().to_string();
        assert!(error.contains("-5 to 36 px") && error.contains("exchange"), "{error}");
        let exchanged = FoundRange { range: DisparityRange::inclusive(-40, 3).unwrap(), seen: [-37.0, -4.0], ..found };
        assert!(not_below(&exchanged, Some(0)).is_err(), "the margin reaches above 0, the disparities do not");
    }
}
