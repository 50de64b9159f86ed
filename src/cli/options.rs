//! Options that several subcommands share, and how they become a configuration.

use std::{fmt::Display, path::PathBuf};

use anyhow::anyhow;
use clap::{Args, ValueEnum};
use hsad::{
    Error, Result,
    backend::Backend,
    config::{Config, Method, Preset},
    dense::{Aggregation, CrossCheck, Interpolation, Paths, Search, SemiGlobal, View},
    disparity::{DisparityRange, SCALE},
    features::FeatureConfig,
    gpu::DeviceChoice,
    io::Calibration,
    kamencay::KamencayParameters,
    matching::MatchConfig,
    verify::self_test,
};

use super::terminal::{self, Progress};

/// How a subcommand runs.
#[derive(Args)]
pub struct RunOptions {
    /// What computes: best, cpu, or index or part of the name of a device (see hsad devices)
    #[arg(long, default_value = "best")]
    device: DeviceChoice,
    /// First run every kernel once on the device, and refuse it if any differs from its CPU twin (see hsad verify)
    #[arg(long)]
    self_test: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl RunOptions {
    /// Opens the device, and tests it if that is asked for.
    pub fn open(&self) -> anyhow::Result<Backend> {
        let backend = self.open_untested()?;
        if let (true, Backend::Gpu(gpu)) = (self.self_test, &backend) {
            let progress = Progress::new(self.quiet);
            progress.begin("testing the device");
            self_test(gpu, &self.device)?;
        }
        Ok(backend)
    }

    /// The best device there is can be none at all, and then the CPU works.
    fn open_untested(&self) -> anyhow::Result<Backend> {
        match Backend::open(&self.device) {
            Err(error @ (Error::NoAdapter | Error::Unsupported(_))) if self.device == DeviceChoice::Best => {
                if !self.quiet {
                    terminal::warning(format!("the CPU does the work, since {error}"));
                }
                Ok(Backend::open(&DeviceChoice::Cpu)?)
            }
            Err(error @ Error::NoAdapter) => Err(anyhow!("{error}, or use the CPU with --device cpu")),
            opened => Ok(opened?),
        }
    }
}

/// How interest points are found.
#[derive(Args)]
#[command(next_help_heading = "Interest points")]
pub struct FeatureOptions {
    #[arg(long, value_name = "N", help = with_default("Octaves of filter sizes, 1 to 5", FeatureConfig::default().octaves))]
    octaves: Option<u32>,
    #[arg(long, value_name = "PX", help = with_default("Sampling step of the first octave in pixels, 1 or 2", FeatureConfig::default().step))]
    step: Option<u32>,
    #[arg(long, value_name = "T", help = with_default("Least determinant of the Hessian, with grey values of 0 to 1", FeatureConfig::default().threshold))]
    threshold: Option<f32>,
    /// Compute orientations, for views that are turned against each other
    #[arg(long, conflicts_with = "upright")]
    oriented: bool,
    /// Compute no orientations, the better choice where nothing is turned
    #[arg(long)]
    upright: bool,
    #[arg(long, value_name = "N", help = with_default("Room for this many points; more are an error", FeatureConfig::default().max_features))]
    max_features: Option<u32>,
}

impl FeatureOptions {
    /// `config` with the options that were given.
    pub fn over(&self, config: FeatureConfig) -> FeatureConfig {
        FeatureConfig {
            octaves: self.octaves.unwrap_or(config.octaves),
            step: self.step.unwrap_or(config.step),
            threshold: self.threshold.unwrap_or(config.threshold),
            upright: (config.upright || self.upright) && !self.oriented,
            max_features: self.max_features.unwrap_or(config.max_features),
        }
    }
}

/// An option's help with the value that the library takes where it is not given.
pub fn with_default(help: &str, value: impl Display) -> String {
    format!("{help} [default: {value}]")
}

/// How pixels are matched.
#[derive(Args)]
#[command(next_help_heading = "Matching")]
pub struct MatchOptions {
    /// How disparities are found
    #[arg(long, value_enum, default_value = "hsad")]
    method: MethodName,
    /// Where parameters come from that no option names [default: balanced]
    #[arg(long, value_enum)]
    preset: Option<PresetName>,
    /// Match blocks, in a square window of this side, odd, 3 to 31 [fast: 9, paper: 7; balanced and quality
    /// match semi-globally instead]
    #[arg(long, value_name = "PX")]
    window: Option<u32>,
    /// From how many sides costs are put together, where they are semi-globally; from none, the window of
    /// costs alone decides [balanced: 3, quality: 4]
    #[arg(long, value_enum, value_name = "N", conflicts_with = "window")]
    paths: Option<PathsName>,
    /// Side of the square over which each disparity's costs are averaged before that, odd, 1 to 31 [balanced,
    /// quality: 1]
    #[arg(long, value_name = "PX", conflicts_with = "window")]
    cost_window: Option<u32>,
    /// Compare blocks of both views at every disparity of the range [fast: at those that a map of half the
    /// size shows nearby, and of the other view at half the size]
    #[arg(long)]
    whole_range: bool,
    /// Smallest disparity: with --disparities where the range begins [default: 0], without it a
    /// limit to the range that is found [paper: 0]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    min_disparity: Option<i32>,
    /// How many disparities are searched [default: found from matching interest points]
    #[arg(long, value_name = "N")]
    disparities: Option<u32>,
    /// The view whose pixels get a disparity [default: left, paper: right]
    #[arg(long, value_enum)]
    reference: Option<ViewName>,
    /// Per cent by which the best rival must cost more than the winner, 0 to 100 [default: 1,
    /// fast: 10, paper: 0]
    #[arg(long, value_name = "PERCENT")]
    uniqueness: Option<u32>,
    /// Largest difference of the disparities that the two views find [default: 1, paper: no check]; fast
    /// allows a pixel more, since it asks the other view at half the size
    #[arg(long, value_name = "PX", conflicts_with = "no_lr_check", allow_negative_numbers = true)]
    max_lr_difference: Option<f32>,
    /// Do not ask the other view
    #[arg(long)]
    no_lr_check: bool,
    /// Search the other view as well, instead of taking the first one's word for it: fewer mistakes beside
    /// things that hide others, for nearly twice the time [fast: --whole-range]
    #[arg(long, conflicts_with = "no_lr_check")]
    search_both_views: bool,
    /// Leave holes where the two views disagree or hardly any neighbour agrees
    #[arg(long)]
    no_fill: bool,
    /// Take the views' brightness as it is, even where the seeds tell that it differs
    #[arg(long)]
    no_equalise: bool,
    /// How disparities between whole pixels are found [default: equiangular, paper: parabola]
    #[arg(long, value_enum)]
    interpolation: Option<InterpolationName>,
    #[arg(long, value_name = "R", help = with_default("Largest ratio of the distances of the best and the second \
        descriptor, up to 1", MatchConfig::default().ratio))]
    ratio: Option<f32>,
    /// Show only the N strongest interest points and matches in the figures [default: all, paper:
    /// 10]
    #[arg(long, value_name = "N")]
    strongest: Option<usize>,
    /// Go on with a pair that is not rectified
    #[arg(long)]
    force: bool,
}

impl MatchOptions {
    /// The preset with the options that were given.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value out of its range.
    pub fn config(&self, features: &FeatureOptions) -> Result<Config> {
        let mut config = self.preset.map_or(Preset::default(), Preset::from).config();
        if let MethodName::Kamencay = self.method {
            self.refuse_what_only_hsad_does()?;
            config.method = Method::Kamencay(KamencayParameters::default());
        }
        config.features = features.over(config.features);
        config.seeding.matching.ratio = self.ratio.unwrap_or(config.seeding.matching.ratio);
        config.least = self.min_disparity.or(config.least);
        if let Some(count) = self.disparities {
            config.range = Some(DisparityRange::new(self.min_disparity.unwrap_or(0), count)?);
        }
        config.strongest = self.strongest.or(config.strongest);
        config.reference = self.reference.map_or(config.reference, View::from);
        if let Some(side) = self.window {
            let search = match config.aggregation {
                Aggregation::Window { search, .. } => search,
                Aggregation::Paths(_) => Search::Whole,
            };
            config.aggregation = Aggregation::Window { side, search };
        }
        if let (true, Aggregation::Window { search, .. }) = (self.whole_range, &mut config.aggregation) {
            *search = Search::Whole;
        }
        if let (true, Aggregation::Paths(paths)) = (self.search_both_views, &mut config.aggregation) {
            paths.cross_check = CrossCheck::Searched;
        }
        self.choose_paths(&mut config.aggregation)?;
        config.interpolation = self.interpolation.map_or(config.interpolation, Interpolation::from);
        config.uniqueness = self.uniqueness.unwrap_or(config.uniqueness);
        if let Some(pixels) = self.max_lr_difference {
            config.consistency = Some(fixed_point(pixels)?);
        } else if self.no_lr_check {
            config.consistency = None;
        }
        if let (true, Some(refinement)) = (self.no_fill, &mut config.refinement) {
            refinement.fill = false;
        }
        config.equalise &= !self.no_equalise;
        config.force = self.force;
        config.validate()?;
        Ok(config)
    }

