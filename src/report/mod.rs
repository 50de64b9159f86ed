//! Parameters, figures and times as JSON, for programs: `report.json` of the command line, and what other bindings report.

mod file;
mod rectified;
#[cfg(feature = "pictures")]
mod run;
mod score;

pub use file::ResultFile;
pub use rectified::rectified;
#[cfg(feature = "pictures")]
pub use run::{Cloud, Run, run};
pub use score::{from_json as score_from_json, to_json as score};

pub use serde_json::Value;
use serde_json::{Map, json};

use crate::{
    Backend,
    config::{Config, Method},
    dense::{
        Aggregation, CostAggregation, CrossCheck, DenseConfig, DenseParameters, Difference, Penalties, Pyramid,
        Refinement, Search,
    },
    disparity::{DisparityRange, SCALE, coverage},
    image::Plane,
    io::Calibration,
    kamencay::KamencayParameters,
    pipeline::{NoDepth, Outcome, RangeSource},
    seeding::{BrightnessRelation, Rectification, Verdict},
    tiles::Tiling,
};

/// What the pipeline found, with the parameters and the duration of each step in seconds.
pub fn outcome(config: &Config, outcome: &Outcome) -> Map<String, Value> {
    let seconds: Map<String, Value> =
        outcome.times.iter().map(|(step, time)| (step.name().into(), json!(time.as_secs_f64()))).collect();
    let value = json!({
        "repetition": outcome.repetition,
        "mosaics": { "left": outcome.mosaics[0], "right": outcome.mosaics[1] },
        "parameters": parameters(config),
        "features": {
            "left": outcome.features[0].len(),
            "right": outcome.features[1].len(),
            "left_found": outcome.points_found[0],
            "right_found": outcome.points_found[1],
        },
        "seeds": outcome.seeding.seeds.len(),
        "range": searched(outcome),
        "levels": levels(config, outcome),
        "rectification": rectification(&outcome.seeding.rectification),
        "brightness": outcome.seeding.brightness.as_ref().map(brightness),
        "equalised": {
            "gain": f64::from(outcome.brightness.gain) / 256.0,
            "offset": f64::from(outcome.brightness.offset) / 256.0,
        },
        "unseen": unseen(&outcome.masks),
        "trust": number(outcome.trust),
        "no_depth": outcome.no_depth.map(NoDepth::name),
        "coverage": coverage(&outcome.dense.disparity),
        "measured": outcome.dense.measured(),
        "filled": outcome.dense.filled(),
        "seconds": seconds,
    });
    match value {
        Value::Object(figures) => figures,
        _ => Map::new(),
    }
}

/// Name, graphics interface and driver of the device.
pub fn device(backend: &Backend) -> Value {
    json!({ "name": backend.name(), "backend": backend.api(), "driver": backend.driver() })
}

/// The shortest decimal that reads back as this `f32`: 0.85, not 0.8500000238418579. Null for NaN and infinity.
pub fn number(value: f32) -> Value {
    value.to_string().parse::<f64>().map_or(Value::Null, Value::from)
}

/// All parameters of the configuration.
pub fn parameters(config: &Config) -> Value {
    let Config { features, seeding, range, least, method, reference, tiles, equalise, align, force } = config;
    let matching = &seeding.matching;
    let mut parameters = json!({
        "method": match method { Method::Hsad(_) => "hsad", Method::Kamencay(_) => "kamencay" },
        "reference": reference.name(),
        "range": range.map(ends),
        "min_disparity": least,
        "tiles": tiles.map(|Tiling { side, margin }| json!({ "side": side, "margin": margin })),
        "equalise": equalise,
        "align": align,
        "force": force,
        "features": {
            "octaves": features.octaves,
            "step": features.step,
            "threshold": number(features.threshold),
            "upright": features.upright,
            "max_features": features.max_features,
        },
        "matching": {
            "ratio": number(matching.ratio),
            "mutual": matching.mutual,
            "same_contrast": matching.same_contrast,
            "max_dy_px": number(seeding.max_dy),
        },
    });
    let of_method = match method {
        Method::Hsad(parameters) => dense(parameters),
        Method::Kamencay(parameters) => kamencay(parameters),
    };
    for (name, value) in of_method {
        parameters[name] = value;
    }
    parameters
}

