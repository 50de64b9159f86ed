//! What options mean: the configuration of the pipeline.

use super::{MethodName, Options, PathCount};
use crate::{
    config::{Config, Method, Preset},
    dense::{Aggregation, Compared, CrossCheck, DenseParameters, Pyramid, Refinement, Search, SemiGlobal},
    disparity::{DisparityRange, SCALE},
    error::{Error, Result},
    features::FeatureConfig,
    kamencay::KamencayParameters,
    tiles::Tiling,
};

/// Options that Kamencay's method ignores.
const ONLY_HSAD: [&str; 16] = [
    "preset",
    "window",
    "compare",
    "whole_range",
    "search_both_views",
    "paths",
    "cost_window",
    "uniqueness",
    "max_lr_difference",
    "no_lr_check",
    "agreement",
    "fill",
    "no_fill",
    "interpolation",
    "tiles",
    "tile_margin",
];

impl Options {
    /// The configuration of the preset, overridden by the options that are given.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value outside its range, and for options that exclude each other.
    pub fn config(&self) -> Result<Config> {
        self.check_exclusions()?;
        let preset = self.preset.unwrap_or_default();
        let mut config = preset.config();
        config.method = match self.method.unwrap_or_default() {
            MethodName::Hsad => Method::Hsad(self.dense_parameters(preset)?),
            MethodName::Kamencay => {
                self.refuse_what_only_hsad_does()?;
                Method::Kamencay(KamencayParameters::default())
            }
        };
        config.features = self.features_over(config.features)?;
        config.seeding.matching.ratio = self.ratio.unwrap_or(config.seeding.matching.ratio);
        config.least = self.min_disparity.or(config.least);
        if let Some(count) = self.disparities {
            config.range = Some(DisparityRange::new(self.min_disparity.unwrap_or(0), count)?);
        }
        config.reference = self.reference.unwrap_or(config.reference);
        if self.tile_margin.is_some() && self.tiles.is_none() {
            let (name, expected) = ("tile_margin", "it is that of tiles: give their side with `tiles`, too".into());
            return Err(Error::Parameter { name, value: "given".into(), expected });
        }
        let margin = self.tile_margin.unwrap_or(Tiling::MARGIN);
        config.tiles = self.tiles.map(|side| Tiling { side, margin });
        config.equalise &= !is_set(self.no_equalise);
        config.align &= !is_set(self.no_align);
        config.force = is_set(self.force);
        config.validate()?;
        Ok(config)
    }

    /// `config`, overridden by the options of interest points that are given.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options that exclude each other; ranges are checked by [`FeatureConfig::validate`].
    pub fn features_over(&self, config: FeatureConfig) -> Result<FeatureConfig> {
        self.check_exclusions()?;
        Ok(FeatureConfig {
            octaves: self.octaves.unwrap_or(config.octaves),
            step: self.step.unwrap_or(config.step),
            threshold: self.threshold.unwrap_or(config.threshold),
            upright: (config.upright || is_set(self.upright)) && !is_set(self.oriented),
            max_features: self.max_features.unwrap_or(config.max_features),
        })
    }

    /// A doubt about options that are given and change nothing for views of this width in pixels, in words with options between backticks.
    pub fn without_effect(&self, width: u32) -> Option<String> {
        let parameters = self.preset.unwrap_or_default().dense_parameters();
        let follows_paths = matches!(parameters.aggregation, Aggregation::Costs(_)) && self.window.is_none();
        (is_set(self.whole_range) && follows_paths && width < Pyramid::LEAST_WIDTH).then(|| {
            format!(
                "`whole_range` changes nothing: without it, too, pictures less than {} px wide are searched over the whole range",
                Pyramid::LEAST_WIDTH
            )
        })
    }

    fn check_exclusions(&self) -> Result<()> {
        let given = |name: &&&str| Self::described(name).is_ok_and(|option| option.is_given(self));
        for option in Self::ALL.iter().filter(|option| option.is_given(self)) {
            if let Some(other) = option.excludes.iter().find(given) {
                return Err(Error::Parameter {
                    name: option.name,
                    value: "given".into(),
                    expected: format!("`{other}` excludes it: leave one of the two out"),
                });
            }
        }
        Ok(())
    }

    /// The preset's parameters of dense matching, overridden by the options that are given.
    fn dense_parameters(&self, preset: Preset) -> Result<DenseParameters> {
        let mut parameters = preset.dense_parameters();
        parameters.aggregation = self.aggregation(parameters.aggregation)?;
        parameters.interpolation = self.interpolation.unwrap_or(parameters.interpolation);
        parameters.uniqueness = self.uniqueness.unwrap_or(parameters.uniqueness);
        if let Some(pixels) = self.max_lr_difference {
            parameters.consistency = Some(fixed_point(pixels)?);
        } else if is_set(self.no_lr_check) {
            parameters.consistency = None;
        }
        let blocks = matches!(parameters.aggregation, Aggregation::Sad { .. });
        if is_set(self.search_both_views) && blocks && parameters.consistency.is_none() {
            return Err(Error::Parameter {
                name: "search_both_views",
                value: "given".into(),
                expected: "these options make no left-right check: add `max_lr_difference`, or leave it out".into(),
            });
        }
        parameters.agreement = self.agreement.unwrap_or(parameters.agreement);
        if is_set(self.fill) {
            let of_balanced = Preset::Balanced.dense_parameters().refinement;
            // Neighbours that agree have a majority, or are thin.
            let majority = parameters.agreement <= 1;
            let agreeing = of_balanced.map(|refinement| Refinement { majority, ..refinement });
            parameters.refinement = parameters.refinement.or(agreeing);
        }
        if let (true, Some(refinement)) = (is_set(self.no_fill), &mut parameters.refinement) {
            refinement.fill = false;
        }
        if is_set(self.whole_range) {
            if !parameters.may_search_less() {
                return Err(Error::Parameter {
                    name: "whole_range",
                    value: "given".into(),
                    expected: "these options search the whole range as it is: leave it out".into(),
                });
            }
            match &mut parameters.aggregation {
                Aggregation::Sad { search, .. } => *search = Search::Whole,
                Aggregation::Costs(costs) => costs.search = Search::Whole,
            }
        }
        Ok(parameters)
    }

