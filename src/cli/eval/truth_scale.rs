//! The unit of a truth: the option `--truth-scale`, and what is told where the option is missing.

use clap::Args;
use hsad::{Error, eval::OtherUnit, image::Plane};

/// The unit of the ground truth of stereo scenes.
#[derive(Args, Clone, Copy, Debug)]
pub struct TruthOptions {
    /// Multiply the disparities of the ground truth by FACTOR, a number or a fraction: -1 where they have the other sign, 1/16 where they
    /// are 16 times the pixels. Without it a truth that does not agree with hsad's map, but would in another unit, is refused
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = parse)]
    pub truth_scale: Option<f32>,
}

impl TruthOptions {
    /// Refuses a truth of another unit than `map`, both in pixels, unless the option tells the unit.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the scale that mends it.
    pub fn check(self, truth: &Plane<f32>, map: &Plane<f32>) -> hsad::Result<()> {
        let Some(other) = OtherUnit::of(truth, map).filter(|_| self.truth_scale.is_none()) else { return Ok(()) };
        let (scale, share) = (text(other.scale), 100.0 * other.agrees);
        Err(Error::Parameter {
            name: "the truth",
            value: "in another unit or of another sign than the map".into(),
            expected: format!(
                "times {scale} it agrees at {share:.0} % of the pixels: give `truth_scale` {scale}, or 1 for the truth as it is"
            ),
        })
    }
}

/// A warning about a map of another program that is in another unit than the truth.
pub fn warning(truth: &Plane<f32>, map: &Plane<f32>) -> Option<String> {
    let other = OtherUnit::of(map, truth)?;
    let (scale, share) = (text(other.scale), 100.0 * other.agrees);
    Some(format!(
        "this map is in another unit or of another sign than the truth: times {scale} it agrees at {share:.0} % of the pixels"
    ))
}

fn parse(text: &str) -> Result<f32, String> {
    let number = |text: &str| text.trim().parse::<f32>().ok();
    let scale = match text.split_once('/') {
        Some((above, below)) => number(above).zip(number(below)).map(|(above, below)| above / below),
        None => number(text),
    };
    scale
        .filter(|scale| scale.is_finite() && *scale != 0.0)
        .ok_or_else(|| "it must be a number other than 0 or a fraction, such as -1 or 1/16".into())
}

/// A whole number or the fraction of 1 by one.
fn text(scale: f32) -> String {
    if scale.abs() >= 1.0 {
        scale.to_string()
    } else {
        format!("{}1/{}", if scale < 0.0 { "-" } else { "" }, 1.0 / scale.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_read_as_they_are_written() {
        for (scale, written) in [(-1.0, "-1"), (256.0, "256"), (0.0625, "1/16"), (-0.5, "-1/2"), (1.0 / 3.0, "1/3")] {
            assert_eq!((text(scale), parse(written)), (written.into(), Ok(scale)));
        }
        assert_eq!(parse("0.25"), Ok(0.25));
        for wrong in ["0", "", "1/0", "0/4", "x", "inf", "1/2/3"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
