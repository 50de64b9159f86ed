//! Parameters of Kamencay's method.

use super::{Conclusion, LinkWeights, ModeSeeking, Segmentation, Smoothness, WindowCost};
use crate::{
    dense::{Brightness, DenseConfig, Difference, View},
    disparity::DisparityRange,
    error::{Error, Result, check_range},
};

/// Most disparities: drivers take minutes to compile the kernel for more.
const MAX_DISPARITIES: u32 = 512;

/// Parameters of the method that do not depend on the pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KamencayParameters {
    /// Mean-shift filtering of the reference view.
    pub mean_shift: ModeSeeking,
    /// Segmentation of the filtered view.
    pub segmentation: Segmentation,
    /// The data cost of a pixel and its partner.
    pub cost: WindowCost,
    /// The smoothness cost of neighbours with different disparities.
    pub smoothness: Smoothness,
    /// The weights of links between neighbours, which scale the smoothness cost by the picture.
    pub links: LinkWeights,
    /// Number of grids, 1 to 6, each of half the size of the previous one; 5 by default.
    pub levels: u32,
    /// Number of turns per grid, 2 to 100; 6 by default. In each turn one half of the nodes sends messages.
    pub turns: u32,
    /// The disparities of segments from beliefs.
    pub conclusion: Conclusion,
}

impl Default for KamencayParameters {
    /// The values of least total error on Art, Cones and Teddy (Middlebury).
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

/// Parameters of Kamencay's method for a pair.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KamencayConfig {
    /// The disparities to search, in whole pixels, at most 512 after clipping to the width.
    pub range: DisparityRange,
    /// The reference view, which is segmented and whose pixels get a disparity; left by default.
    pub reference: View,
    /// The change of the right view's brightness, per channel, before pixels are compared; none by default.
    pub brightness: Brightness,
    /// The parameters that do not depend on the pair.
    pub parameters: KamencayParameters,
}

impl KamencayConfig {
    /// The left view as the reference, no change of brightness, and the default parameters.
    pub fn new(range: DisparityRange) -> Self {
        Self { range, reference: View::Left, brightness: Brightness::SAME, parameters: KamencayParameters::default() }
    }

    /// The searched disparities in a picture `width` pixels wide: see [`DenseConfig::searched`].
    ///
    /// # Errors
    /// [`Error::Parameter`] if no disparity gives any pixel a partner, or if there are more than 512.
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

    /// Checks that all values lie in their ranges.
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
    /// Checks the parameters: see [`KamencayConfig::validate`].
    pub(crate) fn validate(&self) -> Result<()> {
        let Self { mean_shift, segmentation, cost, smoothness, links, levels, turns, conclusion } = self;
        // Of the largest window 65 turns are what loops on every device may take: `MOST_TURNS`.
        for (name, value, first, last) in [
            ("the radius of mean shift", mean_shift.radius, 1, 15),
            ("the range of mean shift", mean_shift.range, 1, 255),
            ("the turns of mean shift", mean_shift.turns, 1, 65),
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
