//! Scores of one map, with their JSON and CSV forms.

use hsad::{
    eval::{Score, scene::Scores},
    report,
};
use serde_json::{Value, json};

use crate::cli::eval::saved_results;

/// Scores of one method's map of one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    pub scene: String,
    pub method: String,
    pub scores: Scores,
    /// The disparity range that was searched, as in report.json; null for a supplied map.
    pub range: Value,
    /// Wall-clock time from the pictures to the map in seconds, including building the kernels; `None` for a supplied
    /// map.
    pub seconds: Option<f64>,
    /// Warnings about the map, one line each.
    pub warnings: Vec<String>,
}

impl saved_results::Saveable for Record {
    fn to_json(&self) -> Value {
        let Self { scene, method, scores, range, seconds, warnings } = self;
        json!({
            "scene": scene,
            "method": method,
            "all": report::score(&scores.all),
            "non_occluded": scores.non_occluded.as_ref().map(report::score),
            "range": range,
            "seconds": seconds,
            "warnings": warnings,
        })
    }

    fn from_json(value: &Value) -> Option<Self> {
        let text = |value: &Value| value.as_str().map(String::from);
        let non_occluded = match value.get("non_occluded")? {
            Value::Null => None,
            figures => Some(report::score_from_json(figures)?),
        };
        Some(Self {
            scene: text(&value["scene"])?,
            method: text(&value["method"])?,
            scores: Scores { all: report::score_from_json(&value["all"])?, non_occluded },
            range: value.get("range")?.clone(),
            seconds: value.get("seconds")?.as_f64(),
            warnings: value["warnings"].as_array()?.iter().map(text).collect::<Option<_>>()?,
        })
    }
}

impl Record {
    /// Score over the pixels of `region`; `None` if the scene has no mask of the region.
    pub fn score(&self, region: Region) -> Option<&Score> {
        match region {
            Region::All => Some(&self.scores.all),
            Region::NonOccluded => self.scores.non_occluded.as_ref(),
        }
    }
}

/// A set of scored pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// All pixels with ground truth.
    All,
    /// The pixels with ground truth that both views see.
    NonOccluded,
}

impl Region {
    pub const BOTH: [Self; 2] = [Self::NonOccluded, Self::All];

    /// Name of the region in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::NonOccluded => "non-occluded",
        }
    }
}

/// A figure of a score: name, heading and value.
pub struct Figure {
    /// Name in files, where shares are 0 to 1; the suffix `_est` marks a share of the estimated pixels.
    pub name: &'static str,
    /// Column heading in tables, where shares are in per cent.
    pub heading: &'static str,
    /// Factor from the value in files to the value in tables.
    pub factor: f64,
    pub of: fn(&Score) -> f64,
}

const fn share(name: &'static str, heading: &'static str, of: fn(&Score) -> f64) -> Figure {
    Figure { name, heading, factor: 100.0, of }
}

const fn pixels(name: &'static str, heading: &'static str, of: fn(&Score) -> f64) -> Figure {
    Figure { name, heading, factor: 1.0, of }
}

/// Shares of wrong pixels among all scored pixels; the thresholds are [`hsad::eval::scene::THRESHOLDS`].
pub const WRONG: [Figure; 5] = [
    share("bad_0.5", "bad-0.5", |score| score.bad[0].of_known),
    share("bad_1", "bad-1", |score| score.bad[1].of_known),
    share("bad_2", "bad-2", |score| score.bad[2].of_known),
    share("bad_4", "bad-4", |score| score.bad[3].of_known),
    share("d1", "D1", |score| score.d1.of_known),
];

/// Shares of wrong pixels among the estimated pixels.
pub const WRONG_ESTIMATES: [Figure; 5] = [
    share("bad_0.5_est", "bad-0.5", |score| score.bad[0].of_estimated),
    share("bad_1_est", "bad-1", |score| score.bad[1].of_estimated),
    share("bad_2_est", "bad-2", |score| score.bad[2].of_estimated),
    share("bad_4_est", "bad-4", |score| score.bad[3].of_estimated),
    share("d1_est", "D1", |score| score.d1.of_estimated),
];

/// Errors of the estimated pixels, and their share.
pub const ERRORS: [Figure; 6] = [
    pixels("average_px", "avg", |score| score.average),
    pixels("rms_px", "rms", |score| score.rms),
    pixels("a50_px", "A50", |score| score.a50),
    pixels("a90_px", "A90", |score| score.a90),
    pixels("a99_px", "A99", |score| score.a99),
    share("density", "density", Score::coverage),
];

/// All figures, in the order of the CSV columns.
fn figures() -> impl Iterator<Item = &'static Figure> {
    WRONG.iter().chain(&WRONG_ESTIMATES).chain(&ERRORS)
}

