//! The files of a matched pair, by the command's names and writers.

use std::io::{self, Write};

use hsad::{
    Error,
    dense::View,
    io::{
        Calibration,
        calibration::depth_map,
        color, depth_png, disparity_png, pfm,
        ply::{self, Point, PointFilter},
        png,
    },
    report::{self, Cloud, Run},
};
use wasm_bindgen::prelude::*;

use super::{
    errors::{named, thrown},
    matched::Matched,
};

/// The files of any pair.
const FILES: [&str; 5] = ["disparity.pfm", "disparity.png", "disparity-color.png", "confidence.png", "report.json"];
/// The files of a pair with depth.
const DEPTH_FILES: [&str; 3] = ["depth.pfm", "depth.png", "cloud.ply"];

#[wasm_bindgen]
impl Matched {
    /// Names of the files that there are.
    pub fn files(&self) -> Vec<String> {
        let of_depth = self.geometry().map_or(&[][..], |_| &DEPTH_FILES);
        FILES.iter().chain(of_depth).map(ToString::to_string).collect()
    }

    /// The bytes of a file.
    pub fn file(&self, name: &str) -> Result<Vec<u8>, JsValue> {
        let mut bytes = Vec::new();
        let written = self.write(name, &mut bytes).map_err(thrown)?;
        written
            .ok_or_else(|| named("Error", &format!("there is no {name} of this pair")))?
            .map_err(|error| named("Error", &format!("{name} cannot be written: {error}")))?;
        Ok(bytes)
    }
}

impl Matched {
    /// The geometry, if depth follows from the disparities.
    fn geometry(&self) -> Option<&Calibration> {
        self.matched.calibration.as_ref().filter(|_| self.matched.outcome.no_depth.is_none() || self.task.config.force)
    }

    /// Writes a file; `None` if there is no such file.
    fn write(&self, name: &str, out: &mut Vec<u8>) -> Result<Option<io::Result<()>>, Error> {
        let dense = &self.matched.outcome.dense;
        Ok(Some(match (name, self.geometry()) {
            ("disparity.pfm", _) => pfm::write_disparities(out, &dense.disparity),
            ("disparity.png", _) => disparity_png::write(out, &dense.disparity),
            ("disparity-color.png", _) => {
                let range = color::disparity_range(&dense.disparity).unwrap_or((0, 0));
                png::write_rgb8(out, &color::disparity_colors(&dense.disparity, range))
            }
            ("confidence.png", _) => png::write_grey8(out, &dense.confidence),
            ("report.json", geometry) => writeln!(out, "{:#}", self.report(geometry)?),
            ("depth.pfm", Some(calibration)) => pfm::write(out, &depth_map(&dense.disparity, calibration)),
            ("depth.png", Some(calibration)) => {
                depth_png::write(out, &depth_map(&dense.disparity, calibration)).map(drop)
            }
            ("cloud.ply", Some(calibration)) => ply::write(out, &self.points(calibration)?.0),
            _ => return Ok(None),
        }))
    }

    fn report(&self, geometry: Option<&Calibration>) -> Result<report::Value, Error> {
        let cloud = geometry.map(|calibration| self.points(calibration)).transpose()?.map(|(_, cloud)| cloud);
        let map = &self.matched.outcome.dense.disparity;
        let mut report = report::run(&Run {
            names: self.task.names.each_ref().map(String::as_str),
            size: self.picture.size(),
            stretch: self.task.stretch,
            backend: &self.backend,
            calibration: self.matched.calibration.as_ref(),
            cloud: cloud.as_ref(),
            depth_png: geometry.map(|calibration| depth_png::millimetres(&depth_map(map, calibration)).1),
            rectified: self.matched.rectified.as_ref(),
            mapped_back: false,
            no_depth: None,
            not_trusted: self.matched.not_trusted.as_deref(),
            warnings: &self.matched.warnings,
            config: &self.task.config,
            outcome: &self.matched.outcome,
            total: self.total,
        });
        report["files"] = self.files().into();
        Ok(report)
    }

    /// The points of the cloud, in coordinates of the left camera as it stood, in metres.
    fn points(&self, calibration: &Calibration) -> Result<(Vec<Point>, Cloud), Error> {
        let (dense, filter) = (&self.matched.outcome.dense, PointFilter::new(calibration));
        let (points, left_out) = match &self.matched.rectified {
            Some(pair) => {
                let (kept, left_out) = filter.apply(dense, calibration);
                let positions = pair.points_in_metres(&kept, View::Left, None);
                let points = positions.map(|positions| ply::colored(&positions, &self.picture)).transpose()?;
                (points.unwrap_or_default(), left_out)
            }
            None => ply::points(dense, &self.picture, calibration, &filter)?,
        };
        let cloud = Cloud { points: points.len(), filter, left_out };
        Ok((points, cloud))
    }
}