    /// The preset's aggregation, overridden by the options that are given.
    fn aggregation(&self, of_preset: Aggregation) -> Result<Aggregation> {
        let Self { window, paths, cost_window, compare, search_both_views, .. } = *self;
        match of_preset {
            Aggregation::Sad { side, search, compared } => {
                if paths.is_some() || cost_window.is_some() {
                    return Err(self.misfit("`paths` and `cost_window` need balanced or quality"));
                }
                Ok(Aggregation::Sad { side: window.unwrap_or(side), search, compared: compare.unwrap_or(compared) })
            }
            Aggregation::Costs(_) if window.is_some() => Ok(Aggregation::Sad {
                side: window.unwrap_or_default(),
                search: Search::Whole,
                compared: compare.unwrap_or(Compared::SoftRank),
            }),
            Aggregation::Costs(_) if compare.is_some() => {
                Err(self.misfit("`compare` needs blocks: `window`, or the preset fast or paper"))
            }
            Aggregation::Costs(mut costs) => {
                costs.window = cost_window.unwrap_or(costs.window);
                if let Some(PathCount(paths)) = paths {
                    let paths = |semi_global| paths.map(|paths| SemiGlobal { paths, ..semi_global });
                    costs.semi_global = costs.semi_global.and_then(paths);
                }
                if is_set(search_both_views) {
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
        for name in ONLY_HSAD {
            if Self::described(name)?.is_given(self) {
                return Err(Error::Parameter {
                    name: "method",
                    value: "kamencay".into(),
                    expected: format!("`{name}` needs `method` hsad: leave one of the two out"),
                });
            }
        }
        Ok(())
    }
}

/// Whether a flag was set.
fn is_set(flag: Option<bool>) -> bool {
    flag.unwrap_or(false)
}

fn fixed_point(pixels: f32) -> Result<u32> {
    if (0.0..=256.0).contains(&pixels) {
        return Ok((pixels * SCALE as f32).round() as u32);
    }
    Err(Error::Parameter {
        name: "max_lr_difference",
        value: pixels.to_string(),
        expected: "it must be 0 to 256 px".into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(given: &[(&str, &str)]) -> Options {
        let mut options = Options::default();
        given.iter().for_each(|(name, text)| options.set(name, text).unwrap());
        options
    }

    #[test]
    fn nothing_given_is_the_default_preset() {
        assert_eq!(Options::default().config().unwrap(), Config::default());
        for preset in Preset::ALL {
            let of_preset = options(&[("preset", preset.name()), ("fill", "false")]).config().unwrap();
            assert_eq!(of_preset, preset.config(), "{preset}");
        }
    }

    #[test]
    fn options_that_do_not_go_together_are_named() {
        for (given, expected) in [
            (&[("fill", "true"), ("no_fill", "true")][..], "no_fill is given, but `fill` excludes it"),
            (&[("oriented", "true"), ("upright", "true")], "oriented is given, but `upright` excludes it"),
            (&[("paths", "4"), ("window", "7")], "paths is given, but `window` excludes it"),
            (&[("paths", "4"), ("preset", "fast")], "preset is fast, but `paths` and `cost_window` need"),
            (&[("method", "kamencay"), ("fill", "true")], "method is kamencay, but `fill` needs `method` hsad"),
            (
                &[("preset", "fast"), ("search_both_views", "true")],
                "search_both_views is given, but these options make no",
            ),
            (&[("max_lr_difference", "300")], "max_lr_difference is 300, but"),
            (&[("tile_margin", "64")], "tile_margin is given, but it is that of tiles"),
            (&[("tiles", "200")], "tiles is 200, but a tile is at least 256 px"),
        ] {
            let error = options(given).config().unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    #[test]
    fn what_changes_nothing_is_told() {
        let whole = |preset| options(&[("whole_range", "true"), ("preset", preset)]);
        assert!(whole("balanced").without_effect(1599).unwrap().starts_with("`whole_range` changes nothing"));
        assert_eq!([whole("balanced").without_effect(1600), whole("fast").without_effect(99)], [None, None]);
        assert_eq!(Options::default().without_effect(99), None);
    }

    #[test]
    fn names_of_what_only_hsad_does_exist() {
        ONLY_HSAD.iter().for_each(|name| assert!(Options::described(name).is_ok(), "{name}"));
    }
}