    fn choose_paths(&self, aggregation: &mut Aggregation) -> Result<()> {
        let Self { paths: asked, cost_window, .. } = *self;
        match aggregation {
            Aggregation::Paths(SemiGlobal { window, paths, .. }) => {
                *paths = asked.map_or(*paths, Paths::from);
                *window = cost_window.unwrap_or(*window);
            }
            Aggregation::Window { .. } if asked.is_some() || cost_window.is_some() => {
                return Err(Error::Parameter {
                    name: "preset",
                    value: self
                        .preset
                        .and_then(|preset| preset.to_possible_value())
                        .map_or_else(String::new, |name| name.get_name().into()),
                    expected: "--paths and --cost-window need balanced or quality".into(),
                });
            }
            Aggregation::Window { .. } => {}
        }
        Ok(())
    }
}

impl MatchOptions {
    /// The options that the hybrid method has no use for.
    fn refuse_what_only_hsad_does(&self) -> Result<()> {
        let given = [
            ("--preset", self.preset.is_some()),
            ("--window", self.window.is_some()),
            ("--whole-range", self.whole_range),
            ("--search-both-views", self.search_both_views),
            ("--paths", self.paths.is_some()),
            ("--cost-window", self.cost_window.is_some()),
            ("--uniqueness", self.uniqueness.is_some()),
            ("--max-lr-difference", self.max_lr_difference.is_some()),
            ("--no-lr-check", self.no_lr_check),
            ("--no-fill", self.no_fill),
            ("--interpolation", self.interpolation.is_some()),
        ];
        match given.into_iter().find(|&(_, is_given)| is_given) {
            None => Ok(()),
            Some((name, _)) => Err(Error::Parameter {
                name: "--method",
                value: "kamencay".into(),
                expected: format!("{name} is for --method hsad: leave one of them out"),
            }),
        }
    }
}

fn fixed_point(pixels: f32) -> Result<u32> {
    if (0.0..=256.0).contains(&pixels) {
        return Ok((pixels * SCALE as f32).round() as u32);
    }
    Err(Error::Parameter {
        name: "max-lr-difference",
        value: pixels.to_string(),
        expected: "it must be 0 to 256 px".into(),
    })
}

/// What turns disparities into metres.
#[derive(Args)]
#[command(next_help_heading = "Depth")]
pub struct DepthOptions {
    /// Calibration of the pair, in the form of Middlebury's calib.txt
    #[arg(long, value_name = "FILE", conflicts_with_all = ["focal", "baseline", "doffs"])]
    calib: Option<PathBuf>,
    /// Focal length in pixels
    #[arg(long, value_name = "PX", requires = "baseline", allow_negative_numbers = true)]
    focal: Option<f64>,
    /// Distance between the cameras in metres
    #[arg(long, value_name = "METRES", requires = "focal", allow_negative_numbers = true)]
    baseline: Option<f64>,
    /// What a disparity lacks to be 0 at infinity [default: 0]
    #[arg(long, value_name = "PX", requires = "focal", allow_negative_numbers = true)]
    doffs: Option<f64>,
}

impl DepthOptions {
    /// The calibration for pictures of `size`, if there is one.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Format`] and [`Error::Parameter`] for one that cannot be, or that
    /// belongs to other pictures.
    pub fn calibration(&self, size: (u32, u32)) -> Result<Option<Calibration>> {
        let calibration = match (&self.calib, self.focal, self.baseline) {
            (Some(path), ..) => {
                let calibration = Calibration::read(path)?;
                let misfit = |error: Error| Error::Format { path: path.clone(), reason: error.to_string() };
                calibration.check_size(size).map_err(misfit)?;
                calibration
            }
            (None, Some(focal), Some(baseline)) => {
                Calibration::centred(focal, baseline, self.doffs.unwrap_or(0.0), size)?
            }
            _ => return Ok(None),
        };
        Ok(Some(calibration))
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum MethodName {
    /// Block matching or semi-global matching, as a preset says
    Hsad,
    /// Mean-shift segments and belief propagation, after Kamencay and others: for comparison
    Kamencay,
}

#[derive(Clone, Copy, ValueEnum)]
enum PresetName {
    /// Block matching, checked, with holes where the check fails
    Fast,
    /// Semi-global matching, checked and filled
    Balanced,
    /// The same, refined further
    Quality,
    /// The paper to the letter
    Paper,
}

impl From<PresetName> for Preset {
    fn from(name: PresetName) -> Self {
        match name {
            PresetName::Fast => Self::Fast,
            PresetName::Balanced => Self::Balanced,
            PresetName::Quality => Self::Quality,
            PresetName::Paper => Self::Paper,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum PathsName {
    /// None
    #[value(name = "0")]
    None,
    /// Along the row from both ends, along the column from above
    #[value(name = "3")]
    Three,
    /// Along the row and the column
    #[value(name = "4")]
    Four,
    /// Along the diagonals as well
    #[value(name = "8")]
    Eight,
}

impl From<PathsName> for Paths {
    fn from(name: PathsName) -> Self {
        match name {
            PathsName::None => Self::None,
            PathsName::Three => Self::Three,
            PathsName::Four => Self::Four,
            PathsName::Eight => Self::Eight,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum ViewName {
    Left,
    Right,
}

impl From<ViewName> for View {
    fn from(name: ViewName) -> Self {
        match name {
            ViewName::Left => Self::Left,
            ViewName::Right => Self::Right,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum InterpolationName {
    /// Whole pixels
    None,
    /// The vertex of a parabola
    Parabola,
    /// The tip of two lines of equal slope
    Equiangular,
}

impl From<InterpolationName> for Interpolation {
    fn from(name: InterpolationName) -> Self {
        match name {
            InterpolationName::None => Self::None,
            InterpolationName::Parabola => Self::Parabola,
            InterpolationName::Equiangular => Self::Equiangular,
        }
    }
}
