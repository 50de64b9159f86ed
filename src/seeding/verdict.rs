//! The verdict on the rows of a pair, and its words.

use std::fmt;

use super::Rectification;
use crate::names::names;

/// Largest row error from a distortion of the lens that is not worth a word, in pixels.
const DISTORTED: f32 = 0.5;

/// How the rows of a pair correspond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Corresponding points lie in the same row.
    Rectified,
    /// Corresponding points lie in the same row once the right view is resampled by its rows alone,
    /// [`Rectification::rows`]: cameras side by side that are not quite aligned.
    Alignable,
    /// Corresponding points lie in different rows, by more than a small warp of one view removes: a search along rows would
    /// find nothing but noise.
    NotRectified,
    /// The right view is turned by 180 degrees, to within 5 degrees.
    UpsideDown,
    /// The cameras stand above each other: points differ in rows by their depth, and correspond in columns.
    Vertical,
    /// Too few seeds agree with each other.
    Unknown,
}

names!(Verdict, "the verdict", {
    Rectified => "rectified",
    Alignable => "alignable",
    NotRectified => "not rectified",
    UpsideDown => "upside down",
    Vertical => "vertical",
    Unknown => "unknown",
});

impl fmt::Display for Rectification {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { remaining, largest, unexplained, agreeing, seeds, .. } = *self;
        match self.verdict {
            Verdict::Rectified => {
                write!(f, "rows correspond as they are, 95 % to within {remaining:.1} px")?;
            }
            Verdict::Alignable => {
                write!(
                    f,
                    "rows correspond after a small warp of the right view, 95 % to within {remaining:.1} px: it "
                )?;
                self.placement(f)?;
                write!(f, ", so that rows differ by up to {largest:.1} px")?;
            }
            Verdict::NotRectified if self.climb != 0.0 => {
                write!(
                    f,
                    "the cameras do not stand side by side in the pictures, rows differ by {:.2} px per pixel of disparity",
                    self.climb.abs()
                )?;
            }
            Verdict::NotRectified if self.most_agree() => {
                f.write_str("the right view ")?;
                self.placement(f)?;
                write!(f, ", so that rows differ by up to {largest:.1} px")?;
            }
            Verdict::NotRectified => f.write_str("rows correspond in no common way")?,
            Verdict::UpsideDown => f.write_str("the right view is upside down: turn the right view by 180 degrees")?,
            Verdict::Vertical => {
                f.write_str("the cameras stand above each other: turn both views by 90 degrees")?;
            }
            Verdict::Unknown => {
                let few = "points agree on how rows correspond, too few to tell";
                return write!(f, "unknown: {agreeing} of {seeds} {few}");
            }
        }
        if self.is_distorted() {
            write!(f, "; a distorted lens moves rows by up to {unexplained:.1} px more")?;
        }
        write!(f, " ({agreeing} of {seeds} points agree)")
    }
}

impl Rectification {
    /// Whether a distortion of the lens leaves rows that differ by more than half a pixel in parts of the picture; a result
    /// is better once the distortion is removed from both views.
    pub fn is_distorted(&self) -> bool {
        self.unexplained > DISTORTED
    }

    /// Writes how the right view lies, without the parts that would be written as 0.
    fn placement(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { offset, rotation, scale, .. } = *self;
        let percent = 100.0 * (scale - 1.0);
        let side = |value: f32, positive, negative| if value >= 0.0 { positive } else { negative };
        let parts = [
            (offset.abs() >= 0.05).then(|| format!("lies {:.1} px {}", offset.abs(), side(offset, "lower", "higher"))),
            (rotation.abs() >= 0.005).then(|| {
                let sense = side(rotation, "clockwise", "anticlockwise");
                format!("is turned {:.2} degrees {sense}", rotation.abs())
            }),
            (percent.abs() >= 0.05)
                .then(|| format!("is {:.1} % {}", percent.abs(), side(percent, "larger", "smaller"))),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        match parts.split_last() {
            Some((last, [])) => f.write_str(last),
            Some((last, before)) => write!(f, "{} and {last}", before.join(", ")),
            None => f.write_str("differs in perspective"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_verdict_is_one_line_that_names_the_way_out() {
        let found = Rectification {
            offset: -1.25,
            rotation: 0.004,
            scale: 1.02,
            remaining: 0.75,
            largest: 6.0,
            agreeing: 30,
            seeds: 40,
            ..Rectification::new(&[], (64, 48))
        };
        let text = |verdict, agreeing| Rectification { verdict, agreeing, ..found }.to_string();
        for (verdict, agreeing, expected) in [
            (Verdict::Rectified, 30, "rows correspond as they are, 95 % to within 0.8 px (30 of 40 points agree)"),
            (
                Verdict::Alignable,
                30,
                "rows correspond after a small warp of the right view, 95 % to within 0.8 px: it lies 1.2 px higher and is \
                 2.0 % larger, so that rows differ by up to 6.0 px (30 of 40 points agree)",
            ),
            (
                Verdict::NotRectified,
                30,
                "the right view lies 1.2 px higher and is 2.0 % larger, so that rows differ by up to 6.0 px (30 of 40 points agree)",
            ),
            (Verdict::NotRectified, 16, "rows correspond in no common way (16 of 40 points agree)"),
            (Verdict::Unknown, 3, "unknown: 3 of 40 points agree on how rows correspond, too few to tell"),
        ] {
            assert_eq!(text(verdict, agreeing), expected);
        }
    }

    #[test]
    fn a_distorted_lens_is_told_from_half_a_pixel_up() {
        let told = |unexplained| {
            let verdict = Verdict::Rectified;
            let found = Rectification { verdict, unexplained, ..Rectification::new(&[], (64, 48)) };
            (found.is_distorted(), found.to_string().contains("a distorted lens moves rows by up to 0.8 px more"))
        };
        assert_eq!(told(0.5), (false, false));
        assert_eq!(told(0.8), (true, true));
    }
}
