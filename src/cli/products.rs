//! The output files of a matched pair: maps, depth, point cloud, figures and report.

use std::io::Write;

use hsad::{
    Result,
    dense::View,
    disparity::{DisparityMap, NONE, fixed_point},
    features::Feature,
    image::Plane,
    io::{
        Calibration, Picture,
        calibration::depth_map,
        color, depth_png,
        disparity_png::{self, Encoding},
        figure,
        mesh::{self, Mesh},
        pfm,
        ply::{self, LeftOut, PointFilter},
        png,
    },
    report::{Cloud, ResultFile},
};
use serde_json::Value;

use super::{
    cloud::{CloudOptions, WrittenCloud},
    doubts::NoDepth,
    job::{CompletedJob, Job},
    matches::MatchTable,
    names::{FIGURES, MATCHES, MESH, REPORT},
    output::Output,
};

/// Names of the files of [`CompletedJob::add_maps`], with depth or without, and of the report.
pub fn maps(with_depth: bool) -> impl Iterator<Item = &'static str> {
    ResultFile::ALL.into_iter().filter(move |file| with_depth || !file.needs_depth()).map(ResultFile::name)
}

impl CompletedJob {
    /// Adds the disparity and confidence maps; with a calibration also depth and the point cloud that `cloud` asks for.
    pub fn add_maps(&mut self, output: &mut Output, cloud: &CloudOptions) -> Result<()> {
        let dense = &self.outcome.dense;
        output.add(ResultFile::Disparities.name(), |out| pfm::write_disparities(out, &dense.disparity))?;
        output.add(ResultFile::DisparityPng.name(), |out| disparity_png::write(out, &dense.disparity))?;
        let encoding = Encoding::of(&dense.disparity);
        if encoding != Encoding::KITTI {
            self.warnings.push(format!(
                "disparities lie outside the 0 to 255.996 px of a 16-bit PNG: in disparity.png a disparity is its value times {} px, \
                 plus {} px (disparity_png in report.json); disparity.pfm has it as it is",
                encoding.px_per_value(),
                encoding.offset
            ));
        }
        let range = color::disparity_range(&dense.disparity).unwrap_or((0, 0));
        let colors = color::disparity_colors(&dense.disparity, range);
        output.add(ResultFile::DisparityColors.name(), |out| png::write_rgb8(out, &colors))?;
        output.add(ResultFile::Confidences.name(), |out| png::write_grey8(out, &dense.confidence))?;

        let has_depth = self.outcome.no_depth.is_none() || self.job.config.force;
        if let Some(calibration) = self.job.calibration.filter(|_| has_depth) {
            let filter = cloud.filter(&calibration)?;
            let depth = self.depth(&calibration);
            let (positions, left_out) = self.positions(calibration, &filter);
            let picture = match self.job.config.reference {
                View::Left => &self.job.left,
                View::Right => &self.job.right,
            };
            let points = ply::colored(&positions, picture)?;
            let mesh = cloud.mesh.then(|| Mesh::new(&positions, &dense.disparity, picture)).transpose()?;
            let written = WrittenCloud(Cloud { points: points.len(), filter, left_out });
            if depth.data().iter().all(|z| z.is_infinite()) && dense.disparity.data().iter().any(|&d| d != NONE) {
                self.miss_depth(format!(
                    "no pixel has a depth: with doffs {} all disparities lie at infinity or beyond; check the calibration, and that left and \
                     right are not mixed up",
                    calibration.doffs
                ));
            } else {
                self.warnings.extend(written.warning());
            }
            output.add(ResultFile::Depths.name(), |out| pfm::write(out, &depth))?;
            self.depth_png = Some(output.add(ResultFile::DepthPng.name(), |out| depth_png::write(out, &depth))?);
            output.add(ResultFile::Cloud.name(), |out| ply::write(out, &points))?;
            if let Some(mesh) = mesh {
                output.add(MESH, |out| mesh::write(out, &mesh))?;
            }
            self.cloud = Some(written);
        }
        Ok(())
    }

    /// Notes why a depth that was asked for cannot be given.
    pub fn miss_depth(&mut self, reason: String) {
        if self.job.config.force {
            self.warnings.push(reason);
        } else {
            self.no_depth = Some(NoDepth { reason });
        }
    }

