//! The whole way from two pictures to a disparity map.

use std::time::{Duration, Instant};

use crate::{
    config::Config,
    dense::{Dense, DenseConfig},
    disparity::DisparityRange,
    error::{Error, Result},
    features::Feature,
    io::Picture,
    pair::{Backend, Pair},
    seeding::{Seeding, ThinSupport, Verdict},
};

/// A step of the pipeline, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Both pictures become luma on the device.
    Luma,
    /// Interest points are found and described.
    Features,
    /// They are matched, and the range is found.
    Seeding,
    /// Every pixel gets a disparity.
    Dense,
}

impl Step {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Luma, Self::Features, Self::Seeding, Self::Dense];

    /// Its name in one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Luma => "luma",
            Self::Features => "features",
            Self::Seeding => "seeding",
            Self::Dense => "dense",
        }
    }
}

/// Where the disparity range came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RangeSource {
    /// It was asked for.
    Asked,
    /// It was found from the seeds.
    Seeds,
    /// There were too few seeds: a quarter of the picture's width, from 0 on.
    Fallback(ThinSupport),
}

/// All that is known of a pair in the end.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Interest points of the left and of the right view.
    pub features: [Vec<Feature>; 2],
    /// What their matches tell.
    pub seeding: Seeding,
    /// The disparities that were searched.
    pub range: DisparityRange,
    /// Who named them.
    pub range_source: RangeSource,
    /// The map of the reference view.
    pub dense: Dense,
    /// What each step took, building its kernels and waiting for it included.
    pub times: Vec<(Step, Duration)>,
}

/// Computes everything, calling `begin` at the beginning of each step.
///
/// # Errors
/// [`Error::SizesDiffer`]; [`Error::TooSmall`] for pictures that hold no window;
/// [`Error::NotRectified`] unless `config.force`; and what the steps report.
pub fn run(
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

    check_window(left.size(), config)?;
    enter(Some(Step::Luma));
    let pair = Pair::new(backend, left, right)?;
    enter(Some(Step::Features));
    let features = pair.features(&config.features)?;
    enter(Some(Step::Seeding));
    let seeding = Seeding::find(pair.views(), (&features[0], &features[1]), &config.seeding)?;
    if seeding.rectification.verdict == Verdict::NotRectified && !config.force {
        return Err(Error::NotRectified { diagnosis: seeding.rectification.to_string() });
    }
    let (range, range_source) = match (config.range, seeding.range) {
        (Some(range), _) => (range, RangeSource::Asked),
        (None, Ok(range)) => (range, RangeSource::Seeds),
        (None, Err(thin)) => (DisparityRange::new(0, left.width().div_ceil(4))?, RangeSource::Fallback(thin)),
    };
    enter(Some(Step::Dense));
    let dense = pair.dense(&dense_config(config, range))?;
    enter(None);
    Ok(Outcome { features, seeding, range, range_source, dense, times })
}

fn dense_config(config: &Config, range: DisparityRange) -> DenseConfig {
    DenseConfig {
        window: config.window,
        range,
        reference: config.reference,
        interpolation: config.interpolation,
        uniqueness: config.uniqueness,
        consistency: config.consistency,
    }
}

fn check_window((width, height): (u32, u32), config: &Config) -> Result<()> {
    if width.min(height) >= config.window {
        return Ok(());
    }
    Err(Error::TooSmall {
        width,
        height,
        what: format!("a window of {0}x{0}", config.window),
        way_out: "use a larger picture or a smaller --window".into(),
    })
}
