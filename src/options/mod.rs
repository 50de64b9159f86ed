//! The options of matching by their names: one description, from which the command line, the browser's bindings and Python's take
//! names, kinds of values, help and meaning.
//!
//! A new option is an entry of the table below and its meaning in `config.rs`; a new value of a choice, such as a preset, is a value
//! of its enum. Sentences write options between backticks, so that each surface can put its own spelling there.

mod config;
mod value;

pub use value::{Choice, Kind, MethodName, PathCount};

use value::Value;

use crate::{
    config::Preset,
    dense::{Compared, Interpolation, View},
    error::{Error, Result},
    features::FeatureConfig,
    matching::MatchConfig,
    tiles::Tiling,
};

/// What an option is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Dense matching.
    Matching,
    /// Interest points.
    Points,
}

impl Group {
    /// The heading of the group in a list of options.
    pub fn heading(self) -> &'static str {
        match self {
            Self::Matching => "Matching",
            Self::Points => "Interest points",
        }
    }
}

/// The description of an option.
#[derive(Debug)]
pub struct Described {
    /// The name, words joined by underscores.
    pub name: &'static str,
    /// The group of the option.
    pub group: Group,
    /// What the value counts: `PX`, `PERCENT`, `N`; empty for flags and choices.
    pub unit: &'static str,
    /// Names of options that exclude this option.
    pub excludes: &'static [&'static str],
    help: &'static str,
    default: Option<fn() -> String>,
    kind: fn() -> Kind,
    set: fn(&mut Options, &str) -> std::result::Result<(), String>,
    is_given: fn(&Options) -> bool,
}

impl Described {
    /// What the option does, its range and its default.
    pub fn help(&self) -> String {
        let help = self.help.trim();
        self.default.map_or_else(|| help.into(), |default| format!("{help} [default: {}]", default()))
    }

    /// The kind of values that the option takes.
    pub fn kind(&self) -> Kind {
        (self.kind)()
    }

    /// Whether the option was given.
    pub fn is_given(&self, options: &Options) -> bool {
        (self.is_given)(options)
    }

    /// Whether `text` is a value of the option; its range is checked by [`Options::config`].
    ///
    /// # Errors
    /// What the value must be.
    pub fn check(&self, text: &str) -> std::result::Result<(), String> {
        (self.set)(&mut Options::default(), text)
    }
}

/// The fields of [`Options`] and [`Options::ALL`]: name, type, unit, default that the library computes, options that it excludes.
macro_rules! options {
    ($($group:ident { $(
        $(#[doc = $help:literal])+
        $name:ident: $type:ty $(, unit $unit:literal)? $(, default $default:expr)? $(, without $($other:ident)+)?;
    )+ })+) => {
        /// Options of matching; what is not given is the preset's.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Options { $($(
            $(#[doc = $help])+
            pub $name: Option<$type>,
        )+)+ }

        impl Options {
            /// The descriptions of all options.
            pub const ALL: &[Described] = &[$($(Described {
                name: stringify!($name),
                group: Group::$group,
                unit: concat!($($unit)?),
                excludes: &[$($(stringify!($other)),+)?],
                help: concat!($($help),+),
                default: options!(@default $($default)?),
                kind: <$type as Value>::kind,
                set: |options, text| {
                    options.$name = Some(<$type as Value>::read(text)?);
                    Ok(())
                },
                is_given: |options| options.$name.as_ref().is_some_and(Value::is_on),
            }),+),+];
        }
    };
    (@default) => { None };
    (@default $default:expr) => { Some(|| $default.to_string()) };
}