/// Parameters that only block matching and semi-global matching take.
fn dense(parameters: &DenseParameters) -> Vec<(&'static str, Value)> {
    let DenseParameters { aggregation, interpolation, uniqueness, consistency, agreement, refinement } = parameters;
    let (window, compared) = match aggregation {
        Aggregation::Sad { side, compared, .. } => (Some(side), Some(compared.name())),
        Aggregation::Costs(_) => (None, None),
    };
    let (Aggregation::Sad { search, .. } | Aggregation::Costs(CostAggregation { search, .. })) = aggregation;
    let search = match search {
        Search::CoarseToFine => "coarse to fine",
        Search::Whole => "whole",
        Search::Levels(_) => "over a pyramid",
    };
    let max_lr_difference = consistency.map(|difference| f64::from(difference) / f64::from(SCALE));
    let refinement = refinement.map(|Refinement { support, majority, medians_before, fill, medians_after }| {
        json!({
            "support": support,
            "majority": majority,
            "medians_before": medians_before,
            "fill": fill,
            "medians_after": medians_after,
        })
    });
    vec![
        ("aggregation", aggregation_of(aggregation)),
        ("window", json!(window)),
        ("search", json!(search)),
        ("compared", json!(compared)),
        ("interpolation", json!(interpolation.name())),
        ("uniqueness_percent", json!(uniqueness)),
        ("max_lr_difference_px", json!(max_lr_difference)),
        ("agreement", json!(agreement)),
        ("refinement", json!(refinement)),
    ]
}

/// Parameters that only Kamencay's method takes.
fn kamencay(parameters: &KamencayParameters) -> Vec<(&'static str, Value)> {
    let KamencayParameters { mean_shift, segmentation, cost, smoothness, links, levels, turns, conclusion } =
        parameters;
    vec![
        ("mean_shift", json!({ "radius_px": mean_shift.radius, "range": mean_shift.range, "turns": mean_shift.turns })),
        ("segments", json!({ "join": segmentation.join, "least_px": segmentation.least })),
        ("cost", json!({ "window": 2 * cost.radius + 1, "color": part(cost.color), "gradient": part(cost.gradient) })),
        (
            "belief_propagation",
            json!({
                "slope": smoothness.slope,
                "limit": smoothness.limit,
                "links": {
                    "halving": links.halving, "least": links.least, "inside": links.inside, "across": links.across,
                },
                "levels": levels,
                "turns": turns,
            }),
        ),
        (
            "conclusion",
            json!({
                "confirmation_px": conclusion.confirmation,
                "least_confirmed": conclusion.least_confirmed,
                "tolerance_px": conclusion.tolerance,
            }),
        ),
    ]
}

fn part(Difference { weight, limit }: Difference) -> Value {
    json!({ "weight": weight, "limit": limit })
}

fn aggregation_of(aggregation: &Aggregation) -> Value {
    let Aggregation::Costs(CostAggregation { cost, window, semi_global, cross_check, .. }) = aggregation else {
        return "window".into();
    };
    // Without paths no penalty is applied: null.
    let penalty = |value: fn(&Penalties) -> u32| semi_global.map(|semi_global| value(&semi_global.penalties));
    json!({
        "cost_window": window,
        "paths": semi_global.map_or(0, |semi_global| semi_global.paths.directions().len()),
        "other_view": match cross_check { CrossCheck::Searched => "searched", CrossCheck::Claimed => "claimed" },
        "census_weight": cost.census,
        "difference": part(cost.difference),
        "gradient": part(cost.gradient),
        "weak_spread": cost.weak_spread,
        "p1": penalty(|penalties| penalties.p1),
        "p2": penalty(|penalties| penalties.p2),
        "least_p2": penalty(|penalties| penalties.least_p2),
        "p2_scale": penalty(|penalties| penalties.p2_scale),
    })
}

