//! Options for the point cloud, and what became of them.

use clap::Args;
use hsad::{
    Error, Result,
    io::{
        Calibration,
        ply::{LeftOut, PointFilter},
    },
    report::Cloud,
};

/// Which pixels of a map become points of the cloud.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Point cloud")]
pub struct CloudOptions {
    /// Largest depth of a point of the cloud, in metres, above 0, or inf [default: the depth of which half a pixel of disparity is a
    /// tenth, 0.2 times focal length times baseline]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    max_depth: Option<f64>,
    /// Least confidence of a point of the cloud, 0 to 255 [default: 16, that of any measured pixel]
    #[arg(long, value_name = "N", conflicts_with = "filled")]
    min_confidence: Option<u8>,
    /// Keep filled pixels in the cloud
    #[arg(long)]
    pub filled: bool,
    /// Also write the surfaces (mesh.ply): triangles between neighbouring points of the cloud whose disparities differ by at most 1 px and
    /// whose depths by at most a quarter, with normals
    #[arg(long)]
    pub mesh: bool,
}

impl CloudOptions {
    /// The filter for a pair of this calibration.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a largest depth that is not above 0.
    pub fn filter(&self, calibration: &Calibration) -> Result<PointFilter> {
        let mut filter = PointFilter::new(calibration);
        filter.max_depth = self.max_depth.unwrap_or(filter.max_depth);
        filter.min_confidence = self.min_confidence.unwrap_or(if self.filled { 1 } else { filter.min_confidence });
        filter.validate()?;
        Ok(filter)
    }

    /// Checks the options before any work; `is_calibrated`: whether there will be a cloud.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options without any effect, and as [`Self::filter`].
    pub fn check(&self, is_calibrated: bool) -> Result<()> {
        if let Some(max_depth) = self.max_depth {
            PointFilter { max_depth, min_confidence: 0 }.validate()?;
        }
        let given = [
            ("--max-depth", self.max_depth.map(|metres| metres.to_string())),
            ("--min-confidence", self.min_confidence.map(|confidence| confidence.to_string())),
            ("--filled", self.filled.then(|| "given".into())),
            ("--mesh", self.mesh.then(|| "given".into())),
        ];
        match given.into_iter().find_map(|(name, value)| Some((name, value?))) {
            Some((name, value)) if !is_calibrated => Err(Error::Parameter {
                name,
                value,
                expected: "without a calibration there is no point cloud: name one with --calib, or give --focal and --baseline".into(),
            }),
            _ => Ok(()),
        }
    }
}

/// A cloud that was written.
pub struct WrittenCloud(pub Cloud);

impl WrittenCloud {
    /// Number of points, and how many were left out and why.
    pub fn summary(&self) -> String {
        let LeftOut { unsure, beyond } = self.0.left_out;
        let mut text = format!("{} points", self.0.points);
        if unsure > 0 {
            text += &format!("; {unsure} of a confidence below {} left out", self.0.filter.min_confidence);
        }
        if beyond > 0 {
            text += &format!("; {beyond} beyond {} left out", self.metres());
        }
        text
    }

    /// A warning if the largest depth takes away most of the points, or the least confidence all of them.
    pub fn warning(&self) -> Option<String> {
        let LeftOut { unsure, beyond } = self.0.left_out;
        if self.0.points == 0 && unsure > beyond {
            let least = self.0.filter.min_confidence;
            return Some(format!(
                "no point has a confidence of {least} or more, so that cloud.ply is empty: --min-confidence"
            ));
        }
        (beyond > self.0.points).then(|| {
            format!(
                "{beyond} of {} points lie beyond {} and are not in cloud.ply: --max-depth keeps them",
                beyond + self.0.points,
                self.metres()
            )
        })
    }

    /// The largest depth, in three digits or more.
    fn metres(&self) -> String {
        let depth = self.0.filter.max_depth;
        let decimals = (2.0 - depth.log10().floor()).clamp(0.0, 9.0) as usize;
        format!("{depth:.decimals$} m")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(max_depth: f64, points: usize, unsure: usize, beyond: usize) -> WrittenCloud {
        WrittenCloud(Cloud {
            points,
            filter: PointFilter { max_depth, min_confidence: 16 },
            left_out: LeftOut { unsure, beyond },
        })
    }

    #[test]
    fn words_by_hand() {
        let cloud = written(77.92, 9, 3, 10);
        assert_eq!(cloud.summary(), "9 points; 3 of a confidence below 16 left out; 10 beyond 77.9 m left out");
        assert_eq!(
            cloud.warning().unwrap(),
            "10 of 19 points lie beyond 77.9 m and are not in cloud.ply: --max-depth keeps them"
        );
        assert_eq!(written(0.0123, 9, 0, 0).summary(), "9 points");
        assert!(written(2.0, 9, 0, 9).warning().is_none());
        assert_eq!(
            [0.012_34, 1.5, 123.4, 12_345.6].map(|depth| written(depth, 0, 0, 0).metres()),
            ["0.0123 m", "1.50 m", "123 m", "12346 m"]
        );
    }
}
