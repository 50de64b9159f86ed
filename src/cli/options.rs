//! Options that several subcommands share, and their translation to a configuration.

use std::{
    fmt::{Debug, Display},
    path::PathBuf,
    str::FromStr,
};

use anyhow::anyhow;
use clap::{
    Args, ValueEnum,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};
use hsad::{
    Backend, Error, Result,
    config::{Config, Method, Preset},
    dense::{
        Aggregation, Compared, CrossCheck, DenseParameters, Interpolation, Paths, Refinement, Search, SemiGlobal, View,
    },
    disparity::{DisparityRange, SCALE},
    features::FeatureConfig,
    gpu::DeviceChoice,
    io::load::Unseen,
    kamencay::KamencayParameters,
    matching::MatchConfig,
    verify::self_test,
};

use super::{
    pipeline_cache::CachedBackend,
    terminal::{self, Progress},
};

/// Device and verbosity of a subcommand.
#[derive(Args)]
pub struct RunOptions {
    /// Device to compute on: best, cpu, or the index or a part of the name of a device (see hsad devices)
    #[arg(long, default_value_t = DeviceChoice::Best)]
    device: DeviceChoice,
    /// First run every kernel once on the device and refuse it if any result differs from the CPU twin's (see
    /// hsad verify)
    #[arg(long)]
    self_test: bool,
    /// Print errors only, and whether the CPU takes the place of a device
    #[arg(short, long)]
    pub quiet: bool,
}

impl RunOptions {
    /// Opens the device with its pipeline cache, and runs the self-test with `--self-test`.
    pub fn open(&self) -> anyhow::Result<CachedBackend> {
        let cached = CachedBackend::new(self.open_untested()?);
        if let (true, Backend::Gpu(gpu)) = (self.self_test, &cached.backend) {
            let progress = Progress::new(self.quiet);
            progress.begin("testing the device");
            self_test(gpu, &self.device)?;
        }
        Ok(cached)
    }

    /// Opens the device. For `best` the CPU takes over if there is no usable adapter.
    fn open_untested(&self) -> anyhow::Result<Backend> {
        match Backend::open(&self.device) {
            Err(error @ (Error::NoAdapter | Error::Unsupported(_))) if self.device == DeviceChoice::Best => {
                // Even if quiet: the work takes many times as long.
                terminal::warning(format!("the CPU does the work: {error}"));
                Ok(Backend::open(&DeviceChoice::Cpu)?)
            }
            Err(error @ Error::NoAdapter) => Err(anyhow!("{error}, or use the CPU with --device cpu")),
            opened => Ok(opened?),
        }
    }
}

/// Parameters of the interest point detector.
#[derive(Args)]
#[command(next_help_heading = "Interest points")]
pub struct FeatureOptions {
    #[arg(long, value_name = "N", help = with_default("Number of octaves of filter sizes, 1 to 5", FeatureConfig::default().octaves))]
    octaves: Option<u32>,
    #[arg(long, value_name = "PX", help = with_default("Sampling step of the first octave in pixels, 1 or 2", FeatureConfig::default().step))]
    step: Option<u32>,
    #[arg(long, value_name = "T", help = with_default("Smallest determinant of the Hessian of a point, for grey values of 0 to 1; above 0, at most 1", FeatureConfig::default().threshold))]
    threshold: Option<f32>,
    /// Compute orientations, for views rotated against each other
    #[arg(long, conflicts_with = "upright")]
    oriented: bool,
    /// Skip orientations, the better choice for views without rotation [default, except paper]
    #[arg(long)]
    upright: bool,
    #[arg(long, value_name = "N", help = with_default("Most interest points per view, 1 to 1048576; of more the strongest are kept, spread over the picture", FeatureConfig::default().max_features))]
    max_features: Option<u32>,
}

