//! Options that several subcommands share, and their translation to a configuration.

use std::{fmt::Display, path::PathBuf};

use anyhow::anyhow;
use clap::{
    Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches,
    builder::{PossibleValue, PossibleValuesParser},
    error::ErrorKind,
};
use hsad::{
    Backend, Error, Options, Result,
    config::{Config, Preset},
    features::FeatureConfig,
    gpu::DeviceChoice,
    io::load::Unseen,
    options::{Choice, Described, Group, Kind},
    verify::self_test,
};

use super::{
    cache::CachedBackend,
    terminal::{self, Progress},
    wording::in_words_of_options,
};

/// Device and verbosity of a subcommand.
#[derive(Args)]
pub struct RunOptions {
    /// Device to compute on: best, cpu, or the index, a part of the name or the place of a device (see hsad devices)
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

/// Options of the interest point detector.
pub struct FeatureOptions(Options);

impl FeatureOptions {
    /// `config`, overridden by the options on the command line.
    ///
    /// # Errors
    /// See [`Options::features_over`].
    pub fn over(&self, config: FeatureConfig) -> Result<FeatureConfig> {
        self.0.features_over(config)
    }
}

/// Help text of an option whose default value comes from the library.
pub fn with_default(help: &str, value: impl Display) -> String {
    format!("{help} [default: {value}]")
}

/// Options of matching, with those of the interest point detector.
#[derive(Clone, Debug)]
pub struct MatchOptions(Options);

impl MatchOptions {
    /// The preset, overridden by the options on the command line.
    ///
    /// # Errors
    /// See [`Options::config`].
    pub fn config(&self) -> Result<Config> {
        self.0.config()
    }

    /// A doubt about options that change nothing for views of this width in pixels.
    pub fn without_effect(&self, width: u32) -> Option<String> {
        self.0.without_effect(width).map(|doubt| in_words_of_options(&doubt))
    }

    /// The first option that is given and not among `others`, as on the command line.
    pub fn any_but(&self, others: &[&str]) -> Option<String> {
        let given = Options::ALL.iter().find(|option| option.is_given(&self.0) && !others.contains(&option.name));
        given.map(|option| option.name.replace('_', "-"))
    }
}

/// What figures show.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Figures")]
pub struct FigureOptions {
    /// Draw only the N strongest interest points and matches in the figures, at least 1 [default: all,
    /// paper 10]
    #[arg(long, value_name = "N", requires = "figures")]
    strongest: Option<usize>,
}

impl FigureOptions {
    /// How many interest points and matches a figure shows, the strongest ones; `None`: all. The paper shows ten.
    ///
    /// # Errors
    /// [`Error::Parameter`] for none.
    pub fn strongest(&self, MatchOptions(options): &MatchOptions) -> Result<Option<usize>> {
        if self.strongest == Some(0) {
            return Err(Error::Parameter {
                name: "strongest",
                value: "0".into(),
                expected: "it must be at least 1".into(),
            });
        }
        Ok(self.strongest.or((options.preset == Some(Preset::Paper)).then_some(10)))
    }
}

/// What clap makes of arguments.
type Parsed<T> = std::result::Result<T, clap::Error>;

/// The arguments of options that the library describes.
macro_rules! described {
    ($type:ident, $($group:ident),+) => {
        impl Args for $type {
            fn augment_args(command: Command) -> Command {
                [$(Group::$group),+].into_iter().fold(command, |command, group| {
                    command.next_help_heading(group.heading()).args(Options::of(group).map(argument))
                })
            }

            fn augment_args_for_update(command: Command) -> Command {
                Self::augment_args(command)
            }
        }

        impl FromArgMatches for $type {
            fn from_arg_matches(matches: &ArgMatches) -> Parsed<Self> {
                given(matches, &[$(Group::$group),+]).map(Self)
            }

            fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Parsed<()> {
                *self = Self::from_arg_matches(matches)?;
                Ok(())
            }
        }
    };
}

described!(MatchOptions, Matching, Points);
described!(FeatureOptions, Points);

/// The argument of an option.
fn argument(option: &'static Described) -> Arg {
    let argument = Arg::new(option.name)
        .long(option.name.replace('_', "-"))
        .help(in_words_of_options(&option.help()))
        .conflicts_with_all(option.excludes);
    let unit = if option.unit.is_empty() { option.name.replace('_', "-").to_uppercase() } else { option.unit.into() };
    match option.kind() {
        Kind::Flag => argument.action(ArgAction::SetTrue),
        Kind::Whole | Kind::Number => argument
            .value_name(unit)
            .allow_negative_numbers(true)
            .value_parser(|text: &str| option.check(text).map(|()| text.to_owned())),
        Kind::Choice(choices) => argument.value_name(unit).value_parser(PossibleValuesParser::new(
            choices.into_iter().map(|Choice { name, help }| match help {
                "" => PossibleValue::new(name),
                _ => PossibleValue::new(name).help(help),
            }),
        )),
    }
}

/// The options on the command line.
fn given(matches: &ArgMatches, groups: &[Group]) -> Parsed<Options> {
    let mut options = Options::default();
    for option in groups.iter().flat_map(|&group| Options::of(group)) {
        let is_flag = option.kind() == Kind::Flag;
        let text = match is_flag {
            true => matches.get_flag(option.name).then_some("true"),
            false => matches.get_one::<String>(option.name).map(String::as_str),
        };
        if let Some(text) = text {
            options.set(option.name, text).map_err(|error| clap::Error::raw(ErrorKind::InvalidValue, error))?;
        }
    }
    Ok(options)
}

/// Pixels that were not seen, besides transparent ones (alpha 0) and floats that are NaN or infinite.
#[derive(Args, Clone, Debug)]
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
    /// The files of the masks.
    pub fn files_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        self.mask.iter_mut()
    }

    /// The masks and the value for missing data of a pair.
    pub fn unseen(&self) -> Unseen {
        Unseen { masks: [0, 1].map(|view| self.mask.get(view).cloned()), nodata: self.nodata }
    }
}
