//! The report of a whole run: the content of `report.json` but for the list of files.

use std::time::Duration;

use serde_json::{Value, json};

use super::{calibration, device, number, outcome, rectified};
use crate::{
    Backend,
    config::Config,
    disparity::DisparityMap,
    image::Size,
    io::{
        Calibration,
        depth_png::{METRES_PER_VALUE, Unheld},
        disparity_png::Encoding,
        load::Stretch,
        ply::{LeftOut, PointFilter},
    },
    pipeline::{Outcome, RectifiedPair},
};

/// A run that has ended.
pub struct Run<'a> {
    /// Names of the left and the right view.
    pub names: [&'a str; 2],
    /// Size of the pictures that the map belongs to, in pixels.
    pub size: Size,
    /// How the views' samples became 8 bits; `None`: without a stretch.
    pub stretch: Option<Stretch>,
    /// What computed the map.
    pub backend: &'a Backend,
    /// The geometry of the disparities.
    pub calibration: Option<&'a Calibration>,
    /// The point cloud, if there is one.
    pub cloud: Option<&'a Cloud>,
    /// What the depth in millimetres lacks, if there is one.
    pub depth_png: Option<Unheld>,
    /// The pair that was matched, if it was rectified first.
    pub rectified: Option<&'a RectifiedPair>,
    /// Whether the map was taken back to the view as it was taken.
    pub mapped_back: bool,
    /// Why there is no depth though a calibration asks for it.
    pub no_depth: Option<&'a str>,
    /// Why the map is not to be trusted.
    pub not_trusted: Option<&'a str>,
    /// Doubts about the map, one line each.
    pub warnings: &'a [String],
    /// The parameters.
    pub config: &'a Config,
    /// What was found.
    pub outcome: &'a Outcome,
    /// Wall-clock time from opening the device, or from the beginning on an open one, to the map.
    pub total: Duration,
}

/// The points of a cloud, and those that were left out.
#[derive(Clone, Copy, Debug)]
pub struct Cloud {
    /// Number of points.
    pub points: usize,
    /// Which pixels became points.
    pub filter: PointFilter,
    /// Number of pixels that became none.
    pub left_out: LeftOut,
}

/// The report of a run.
pub fn run(run: &Run<'_>) -> Value {
    let stretched = |Stretch { low, high }| json!({ "low": number(low), "high": number(high) });
    let mut value = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "left": run.names[0],
        "right": run.names[1],
        "width": run.size.width,
        "height": run.size.height,
        "stretch": run.stretch.map(stretched),
        "device": device(run.backend),
        "calibration": run.calibration.map(calibration),
        "cloud": run.cloud.map(cloud),
        "rectified": run.rectified.map(rectified),
        "mapped_back": run.mapped_back,
        "depth_png": run.depth_png.map(depth_png),
        "not_trusted": run.not_trusted,
        "disparity_png": disparity_png(&run.outcome.dense.disparity),
        "warnings": run.warnings,
    });
    for (name, figure) in outcome(run.config, run.outcome) {
        value[name] = figure;
    }
    // The reason in words says more than its kind.
    if let Some(reason) = run.no_depth {
        value["no_depth"] = reason.into();
    }
    value["seconds"]["total"] = json!(run.total.as_secs_f64());
    value
}

/// The largest depth is null for any depth.
fn cloud(cloud: &Cloud) -> Value {
    let Cloud { points, filter: PointFilter { max_depth, min_confidence }, left_out: LeftOut { unsure, beyond } } =
        *cloud;
    json!({
        "points": points,
        "max_depth_m": max_depth,
        "min_confidence": min_confidence,
        "left_out": { "beyond_max_depth": beyond, "below_min_confidence": unsure },
    })
}

/// How the values of a depth PNG become metres, and how many depths they cannot hold.
fn depth_png(Unheld { beyond, nearer }: Unheld) -> Value {
    json!({ "metres_per_value": METRES_PER_VALUE, "left_out": { "beyond_65.535_m": beyond, "nearer_than_half_a_value": nearer } })
}

/// How the values of a disparity PNG become disparities: times the one, plus the other.
fn disparity_png(map: &DisparityMap) -> Value {
    let encoding = Encoding::of(map);
    json!({ "px_per_value": encoding.px_per_value(), "offset_px": encoding.offset })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_depth_is_null() {
        let filter = PointFilter { max_depth: f64::INFINITY, min_confidence: 16 };
        let of_any_depth = Cloud { points: 1, filter, left_out: LeftOut { unsure: 2, beyond: 0 } };
        assert_eq!(
            cloud(&of_any_depth),
            json!({
                "points": 1,
                "max_depth_m": null,
                "min_confidence": 16,
                "left_out": { "beyond_max_depth": 0, "below_min_confidence": 2 },
            })
        );
    }
}