impl FeatureOptions {
    /// `config`, overridden by the options on the command line.
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

/// Help text of an option whose default value comes from the library.
pub fn with_default(help: &str, value: impl Display) -> String {
    format!("{help} [default: {value}]")
}

/// Parameters of dense matching.
#[derive(Args)]
#[command(next_help_heading = "Matching")]
pub struct MatchOptions {
    /// Dense matching method
    #[arg(long, value_enum, default_value = "hsad")]
    method: MethodName,
    /// Set of parameters; single options override it [default: balanced]
    #[arg(long, value_parser = presets())]
    preset: Option<Preset>,
    /// Match blocks: side of the square window in pixels, odd, 3 to 31 [default: fast 9, paper 7; balanced and
    /// quality match semi-globally]
    #[arg(long, value_name = "PX")]
    window: Option<u32>,
    /// Number of paths of semi-global matching; with 0 the cost window alone decides [default: balanced 3,
    /// quality 4]
    #[arg(long, value_parser = paths(), value_name = "N", conflicts_with = "window")]
    paths: Option<PathCount>,
    /// Side in pixels of the square window that averages the costs of each disparity before the paths, odd, 1 to
    /// 31 [default: 1]
    #[arg(long, value_name = "PX", conflicts_with = "window")]
    cost_window: Option<u32>,
    /// What blocks compare [default: soft-rank, paper luma]
    #[arg(long, value_parser = compared())]
    compare: Option<Compared>,
    /// Compare at every disparity of the range [default of fast: coarse to fine, near the disparities of a map of half
    /// the size; of balanced and quality, in pictures at least 1600 px wide: over a pyramid, near the disparities of the
    /// level above]
    #[arg(long)]
    whole_range: bool,
    /// Smallest disparity in pixels, -1048576 to 1048576: with --disparities the start of the range
    /// [default: 0], without it a lower limit of the range that is found [default: none, paper 0]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    min_disparity: Option<i32>,
    /// Number of disparities to search, at least 1 [default: found from a coarse map and matching interest points]
    #[arg(long, value_name = "N")]
    disparities: Option<u32>,
    /// Reference view, whose pixels get a disparity [default: left, paper right]
    #[arg(long, value_parser = views())]
    reference: Option<View>,
    /// Uniqueness margin: per cent by which the best rival, two or more disparities away, must cost more than the best
    /// disparity, 0 to 100
    /// [default: 1, fast 16, paper 0]
    #[arg(long, value_name = "PERCENT")]
    uniqueness: Option<u32>,
    /// Left-right consistency check: largest difference of the two views' disparities in pixels, 0 to 256
    /// [default: 1, fast and paper no check]; fast allows 1 px more, since it checks at half the size
    #[arg(long, value_name = "PX", conflicts_with = "no_lr_check", allow_negative_numbers = true)]
    max_lr_difference: Option<f32>,
    /// Skip the left-right consistency check
    #[arg(long)]
    no_lr_check: bool,
    /// Match the other view separately for the left-right consistency check, instead of deriving its
    /// disparities from those of the reference view: fewer errors beside occlusions, for nearly twice the time. Block
    /// matching does so for any check: over the whole range at the whole size, coarse to fine at half the size
    #[arg(long, conflicts_with = "no_lr_check")]
    search_both_views: bool,
    /// Agreement check: of nine pixels, the pixel itself and the eight pixels 3 columns, rows, or both away, the number
    /// whose disparities must lie within 2 px of the pixel's, 0 to 9 [default: no check, fast 6]
    #[arg(long, value_name = "N")]
    agreement: Option<u32>,
    /// Fill holes, and refine the map as balanced does [default of balanced and quality]
    #[arg(long)]
    fill: bool,
    /// Leave holes where a check fails or too few neighbours agree [default of fast and paper]
    #[arg(long, conflicts_with = "fill")]
    no_fill: bool,
    /// Do not equalise the brightness of the views, even where matched points show a difference
    #[arg(long)]
    no_equalise: bool,
    /// Do not align rows: match the right view as it is, even where matched points show that its rows are slightly off [default of paper]
    #[arg(long)]
    no_align: bool,
    /// Sub-pixel interpolation of disparities [default: equiangular, paper parabola]
    #[arg(long, value_parser = interpolations())]
    interpolation: Option<Interpolation>,
    #[arg(long, value_name = "R", help = with_default("Ratio test: largest ratio of the distances of the best and the \
        second best descriptor, above 0, at most 1", MatchConfig::default().ratio))]
    ratio: Option<f32>,
    /// Draw only the N strongest interest points and matches in the figures, at least 1 [default: all,
    /// paper 10]
    #[arg(long, value_name = "N")]
    strongest: Option<usize>,
    /// Match the pair even if it is not rectified and cannot be, and accept a map that is not to be trusted
    #[arg(long)]
    force: bool,
}

impl MatchOptions {
    /// The preset, overridden by the options on the command line.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value outside its range, or options that exclude each other.
    pub fn config(&self, features: &FeatureOptions) -> Result<Config> {
        let preset = self.preset.unwrap_or_default();
        let mut config = preset.config();
        config.method = match self.method {
            MethodName::Hsad => Method::Hsad(self.dense_parameters(preset)?),
            MethodName::Kamencay => {
                self.refuse_what_only_hsad_does()?;
                Method::Kamencay(KamencayParameters::default())
            }
        };
        config.features = features.over(config.features);
        config.seeding.matching.ratio = self.ratio.unwrap_or(config.seeding.matching.ratio);
        config.least = self.min_disparity.or(config.least);
        if let Some(count) = self.disparities {
            config.range = Some(DisparityRange::new(self.min_disparity.unwrap_or(0), count)?);
        }
        config.reference = self.reference.unwrap_or(config.reference);
        config.equalise &= !self.no_equalise;
        config.align &= !self.no_align;
        config.force = self.force;
        config.validate()?;
        Ok(config)
    }

