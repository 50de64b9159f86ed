//! What the hybrid method is asked to do.

use super::{Conclusion, LinkWeights, ModeSeeking, Segmentation, Smoothness, WindowCost};
use crate::{
    dense::{Brightness, DenseConfig, Difference, View},
    disparity::DisparityRange,
    error::{Error, Result, check_range},
};

/// More disparities make a kernel that drivers take minutes to compile.
const MAX_DISPARITIES: u32 = 512;

/// The parameters of the method, whatever the pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KamencayParameters {
    /// Mean-shift filtering of the reference view.
    pub mean_shift: ModeSeeking,
    /// Which filtered pixels make a segment.
    pub segmentation: Segmentation,
    /// How pixels of the two views are compared.
    pub cost: WindowCost,
    /// What it costs that neighbours have other disparities.
    pub smoothness: Smoothness,
    /// How that depends on the picture.
    pub links: LinkWeights,
    /// Grids, each of half the size of the last, 1 to 6.
    pub levels: u32,
    /// Turns on each of them, 2 to 100; in each one half of the nodes sends.
    pub turns: u32,
    /// From beliefs to the disparities of segments.
    pub conclusion: Conclusion,
}

impl Default for KamencayParameters {
    /// What gave the least error on Art, Cones and Teddy together.
    fn default() -> Self {
        Self {
            mean_shift: ModeSeeking { radius: 5, range: 10, turns: 10 },
            segmentation: Segmentation { join: 4, least: 10 },
            cost: WindowCost {
                radius: 1,
                color: Difference { weight: 12, limit: 20 },
                gradient: Difference { weight: 24, limit: 8 },
            },
            smoothness: Smoothness { slope: 14, limit: 100 },
            links: LinkWeights { halving: 8, least: 2, inside: 8, across: 4 },
            levels: 5,
            turns: 6,
            conclusion: Conclusion { confirmation: 0, least_confirmed: 4, tolerance: 4 },
        }
    }
}

/// The hybrid method on a pair.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KamencayConfig {
    /// The disparities to search.
    pub range: DisparityRange,
    /// The view whose pixels get a disparity, and which is segmented.
    pub reference: View,
    /// What makes the right view as bright as the left one, channel by channel, before pixels are compared.
    pub brightness: Brightness,
    /// All else.
    pub parameters: KamencayParameters,
}

impl KamencayConfig {
    /// The left view as the reference, its brightness taken as it is, and the default parameters.
    pub fn new(range: DisparityRange) -> Self {
        Self { range, reference: View::Left, brightness: Brightness::SAME, parameters: KamencayParameters::default() }
    }

    /// The disparities that are searched in a picture of this width: see [`DenseConfig::searched`].
    ///
    /// # Errors
    /// [`Error::Parameter`] where there are none, or more than a kernel is made for.
    pub fn searched(&self, width: u32) -> Result<DisparityRange> {
        let range = DenseConfig::new(self.range).searched(width)?;
        if range.count > MAX_DISPARITIES {
            return Err(Error::Parameter {
                name: "the number of disparities",
                value: range.count.to_string(),
                expected: format!(
                    "belief propagation takes at most {MAX_DISPARITIES}: name fewer or scale the pictures down"
                ),
            });
        }
        Ok(range)
    }

    /// Refuses what no kernel could work with.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        DisparityRange::new(self.range.min, self.range.count)?;
        self.brightness.validate()?;
        self.parameters.validate()
    }
}

impl KamencayParameters {
    /// As [`KamencayConfig::validate`].
    pub(crate) fn validate(&self) -> Result<()> {
        let Self { mean_shift, segmentation, cost, smoothness, links, levels, turns, conclusion } = self;
        for (name, value, first, last) in [
            ("the radius of mean shift", mean_shift.radius, 1, 15),
            ("the range of mean shift", mean_shift.range, 1, 255),
            ("the turns of mean shift", mean_shift.turns, 1, 100),
            ("the joining difference of segments", segmentation.join, 0, 441),
            ("the radius of the window", cost.radius, 0, 7),
            ("the weight of the colour", cost.color.weight, 0, 4096),
            ("the limit of the colour", cost.color.limit, 0, 255),
            ("the weight of the gradient", cost.gradient.weight, 0, 4096),
            ("the limit of the gradient", cost.gradient.limit, 0, 255),
            ("the limit of the smoothness", smoothness.limit, 1, 255),
            ("the slope of the smoothness", smoothness.slope, 1, smoothness.limit),
            ("the halving difference of links", links.halving, 1, 255),
            ("the least weight of links", links.least, 0, 16),
            ("the weight of links inside of segments", links.inside, 0, 16),
            ("the weight of links across segments", links.across, 0, 16),
            ("the number of grids", *levels, 1, 6),
            ("the number of turns", *turns, 2, 100),
            ("the share of confirmed pixels", conclusion.least_confirmed, 0, 16),
        ] {
            check_range(name, value, first..=last)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nonsense_is_named() {
        let range = DisparityRange::new(0, 64).unwrap();
        KamencayConfig::new(range).validate().unwrap();
        let refused = |change: &dyn Fn(&mut KamencayParameters)| {
            let mut config = KamencayConfig::new(range);
            change(&mut config.parameters);
            config.validate().unwrap_err().to_string()
        };
        assert!(
            refused(&|p| p.mean_shift.radius = 16).starts_with("the radius of mean shift is 16, but it must be 1 to")
        );
        assert!(refused(&|p| p.smoothness.limit = 256).starts_with("the limit of the smoothness is 256"));
        assert!(refused(&|p| p.smoothness = Smoothness { slope: 3, limit: 2 }).contains("it must be 1 to 2"));
        assert!(refused(&|p| p.levels = 0).contains("1 to 6"));
        let wide = KamencayConfig::new(DisparityRange::new(0, 600).unwrap());
        assert!(wide.searched(1000).unwrap_err().to_string().contains("at most 512"));
        assert_eq!(wide.searched(100).unwrap(), DisparityRange::new(0, 100).unwrap());
    }
}