/// Mean of a figure; `None` without scores, NaN if the figure of a score is NaN.
pub fn mean<'s>(figure: &Figure, scores: impl Iterator<Item = &'s Score>) -> Option<f64> {
    let (sum, count) = scores.fold((0.0, 0), |(sum, count), score| (sum + (figure.of)(score), count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// CSV, one line per record and region: names, pixels, all figures, and seconds. An undefined figure is an empty field.
pub fn csv(records: &[Record]) -> String {
    let number = |value: f64| if value.is_nan() { String::new() } else { value.to_string() };
    let mut text = String::from("scene,method,region,pixels,estimated");
    figures().for_each(|figure| text += &format!(",{}", figure.name));
    text += ",seconds\n";
    for record in records {
        for region in Region::BOTH {
            let Some(score) = record.score(region) else { continue };
            let names = [&record.scene, &record.method].map(|name| quoted(name));
            text += &format!("{},{},{},{}", names.join(","), region.name(), score.known, score.estimated);
            figures().for_each(|figure| text += &format!(",{}", number((figure.of)(score))));
            text += &format!(",{}\n", record.seconds.map(number).unwrap_or_default());
        }
    }
    text
}

/// Quotes a CSV field if necessary (RFC 4180).
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field.into() }
}

/// Means of each method and region as JSON, under the names of the CSV columns.
pub fn means(records: &[Record], methods: &[&str]) -> Value {
    let mut means = Vec::new();
    for method in methods {
        for region in Region::BOTH {
            let scores = || of_method(records, method).filter_map(|record| record.score(region));
            let mut value = json!({ "method": method, "region": region.name(), "scenes": scores().count() });
            for figure in figures() {
                value[figure.name] = mean(figure, scores()).into();
            }
            means.push(value);
        }
    }
    means.into()
}

/// The records of one method.
pub fn of_method<'r>(records: &'r [Record], method: &'r str) -> impl Iterator<Item = &'r Record> {
    records.iter().filter(move |record| record.method == method)
}

#[cfg(test)]
pub mod tests {
    use hsad::{
        eval::{scene::THRESHOLDS, score_pixels},
        image::Plane,
    };

    use super::*;
    use crate::cli::eval::saved_results::Saveable as _;

    /// A record from the error of each pixel; NaN stands for no estimate.
    pub fn record(scene: &str, method: &str, errors: &[f32], non_occluded: Option<&[f32]>) -> Record {
        let score = |errors: &[f32]| {
            let map = Plane::new((errors.len() as u32, 1), errors.to_vec()).unwrap();
            score_pixels(&map, &map.map(|_| 0.0), None, &THRESHOLDS).unwrap()
        };
        Record {
            scene: scene.into(),
            method: method.into(),
            scores: Scores { all: score(errors), non_occluded: non_occluded.map(score) },
            range: Value::Null,
            seconds: None,
            warnings: Vec::new(),
        }
    }

    #[test]
    fn files_by_hand() {
        let records =
            [record("a,\"b\"", "hsad", &[0.0, f32::NAN], None), record("c", "hsad", &[6.0], Some(&[f32::NAN]))];
        let text = csv(&records);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(
            lines[0],
            "scene,method,region,pixels,estimated,bad_0.5,bad_1,bad_2,bad_4,d1,bad_0.5_est,bad_1_est,bad_2_est,\
             bad_4_est,d1_est,average_px,rms_px,a50_px,a90_px,a99_px,density,seconds"
        );
        assert_eq!(lines[1], "\"a,\"\"b\"\"\",hsad,all,2,1,0.5,0.5,0.5,0.5,0.5,0,0,0,0,0,0,0,0,0,0,0.5,");
        assert_eq!(lines[2], "c,hsad,non-occluded,1,0,1,1,1,1,1,,,,,,,,,,,0,");
        assert_eq!(lines[3], "c,hsad,all,1,1,1,1,1,1,1,1,1,1,1,1,6,6,6,6,6,1,");
        assert_eq!(lines.len(), 4);

        let means = means(&records, &["hsad", "none"]);
        assert_eq!((&means[0]["region"], &means[0]["scenes"]), (&"non-occluded".into(), &1.into()));
        assert_eq!((&means[0]["bad_2"], &means[0]["average_px"]), (&1.0.into(), &Value::Null));
        assert_eq!(
            (&means[1]["scenes"], &means[1]["bad_2"], &means[1]["average_px"]),
            (&2.into(), &0.75.into(), &3.0.into())
        );
        assert_eq!((&means[3]["scenes"], &means[3]["bad_2"]), (&0.into(), &Value::Null));
    }

    #[test]
    fn records_come_back() {
        let mut all = record("a", "hsad", &[0.1, f32::NAN, 3.0], Some(&[0.7]));
        (all.seconds, all.warnings) = (Some(0.1), vec!["odd".into()]);
        all.range = serde_json::json!({ "min": 1 });
        for record in [all, record("b", "x", &[1.0], None)] {
            let text = record.to_json().to_string();
            assert_eq!(Record::from_json(&serde_json::from_str(&text).unwrap()), Some(record));
        }
        assert_eq!(Record::from_json(&Value::Null), None);
    }
}