    /// How many interest points and matches a figure shows, the strongest ones; `None`: all. The paper shows ten.
    ///
    /// # Errors
    /// [`Error::Parameter`] for none.
    pub fn strongest(&self) -> Result<Option<usize>> {
        if self.strongest == Some(0) {
            return Err(Error::Parameter {
                name: "strongest",
                value: "0".into(),
                expected: "it must be at least 1".into(),
            });
        }
        Ok(self.strongest.or((self.preset == Some(Preset::Paper)).then_some(10)))
    }

    /// The preset's parameters of dense matching, overridden by the options on the command line.
    fn dense_parameters(&self, preset: Preset) -> Result<DenseParameters> {
        let mut parameters = preset.dense_parameters();
        parameters.aggregation = self.aggregation(parameters.aggregation)?;
        parameters.interpolation = self.interpolation.unwrap_or(parameters.interpolation);
        parameters.uniqueness = self.uniqueness.unwrap_or(parameters.uniqueness);
        if let Some(pixels) = self.max_lr_difference {
            parameters.consistency = Some(fixed_point(pixels)?);
        } else if self.no_lr_check {
            parameters.consistency = None;
        }
        let blocks = matches!(parameters.aggregation, Aggregation::Sad { .. });
        if self.search_both_views && blocks && parameters.consistency.is_none() {
            return Err(self.misfit("it makes no left-right check, unless --max-lr-difference is given"));
        }
        parameters.agreement = self.agreement.unwrap_or(parameters.agreement);
        if self.fill {
            let of_balanced = Preset::Balanced.dense_parameters().refinement;
            // Neighbours that agree have a majority, or are thin.
            let majority = parameters.agreement <= 1;
            let agreeing = of_balanced.map(|refinement| Refinement { majority, ..refinement });
            parameters.refinement = parameters.refinement.or(agreeing);
        }
        if let (true, Some(refinement)) = (self.no_fill, &mut parameters.refinement) {
            refinement.fill = false;
        }
        Ok(parameters)
    }

    /// The preset's aggregation, overridden by the options on the command line.
    fn aggregation(&self, of_preset: Aggregation) -> Result<Aggregation> {
        let Self { window, paths, cost_window, compare, whole_range, search_both_views, .. } = *self;
        match of_preset {
            Aggregation::Sad { side, search, compared } => {
                if paths.is_some() || cost_window.is_some() {
                    return Err(self.misfit("--paths and --cost-window need balanced or quality"));
                }
                let search = if whole_range { Search::Whole } else { search };
                Ok(Aggregation::Sad { side: window.unwrap_or(side), search, compared: compare.unwrap_or(compared) })
            }
            Aggregation::Costs(_) if window.is_some() => Ok(Aggregation::Sad {
                side: window.unwrap_or_default(),
                search: Search::Whole,
                compared: compare.unwrap_or(Compared::SoftRank),
            }),
            Aggregation::Costs(_) if compare.is_some() => {
                Err(self.misfit("--compare needs blocks: --window, or the preset fast or paper"))
            }
            Aggregation::Costs(mut costs) => {
                costs.window = cost_window.unwrap_or(costs.window);
                if let Some(PathCount(paths)) = paths {
                    let paths = |semi_global| paths.map(|paths| SemiGlobal { paths, ..semi_global });
                    costs.semi_global = costs.semi_global.and_then(paths);
                }
                if whole_range {
                    costs.search = Search::Whole;
                }
                if search_both_views {
                    costs.cross_check = CrossCheck::Searched;
                }
                Ok(Aggregation::Costs(costs))
            }
        }
    }

    /// The error of an option that the preset ignores.
    fn misfit(&self, expected: &str) -> Error {
        let preset = self.preset.unwrap_or_default();
        Error::Parameter { name: "preset", value: preset.to_string(), expected: expected.into() }
    }

