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
    report::{self, Cloud, ResultFile, Run, Value},
};
use wasm_bindgen::prelude::*;

use super::{
    errors::{named, thrown},
    matched::Matched,
};

/// What the page says of a file: a label, and what is in it.
fn described(file: ResultFile) -> [&'static str; 2] {
    match file {
        ResultFile::Disparities => ["PFM", "Disparities in pixels, floats; inf where there is none"],
        ResultFile::DisparityPng => [
            "PNG",
            "Disparities as 16-bit grey, 256 per pixel, 0 where there is none; negative ones by an offset in its text",
        ],
        ResultFile::DisparityColors => ["Colours", "The map in false colours"],
        ResultFile::Confidences => ["Confidence", "Confidences as 8-bit grey"],
        ResultFile::Depths => ["Depth PFM", "Depths in metres, floats"],
        ResultFile::DepthPng => ["Depth PNG", "Depths in millimetres as 16-bit grey, 0 where there is none"],
        ResultFile::Cloud => ["PLY", "The point cloud in metres, of measured pixels"],
        ResultFile::Report => ["Report", "Parameters, figures and doubts as JSON"],
    }
}

#[wasm_bindgen]
impl Matched {
    /// Names of the files that there are.
    pub fn files(&self) -> Vec<String> {
        ResultFile::ALL.into_iter().filter(|&file| self.has(file)).map(|file| file.name().into()).collect()
    }

    /// All files that a pair may have as JSON: name, label, title, and whether this pair has the file.
    pub fn offered(&self) -> String {
        let offered = |file: ResultFile| {
            let [label, title] = described(file);
            let texts =
                [("name", file.name()), ("label", label), ("title", title)].map(|(key, text)| (key, Value::from(text)));
            texts.into_iter().chain([("isThere", self.has(file).into())]).collect::<Value>()
        };
        Value::from_iter(ResultFile::ALL.map(offered)).to_string()
    }

    /// The bytes of a file.
    pub fn file(&self, name: &str) -> Result<Vec<u8>, JsValue> {
        let mut bytes = Vec::new();
        let known = ResultFile::ALL.into_iter().find(|file| file.name() == name && self.has(*file));
        let file = known.ok_or_else(|| named("Error", &format!("there is no {name} of this pair")))?;
        self.write(file, &mut bytes)
            .map_err(thrown)?
            .map_err(|error| named("Error", &format!("{name} cannot be written: {error}")))?;
        Ok(bytes)
    }
}

impl Matched {
    /// The geometry, if depth follows from the disparities.
    fn geometry(&self) -> Option<&Calibration> {
        self.matched
            .judgement
            .calibration
            .as_ref()
            .filter(|_| self.matched.outcome.no_depth.is_none() || self.task.config.force)
    }

    fn has(&self, file: ResultFile) -> bool {
        !file.needs_depth() || self.geometry().is_some()
    }

    /// Writes a file; nothing of a file that [`Self::has`] not.
    fn write(&self, file: ResultFile, out: &mut Vec<u8>) -> Result<io::Result<()>, Error> {
        let dense = &self.matched.outcome.dense;
        Ok(match (file, self.geometry()) {
            (ResultFile::Disparities, _) => pfm::write_disparities(out, &dense.disparity),
            (ResultFile::DisparityPng, _) => disparity_png::write(out, &dense.disparity),
            (ResultFile::DisparityColors, _) => {
                let range = color::disparity_range(&dense.disparity).unwrap_or((0, 0));
                png::write_rgb8(out, &color::disparity_colors(&dense.disparity, range))
            }
            (ResultFile::Confidences, _) => png::write_grey8(out, &dense.confidence),
            (ResultFile::Report, geometry) => writeln!(out, "{:#}", self.report(geometry)?),
            (ResultFile::Depths, Some(calibration)) => pfm::write(out, &depth_map(&dense.disparity, calibration)),
            (ResultFile::DepthPng, Some(calibration)) => {
                depth_png::write(out, &depth_map(&dense.disparity, calibration)).map(drop)
            }
            (ResultFile::Cloud, Some(calibration)) => ply::write(out, &self.points(calibration)?.0),
            (ResultFile::Depths | ResultFile::DepthPng | ResultFile::Cloud, None) => Ok(()),
        })
    }

    fn report(&self, geometry: Option<&Calibration>) -> Result<Value, Error> {
        let cloud = geometry.map(|calibration| self.points(calibration)).transpose()?.map(|(_, cloud)| cloud);
        let map = &self.matched.outcome.dense.disparity;
        let mut report = report::run(&Run {
            names: self.task.names.each_ref().map(String::as_str),
            size: self.picture.size(),
            stretch: self.task.stretch,
            backend: &self.backend,
            calibration: self.matched.judgement.calibration.as_ref(),
            cloud: cloud.as_ref(),
            depth_png: geometry.map(|calibration| depth_png::millimetres(&depth_map(map, calibration)).1),
            rectified: self.matched.rectified.as_ref(),
            mapped_back: false,
            no_depth: None,
            not_trusted: self.matched.judgement.not_trusted.as_deref(),
            warnings: &self.matched.judgement.warnings,
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
