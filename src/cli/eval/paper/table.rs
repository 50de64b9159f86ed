//! The figures of all methods and conditions: printed table and JSON.

use hsad::eval::curves::{accuracy_of_first, f_measure};
use serde_json::{Value, json};

use super::{record::Record, results::Group};

/// Legend of the columns.
pub const LEGEND: &str = "\
points: interest points of the first view that the second shows, the same for all methods. answers: matches of these and of
occluded points. In per cent: of N: precision of the N most confident answers, or of all if there are fewer; right:
precision of all answers; cover: answers divided by points; recall: right answers divided by the points that are shown; F:
harmonic mean of precision and recall; picture: share of the first view's pixels with an answer, and their precision.
seconds: time from the pictures to the answers.
";

/// Unit of a column.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Unit {
    Count,
    /// A share of 0 to 1, printed in per cent.
    Share,
    Seconds,
}

struct Column {
    name: &'static str,
    heading: &'static str,
    unit: Unit,
    of: fn(&Record) -> f64,
}

const fn column(name: &'static str, heading: &'static str, unit: Unit, of: fn(&Record) -> f64) -> Column {
    Column { name, heading, unit, of }
}

const COLUMNS: [Column; 12] = [
    column("points", "points", Unit::Count, |record| record.shown as f64),
    column("answers", "answers", Unit::Count, |record| record.right.len() as f64),
    column("precision_of_10", "of 10", Unit::Share, |record| accuracy_of_first(&record.right, 10)),
    column("precision_of_100", "of 100", Unit::Share, |record| accuracy_of_first(&record.right, 100)),
    column("precision_of_500", "of 500", Unit::Share, |record| accuracy_of_first(&record.right, 500)),
    column("precision", "right", Unit::Share, precision),
    column("coverage", "cover", Unit::Share, |record| record.right.len() as f64 / record.known as f64),
    column("recall", "recall", Unit::Share, recall),
    column("f_measure", "F", Unit::Share, |record| f_measure(precision(record), recall(record))),
    column("picture_coverage", "picture", Unit::Share, |record| {
        record.everywhere.last().map_or(0.0, |&(k, _)| k as f64 / record.pixels as f64)
    }),
    column("picture_precision", "right", Unit::Share, |record| {
        record.everywhere.last().map_or(f64::NAN, |&(k, right)| right as f64 / k as f64)
    }),
    column("seconds", "seconds", Unit::Seconds, |record| record.seconds),
];

fn precision(record: &Record) -> f64 {
    accuracy_of_first(&record.right, record.right.len())
}

fn recall(record: &Record) -> f64 {
    record.right.iter().filter(|&&right| right).count() as f64 / record.shown as f64
}

impl Column {
    /// Mean of a group; NaN without figures. A figure that is defined for some records only counts as 0 in the others:
    /// without answers nothing is right.
    fn mean(&self, group: &Group) -> f64 {
        let figures: Vec<f64> = group.records.iter().map(|record| (self.of)(record)).collect();
        let known: Vec<f64> = figures.iter().copied().filter(|figure| !figure.is_nan()).collect();
        if known.is_empty() { f64::NAN } else { known.iter().sum::<f64>() / figures.len() as f64 }
    }

    fn cell(&self, figure: f64) -> String {
        match self.unit {
            _ if figure.is_nan() => "-".into(),
            Unit::Count => format!("{figure:.0}"),
            Unit::Share => format!("{:.1}", 100.0 * figure),
            Unit::Seconds => format!("{figure:.1}"),
        }
    }
}

/// The printed table of a scene, with a blank line before each condition.
pub fn text(scene: &str, groups: &[Group]) -> String {
    let width = groups.iter().map(|group| group.name.len()).max().unwrap_or(0).max(scene.chars().count());
    let line = |name: &str, method: &str, cells: &[String]| {
        let cells: String = cells.iter().map(|cell| format!("{cell:>8}")).collect();
        format!("{name:width$}  {method:8}{cells}\n")
    };
    let mut text = line(scene, "", &COLUMNS.map(|column| column.heading.to_owned()));
    let mut before = "";
    for group in groups {
        let name = if group.name == before { "" } else { &group.name };
        if !name.is_empty() {
            text.push('\n');
        }
        before = &group.name;
        let method = group.method.name();
        text += &line(name, method, &COLUMNS.map(|column| column.cell(column.mean(group))));
    }
    text
}

/// The figures as JSON; an undefined figure is null.
pub fn json(groups: &[Group]) -> Value {
    let object = |group: &Group| {
        let mut object = json!({ "condition": group.name, "method": group.method.name() });
        for column in &COLUMNS {
            object[column.name] = column.mean(group).into();
        }
        object
    };
    groups.iter().map(object).collect()
}

#[cfg(test)]
mod tests {
    use super::{
        super::results::{groups, tests::records},
        *,
    };

    #[test]
    fn a_table_by_hand() {
        let records = records();
        let text = text("Art", &groups(&records));
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
        let row = |start: &str| lines.iter().find(|line| line.join(" ").starts_with(start)).unwrap().join(" ");
        assert_eq!(row("Art"), "Art points answers of 10 of 100 of 500 right cover recall F picture right seconds");
        // 8 points are shown, 16 have ground truth, and 4 are answered, all right: F = 2 * 1 * 0.5 / 1.5.
        assert_eq!(row("none"), "none sparse 8 4 100.0 100.0 100.0 100.0 25.0 50.0 66.7 0.4 100.0 0.5");
        assert_eq!(row("kamencay 8 0"), "kamencay 8 0 - - - - 0.0 0.0 - 0.0 - 0.5");
        assert_eq!(row("mean of 2"), "mean of 2 sparse 8 3 75.0 75.0 75.0 75.0 18.8 31.2 43.3 0.3 75.0 0.5");
        // Mean of the hybrid method's 4 of 6, and of no answers.
        assert_eq!(row("kamencay 8 3"), "kamencay 8 3 33.3 33.3 33.3 33.3 18.8 25.0 28.6 0.3 33.3 0.5");
        let json = json(&groups(&records));
        assert_eq!((&json[0]["recall"], &json[4]["precision"]), (&0.5.into(), &Value::Null));
    }
}