    /// Refuses the options that Kamencay's method ignores.
    fn refuse_what_only_hsad_does(&self) -> Result<()> {
        let given = [
            ("--preset", self.preset.is_some()),
            ("--window", self.window.is_some()),
            ("--compare", self.compare.is_some()),
            ("--whole-range", self.whole_range),
            ("--search-both-views", self.search_both_views),
            ("--paths", self.paths.is_some()),
            ("--cost-window", self.cost_window.is_some()),
            ("--uniqueness", self.uniqueness.is_some()),
            ("--max-lr-difference", self.max_lr_difference.is_some()),
            ("--no-lr-check", self.no_lr_check),
            ("--agreement", self.agreement.is_some()),
            ("--fill", self.fill),
            ("--no-fill", self.no_fill),
            ("--interpolation", self.interpolation.is_some()),
        ];
        match given.into_iter().find(|&(_, is_given)| is_given) {
            None => Ok(()),
            Some((name, _)) => Err(Error::Parameter {
                name: "--method",
                value: "kamencay".into(),
                expected: format!("{name} needs --method hsad: leave one of the two out"),
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

/// Pixels that were not seen, besides transparent ones (alpha 0) and floats that are NaN or infinite.
#[derive(Args)]
#[command(next_help_heading = "Unseen pixels")]
pub struct UnseenOptions {
    /// Masks of the left and the right view: pictures of the views' size, 0 for pixels that were not seen and get no
    /// disparity. One mask is for the left view only; name the same file twice for a mask that both views share, such as
    /// the round field of view of an endoscope
    #[arg(long, num_args = 1..=2, value_names = ["LEFT", "RIGHT"])]
    mask: Vec<PathBuf>,
    /// Value for missing data: a pixel that has it in all channels was not seen. In the unit of the files, before any
    /// stretch to 8 bits; NaN and infinity are always missing. JPEG does not keep such values: use a mask there
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    nodata: Option<f32>,
}

impl UnseenOptions {
    /// The masks and the value for missing data of a pair.
    pub fn unseen(&self) -> Unseen {
        Unseen { masks: [0, 1].map(|view| self.mask.get(view).cloned()), nodata: self.nodata }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum MethodName {
    /// Block matching or semi-global matching, depending on the preset
    Hsad,
    /// Mean-shift segmentation and belief propagation, after Kamencay et al., for comparison
    Kamencay,
}

/// A parser of the values of an enum by their names, with a line of help for each.
fn choices<T>(helps: &[(&'static str, &'static str)]) -> impl TypedValueParser<Value = T> + use<T>
where
    T: FromStr<Err: Debug> + Clone + Send + Sync + 'static,
{
    let values = helps.iter().map(|&(name, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(values.collect::<Vec<_>>()).map(|name| name.parse().expect("one of the names above"))
}

fn presets() -> impl TypedValueParser<Value = Preset> {
    choices(&[
        (
            Preset::Fast.name(),
            "Block matching, coarse to fine, with holes where a match is not unique or its neighbours do not agree",
        ),
        (Preset::Balanced.name(), "Semi-global matching along 3 paths, with holes filled"),
        (Preset::Quality.name(), "Semi-global matching along 4 paths, with holes filled and further refinement"),
        (Preset::Paper.name(), "The paper's method: block matching without checks"),
    ])
}

fn interpolations() -> impl TypedValueParser<Value = Interpolation> {
    choices(&[
        (Interpolation::None.name(), "Whole pixels, no interpolation"),
        (Interpolation::Parabola.name(), "Vertex of a parabola through three costs"),
        (Interpolation::Equiangular.name(), "Intersection of two lines of opposite slope through three costs"),
    ])
}

fn compared() -> impl TypedValueParser<Value = Compared> {
    choices(&[
        (Compared::Luma.name(), "Luma, after equalisation"),
        (Compared::SoftRank.name(), "How much brighter than a pixel its neighbours are, within limits"),
    ])
}

fn views() -> impl TypedValueParser<Value = View> {
    PossibleValuesParser::new(View::ALL.map(View::name)).map(|name| name.parse().expect("one of the names above"))
}

/// The number of paths; 0 is none.
#[derive(Clone, Copy)]
struct PathCount(Option<Paths>);

fn paths() -> impl TypedValueParser<Value = PathCount> {
    let value = |name, help| PossibleValue::new(name).help(help);
    PossibleValuesParser::new([
        value("0", "No paths"),
        value(Paths::Three.name(), "Along rows in both directions, along columns downwards"),
        value(Paths::Four.name(), "Along rows and columns in both directions"),
        value(Paths::Eight.name(), "Along rows, columns and diagonals in both directions"),
    ])
    .map(|name| PathCount(name.parse().ok()))
}