options! {
    Matching {
        /// Dense matching method
        method: MethodName, default MethodName::default();
        /// Set of parameters; single options override it
        preset: Preset, default Preset::default();
        /// Match blocks: side of the square window in pixels, odd, 3 to 31 [default: fast 9, paper 7; balanced and
        /// quality match semi-globally]
        window: u32, unit "PX";
        /// Number of paths of semi-global matching; with 0 the cost window alone decides [default: balanced 3,
        /// quality 4]
        paths: PathCount, unit "N", without window;
        /// Side in pixels of the square window that averages the costs of each disparity before the paths, odd, 1 to
        /// 31 [default: 1]
        cost_window: u32, unit "PX", without window;
        /// What blocks compare [default: soft-rank, paper luma]
        compare: Compared;
        /// Compare at every disparity of the range [default of fast: coarse to fine, near the disparities of a map of half
        /// the size; of balanced and quality, in pictures at least 1600 px wide: over a pyramid, near the disparities of the
        /// level above]
        whole_range: bool;
        /// Smallest disparity in pixels, -1048576 to 1048576: with `disparities` the start of the range
        /// [default: 0], without it a lower limit of the range that is found [default: none, paper 0]
        min_disparity: i32, unit "PX";
        /// Number of disparities to search, at least 1 [default: found from a coarse map and matching interest points]
        disparities: u32, unit "N";
        /// Reference view, whose pixels get a disparity [default: left, paper right]
        reference: View;
        /// Uniqueness margin: per cent by which the best rival, two or more disparities away, must cost more than the best
        /// disparity, 0 to 100
        /// [default: 1, fast 16, paper 0]
        uniqueness: u32, unit "PERCENT";
        /// Left-right consistency check: largest difference of the two views' disparities in pixels, 0 to 256
        /// [default: 1, fast and paper no check]; fast allows 1 px more, since it checks at half the size
        max_lr_difference: f32, unit "PX", without no_lr_check;
        /// Skip the left-right consistency check
        no_lr_check: bool;
        /// Match the other view separately for the left-right consistency check, instead of deriving its
        /// disparities from those of the reference view: fewer errors beside occlusions, for nearly twice the time. Block
        /// matching does so for any check: over the whole range at the whole size, coarse to fine at half the size
        search_both_views: bool, without no_lr_check;
        /// Agreement check: of nine pixels, the pixel itself and the eight pixels 3 columns, rows, or both away, the number
        /// whose disparities must lie within 2 px of the pixel's, 0 to 9 [default: no check, fast 6]
        agreement: u32, unit "N";
        /// Fill holes, and refine the map as balanced does [default of balanced and quality]
        fill: bool;
        /// Leave holes where a check fails or too few neighbours agree [default of fast and paper]
        no_fill: bool, without fill;
        /// Match a large picture in tiles of this side in pixels, at least 256, so that memory is that of a tile [default: the whole
        /// picture]
        tiles: u32, unit "PX";
        /// Margin of tiles in pixels, 0 to 65536, besides the largest disparity: the more, the less the map differs from that of the
        /// whole picture
        tile_margin: u32, unit "PX", default Tiling::MARGIN;
        /// Do not equalise the brightness of the views, even where matched points show a difference
        no_equalise: bool;
        /// Do not align rows: match the right view as it is, even where matched points show that its rows are slightly off [default of paper]
        no_align: bool;
        /// Sub-pixel interpolation of disparities [default: equiangular, paper parabola]
        interpolation: Interpolation;
        /// Ratio test: largest ratio of the distances of the best and the second best descriptor, above 0, at most 1
        ratio: f32, unit "R", default MatchConfig::default().ratio;
        /// Match the pair even if it is not rectified and cannot be, and accept a map that is not to be trusted
        force: bool;
    }
    Points {
        /// Number of octaves of filter sizes, 1 to 5
        octaves: u32, unit "N", default FeatureConfig::default().octaves;
        /// Sampling step of the first octave in pixels, 1 or 2
        step: u32, unit "PX", default FeatureConfig::default().step;
        /// Smallest determinant of the Hessian of a point, for grey values of 0 to 1; above 0, at most 1
        threshold: f32, unit "T", default FeatureConfig::default().threshold;
        /// Compute orientations, for views rotated against each other
        oriented: bool, without upright;
        /// Skip orientations, the better choice for views without rotation [default, except paper]
        upright: bool;
        /// Most interest points per view, 1 to 1048576; of more the strongest are kept, spread over the picture
        max_features: u32, unit "N", default FeatureConfig::default().max_features;
    }
}

impl Options {
    /// The descriptions of a group.
    pub fn of(group: Group) -> impl Iterator<Item = &'static Described> {
        Self::ALL.iter().filter(move |option| option.group == group)
    }

    /// The description of an option.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the names of all options, if there is none of this name.
    pub fn described(name: &str) -> Result<&'static Described> {
        Self::ALL.iter().find(|option| option.name == name).ok_or_else(|| Error::Parameter {
            name: "the option",
            value: format!("'{name}'"),
            expected: format!(
                "there are only {}",
                Self::ALL.iter().map(|option| option.name).collect::<Vec<_>>().join(", ")
            ),
        })
    }

    /// Sets an option from the text of its value; a flag is `true` or `false`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown option, and for a text that is no value of the option.
    pub fn set(&mut self, name: &str, text: &str) -> Result<()> {
        let option = Self::described(name)?;
        (option.set)(self, text).map_err(|expected| Error::Parameter {
            name: option.name,
            value: format!("'{text}'"),
            expected,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_set_by_name() {
        let mut options = Options::default();
        for (name, text) in
            [("preset", "fast"), ("window", "11"), ("min_disparity", "-3"), ("ratio", "0.5"), ("paths", "0")]
        {
            options.set(name, text).unwrap();
        }
        let expected = Options {
            preset: Some(Preset::Fast),
            window: Some(11),
            min_disparity: Some(-3),
            ratio: Some(0.5),
            paths: Some(PathCount(None)),
            ..Options::default()
        };
        assert_eq!(options, expected);
    }

    #[test]
    fn what_is_no_option_or_no_value_is_named() {
        for (name, text, expected) in [
            ("windows", "7", "the option is 'windows', but there are only method, preset, window,"),
            ("window", "wide", "window is 'wide', but it must be a whole number"),
            ("window", "-1", "window is '-1', but it must be a whole number"),
            ("ratio", "half", "ratio is 'half', but it must be a number"),
            ("fill", "yes", "fill is 'yes', but it must be true or false"),
            ("preset", "best", "preset is 'best', but it must be one of fast, balanced, quality, paper"),
            ("paths", "5", "paths is '5', but it must be one of 0, 3, 4, 8"),
        ] {
            let error = Options::default().set(name, text).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    /// What the table says of other options is true.
    #[test]
    fn the_table_names_options_that_exist() {
        for option in Options::ALL {
            for other in option.excludes.iter().copied().chain(option.help.split('`').skip(1).step_by(2)) {
                assert!(Options::described(other).is_ok(), "{}: {other}", option.name);
            }
            assert_eq!(Options::ALL.iter().filter(|other| other.name == option.name).count(), 1);
        }
    }
}
