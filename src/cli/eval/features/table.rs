//! The figures of all pairs: printed table, CSV and JSON.

use serde_json::{Map, Value, json};

use crate::cli::eval::saved_results;

/// Unit of a column's figures.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    Count,
    /// A share of 0 to 1, printed in per cent.
    Share,
}

/// A column: name in CSV and JSON, heading in the printed table, and unit.
pub struct Column {
    pub name: String,
    pub title: String,
    pub unit: Unit,
}

/// The figures of a pair under a condition; NaN for an undefined figure.
pub struct Row {
    pub scene: String,
    pub condition: String,
    pub figures: Vec<f64>,
}

impl saved_results::Saveable for Row {
    fn to_json(&self) -> Value {
        json!({ "scene": self.scene, "condition": self.condition, "figures": self.figures })
    }

    fn from_json(value: &Value) -> Option<Self> {
        let text = |value: &Value| value.as_str().map(String::from);
        let figure = |value: &Value| if value.is_null() { Some(f64::NAN) } else { value.as_f64() };
        Some(Self {
            scene: text(&value["scene"])?,
            condition: text(&value["condition"])?,
            figures: value["figures"].as_array()?.iter().map(figure).collect::<Option<_>>()?,
        })
    }
}

/// All rows, grouped by condition.
pub struct Table {
    pub columns: Vec<Column>,
    pub rows: Vec<Row>,
}

impl Table {
    /// The mean of each condition, in the order of the conditions. A figure that is defined for some rows only counts
    /// as 0 in the others: without matches nothing is right.
    pub fn means(&self) -> Vec<Row> {
        let mut conditions: Vec<&str> = self.rows.iter().map(|row| &*row.condition).collect();
        conditions.dedup();
        conditions.into_iter().map(|condition| self.mean(condition)).collect()
    }

    fn of<'a>(&'a self, condition: &'a str) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |row| row.condition == condition)
    }

    fn mean(&self, condition: &str) -> Row {
        let figure = |column: usize| {
            let figures: Vec<f64> = self.of(condition).map(|row| row.figures[column]).collect();
            let known: f64 = figures.iter().filter(|figure| !figure.is_nan()).sum();
            if figures.iter().all(|figure| figure.is_nan()) { f64::NAN } else { known / figures.len() as f64 }
        };
        let figures = (0..self.columns.len()).map(figure).collect();
        Row { scene: "mean".into(), condition: condition.into(), figures }
    }

    /// The printed rows of a condition with their mean below; shares in per cent, scene names padded to `width`.
    pub fn text(&self, condition: &str, width: usize) -> String {
        let cells = |name: &str, cells: Vec<String>| {
            let mut line = format!("{name:width$}");
            for (column, cell) in self.columns.iter().zip(cells) {
                line += &format!("  {cell:>width$}", width = column.title.chars().count().max(6));
            }
            line + "\n"
        };
        let mut text = format!("{condition}\n");
        text += &cells("", self.columns.iter().map(|column| column.title.clone()).collect());
        for row in self.of(condition).chain([&self.mean(condition)]) {
            let cell = |(column, &figure): (&Column, &f64)| match column.unit {
                _ if figure.is_nan() => "-".into(),
                Unit::Count => format!("{figure:.0}"),
                Unit::Share => format!("{:.1}", 100.0 * figure),
            };
            text += &cells(&row.scene, self.columns.iter().zip(&row.figures).map(cell).collect());
        }
        text
    }

    /// CSV, one line per pair and condition, without means; shares are 0 to 1, an undefined figure is an empty field.
    pub fn csv(&self) -> String {
        let mut text = String::from("scene,condition");
        self.columns.iter().for_each(|column| text += &format!(",{}", column.name));
        text.push('\n');
        for Row { scene, condition, figures } in &self.rows {
            text += &format!("{},{condition}", quoted(scene));
            for figure in figures {
                text += &if figure.is_nan() { ",".into() } else { format!(",{figure}") };
            }
            text.push('\n');
        }
        text
    }

    /// Rows and means as JSON; an undefined figure is null.
    pub fn json(&self) -> Value {
        let object = |row: &Row| {
            let mut object = Map::new();
            object.insert("scene".into(), json!(row.scene));
            object.insert("condition".into(), json!(row.condition));
            let figures = self.columns.iter().zip(&row.figures);
            object.extend(figures.map(|(column, figure)| (column.name.clone(), json!(figure))));
            Value::Object(object)
        };
        json!({
            "pairs": self.rows.iter().map(object).collect::<Vec<_>>(),
            "means": self.means().iter().map(object).collect::<Vec<_>>(),
        })
    }
}

/// Quotes a name as a CSV field if necessary (RFC 4180).
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::eval::saved_results::Saveable as _;

    fn table() -> Table {
        let column = |name: &str, unit| Column { name: name.into(), title: name.into(), unit };
        let row = |scene: &str, condition: &str, figures: [f64; 3]| Row {
            scene: scene.into(),
            condition: condition.into(),
            figures: figures.into(),
        };
        Table {
            columns: vec![column("n", Unit::Count), column("p", Unit::Share), column("q", Unit::Share)],
            rows: vec![
                row("a,b", "none", [10.0, 0.5, f64::NAN]),
                row("c", "none", [20.0, f64::NAN, f64::NAN]),
                row("c", "noise=3", [7.0, 1.0, 0.25]),
            ],
        }
    }

    #[test]
    fn missing_figures_count_as_0_in_means_and_are_shown_as_missing() {
        let means = table().means();
        assert_eq!((means.len(), &means[0].figures[..2], means[0].figures[2].is_nan()), (2, &[15.0, 0.25][..], true));
        let text = table().text("none", 6);
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
        let expected = ["none", "n p q", "a,b 10 50.0 -", "c 20 - -", "mean 15 25.0 -"];
        assert_eq!(lines, expected.map(|line| line.split(' ').collect::<Vec<_>>()));
        let widths: Vec<usize> = text.lines().skip(1).map(str::len).collect();
        assert_eq!(widths, [6 + 3 * 8; 4]);
        assert!(table().text("noise=3", 6).ends_with("mean         7   100.0    25.0\n"));
    }

    #[test]
    fn programs_read_shares_and_gaps() {
        assert_eq!(table().csv(), "scene,condition,n,p,q\n\"a,b\",none,10,0.5,\nc,none,20,,\nc,noise=3,7,1,0.25\n");
        let json = table().json();
        assert_eq!(json["pairs"][2], json!({"scene": "c", "condition": "noise=3", "n": 7.0, "p": 1.0, "q": 0.25}));
        assert_eq!(json["pairs"][1]["p"], Value::Null);
        assert_eq!(json["means"][0]["n"], 15.0);
    }

    #[test]
    fn rows_come_back_with_their_gaps() {
        let row = Row { scene: "a".into(), condition: "noise=3".into(), figures: vec![0.1, f64::NAN, 7.0] };
        let back = Row::from_json(&serde_json::from_str(&row.to_json().to_string()).unwrap()).unwrap();
        assert_eq!((&*back.scene, &*back.condition), ("a", "noise=3"));
        assert_eq!((back.figures[0], back.figures[1].is_nan(), back.figures[2]), (0.1, true, 7.0));
        assert!(Row::from_json(&json!({ "scene": "a", "condition": "none", "figures": ["x"] })).is_none());
    }
}