fn ends(range: DisparityRange) -> Value {
    json!({ "min": range.min, "max": range.last(), "count": range.count })
}

/// The disparity range that was searched, its origin, and the shares of the map at its ends; a fallback range comes with
/// the reason.
pub fn searched(Outcome { range, range_source, at_ends: [at_min, at_max], .. }: &Outcome) -> Value {
    let mut value = ends(*range);
    value["source"] = match range_source {
        RangeSource::Asked => "asked",
        RangeSource::Found(_) => "found",
        RangeSource::Fallback(_) => "fallback",
    }
    .into();
    match range_source {
        RangeSource::Asked => {}
        RangeSource::Found([min, max]) => {
            value["min_from"] = min.name().into();
            value["max_from"] = max.name().into();
        }
        RangeSource::Fallback(thin) => value["reason"] = thin.to_string().into(),
    }
    value["at_min"] = number(*at_min);
    value["at_max"] = number(*at_max);
    value
}

/// Number of levels of the pyramid by which the pair was matched; 1 without a pyramid.
fn levels(config: &Config, outcome: &Outcome) -> usize {
    let Method::Hsad(parameters) = config.method else { return 1 };
    let searched = DenseConfig { reference: config.reference, parameters, ..DenseConfig::new(outcome.range) };
    Pyramid::of(&searched, outcome.dense.disparity.size()).map_or(1, |pyramid| pyramid.levels().len())
}

/// The shares of both views that do not show the scene: transparent, masked, without data, or a constant border.
fn unseen(masks: &[Option<Plane<u8>>; 2]) -> Value {
    let [left, right] = masks.each_ref().map(|mask| {
        mask.as_ref().map_or(0.0, |mask| {
            mask.data().iter().filter(|&&value| value == 0).count() as f64 / mask.data().len() as f64
        })
    });
    json!({ "left": left, "right": right })
}

/// The verdict; figures of a fit only where most matches agree with the fit.
fn rectification(found: &Rectification) -> Value {
    let mut value = json!({ "verdict": found.verdict.name(), "agreeing": found.agreeing, "matches": found.seeds });
    let has_fit = !matches!(found.verdict, Verdict::Unknown | Verdict::Vertical);
    if has_fit && (found.is_alignable() || found.most_agree()) {
        for (name, figure) in [
            ("offset_px", found.offset),
            ("rotation_degrees", found.rotation),
            ("scale", found.scale),
            ("residual_px", found.residual),
            ("remaining_px", found.remaining),
            ("unexplained_px", found.unexplained),
            ("largest_px", found.largest),
            ("lean", found.lean),
            ("climb", found.climb),
        ] {
            value[name] = number(figure);
        }
        value["rows"] = json!({ "model": found.rows.kind().name(), "parameters": found.rows.parameters() });
    }
    value
}

fn brightness(&BrightnessRelation { gain, offset, residual }: &BrightnessRelation) -> Value {
    json!({ "gain": number(gain), "offset": number(offset), "residual": number(residual) })
}

/// The geometry of a rectified pair.
pub fn calibration(&Calibration { focal, baseline, doffs, cx, cy, .. }: &Calibration) -> Value {
    json!({ "focal_px": focal, "baseline_m": baseline, "doffs_px": doffs, "cx_px": cx, "cy_px": cy })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_short_as_they_are() {
        assert_eq!(number(0.85).to_string(), "0.85");
        assert_eq!(number(f32::NAN), Value::Null);
        assert_eq!(number(f32::INFINITY), Value::Null);
    }
}