    /// Why the run ends with another exit code than 0, though its files are written.
    pub fn shortfall(&mut self) -> Option<anyhow::Error> {
        let not_trusted = self.not_trusted.take().map(anyhow::Error::from);
        not_trusted.or_else(|| self.no_depth.take().map(anyhow::Error::from))
    }

    /// The depth of each pixel of the map, in metres; +inf where there is none.
    fn depth(&self, calibration: &Calibration) -> Plane<f32> {
        let (map, reference) = (&self.outcome.dense.disparity, self.job.config.reference);
        let taken_back = self.rectified.as_ref().zip(self.back.as_ref());
        match taken_back.and_then(|(pair, back)| pair.points_in_metres(map, reference, Some(back))) {
            Some(positions) => positions.map(|&[.., z]| if z > 0.0 { z } else { f32::INFINITY }),
            None => depth_map(map, calibration),
        }
    }

    /// The positions of the pixels that `filter` keeps, in coordinates of the reference view's camera as it stood, in metres; not finite
    /// where a pixel is no point.
    fn positions(&self, calibration: Calibration, filter: &PointFilter) -> (Plane<[f32; 3]>, LeftOut) {
        let (dense, reference) = (&self.outcome.dense, self.job.config.reference);
        let calibration = match reference {
            View::Left => calibration,
            View::Right => calibration.seen_from_right(),
        };
        let (kept, left_out) = filter.apply(dense, &calibration);
        let stood =
            self.rectified.as_ref().and_then(|pair| pair.points_in_metres(&kept, reference, self.back.as_ref()));
        (stood.unwrap_or_else(|| ply::positions(&depth_map(&kept, &calibration), &calibration)), left_out)
    }

    /// Adds the paper's figures 4 and 5: interest points in both views, and matches between them.
    pub fn add_figures(&self, output: &mut Output) -> Result<()> {
        let Job { left, right, strongest, .. } = &self.job;
        // Points and matches belong to the pictures that were matched.
        let [left, right] = self.rectified.as_ref().map_or([left, right], |pair| pair.pictures.each_ref());
        let count = strongest.unwrap_or(usize::MAX);
        let keypoints = |picture: &Picture, features: &[Feature]| -> Plane<[u8; 3]> {
            let mut features = features.to_vec();
            features.sort_by(|a, b| b.response.total_cmp(&a.response));
            features.truncate(count);
            figure::keypoints(picture, &features)
        };
        let [left_features, right_features] = &self.outcome.features;
        let both = figure::side_by_side(&[&keypoints(left, left_features), &keypoints(right, right_features)]);
        let [keypoints_file, matches_file] = FIGURES;
        output.add(keypoints_file, |out| png::write_rgb8(out, &both))?;

        // Seeds come sorted, the most confident first.
        let seeds = self.outcome.seeding.seeds.iter().take(count);
        let pairs: Vec<_> = seeds.map(|seed| ([seed.x, seed.y], [seed.right_x(), seed.right_y()])).collect();
        let matches = figure::matches(left, right, &pairs);
        output.add(matches_file, |out| png::write_rgb8(out, &matches))
    }

    /// Adds the table of all matches of interest points, in the pictures that were matched.
    pub fn add_matches(&self, output: &mut Output) -> Result<()> {
        let Self { job, outcome, .. } = self;
        let table = MatchTable {
            features: outcome.features.each_ref().map(Vec::as_slice),
            matches: &outcome.seeding.matches,
            rows: outcome.seeding.rectification.rows,
            max_dy: f64::from(job.config.seeding.max_dy) * f64::from(outcome.reduction),
        };
        output.add(MATCHES, |out| out.write_all(table.csv().as_bytes()))
    }
}

/// Three panels: `view`, then `map` and `truth` (in pixels, not finite where unknown) in false colours that span the
/// range of `truth`.
pub fn beside_truth(view: &Picture, map: &DisparityMap, truth: &Plane<f32>) -> [Plane<[u8; 3]>; 3] {
    let truth = truth.map(|&pixels| fixed_point(pixels));
    let range = color::disparity_range(&truth).unwrap_or((0, 0));
    let colors = |map| color::disparity_colors(map, range);
    [view.map(|&[red, green, blue, _]| [red, green, blue]), colors(map), colors(&truth)]
}

/// Adds `report.json`, which lists all files added so far.
pub fn add_report(output: &mut Output, mut report: Value) -> Result<()> {
    report["files"] = output.names().iter().copied().chain([REPORT]).collect();
    output.add_json(REPORT, &report)
}
