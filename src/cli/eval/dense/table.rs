//! The printed tables.

use super::record::{ERRORS, Figure, Record, Region, WRONG, WRONG_ESTIMATES, mean, of_method};

/// Legend of the columns.
pub const LEGEND: &str = "\
bad-T, D1, density: in per cent; avg, rms, A50, A90, A99: error of the estimated pixels, in pixels. bad-T: error above
T px; D1: error above 3 px and above 5 % of the disparity; a pixel without an estimate counts as wrong. A90: 90 % of
the errors are not larger.
";

/// Smallest width of the name column, so that the columns of all tables align.
const NAMES: usize = 22;

/// One table per region, and one over the estimated pixels only, unless all pixels are estimated; each with one row per
/// record and the means of each method. A scene without a mask of the region has no row.
pub fn tables(records: &[Record], methods: &[&str]) -> String {
    let everything: Vec<&Figure> = WRONG.iter().chain(&ERRORS).collect();
    let estimates: Vec<&Figure> = WRONG_ESTIMATES.iter().collect();
    let is_dense = records.iter().all(|record| record.scores.all.estimated == record.scores.all.known);
    let mut tables: Vec<String> = [
        ("Non-occluded pixels", Region::NonOccluded, &everything, true),
        ("All pixels", Region::All, &everything, true),
        ("Estimated of all", Region::All, &estimates, !is_dense),
    ]
    .into_iter()
    .filter(|&(.., is_wanted)| is_wanted)
    .filter_map(|(title, region, figures, _)| table(title, region, figures, records, methods))
    .collect();
    if is_dense {
        tables.push(
            "Every pixel has an estimate: the figures of the estimated pixels alone are those of all pixels.\n".into(),
        );
    }
    tables.join("\n")
}

fn table(title: &str, region: Region, figures: &[&Figure], records: &[Record], methods: &[&str]) -> Option<String> {
    let scored: Vec<_> = records.iter().filter_map(|record| Some((record, record.score(region)?))).collect();
    let mut rows: Vec<(String, &str, Vec<String>)> = Vec::new();
    for (record, score) in &scored {
        let cells = figures.iter().map(|figure| cell(figure, (figure.of)(score)));
        rows.push((format!("  {}", record.scene), &record.method, cells.collect()));
    }
    for method in methods {
        let scores = || of_method(records, method).filter_map(|record| record.score(region));
        let count = scores().count();
        if count > 1 {
            let cells = figures.iter().filter_map(|figure| Some(cell(figure, mean(figure, scores())?)));
            rows.push((format!("  mean of {count}"), method, cells.collect()));
        }
    }
    let headings = figures.iter().map(|figure| figure.heading.to_owned()).collect();
    rows.insert(0, (title.to_owned(), "", headings));

    let names = rows.iter().map(|(name, ..)| name.chars().count()).fold(NAMES, usize::max);
    let longest_method = rows.iter().map(|(_, method, _)| method.chars().count()).max()?;
    let text = rows.iter().map(|(name, method, cells)| {
        // With a single method the column is left out.
        let method = if methods.len() > 1 { format!("  {method:longest_method$}") } else { String::new() };
        let cells: String = cells.iter().map(|cell| format!("{cell:>8}")).collect();
        format!("{name:names$}{method}{cells}\n")
    });
    (!scored.is_empty()).then(|| text.collect())
}

fn cell(figure: &Figure, value: f64) -> String {
    match figure.factor * value {
        value if value.is_nan() => "-".into(),
        // Values up to here fit the column in fixed notation.
        value if value < 9999.995 => format!("{value:.2}"),
        value => format!("{value:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::{super::record::tests::record, *};

    #[test]
    fn tables_by_hand() {
        let records = [
            record("a", "hsad", &[0.0, 5.0, f32::NAN, 1.0], Some(&[0.0])),
            record("long name", "x", &[f32::NAN], None),
            record("b", "hsad", &[0.0, 0.0], Some(&[3.0])),
        ];
        let expected = "\
Non-occluded pixels          bad-0.5   bad-1   bad-2   bad-4      D1     avg     rms     A50     A90     A99 density
  a                     hsad    0.00    0.00    0.00    0.00    0.00    0.00    0.00    0.00    0.00    0.00  100.00
  b                     hsad  100.00  100.00  100.00    0.00    0.00    3.00    3.00    3.00    3.00    3.00  100.00
  mean of 2             hsad   50.00   50.00   50.00    0.00    0.00    1.50    1.50    1.50    1.50    1.50  100.00

All pixels                   bad-0.5   bad-1   bad-2   bad-4      D1     avg     rms     A50     A90     A99 density
  a                     hsad   75.00   50.00   50.00   50.00   50.00    2.00    2.94    1.00    5.00    5.00   75.00
  long name             x     100.00  100.00  100.00  100.00  100.00       -       -       -       -       -    0.00
  b                     hsad    0.00    0.00    0.00    0.00    0.00    0.00    0.00    0.00    0.00    0.00  100.00
  mean of 2             hsad   37.50   25.00   25.00   25.00   25.00    1.00    1.47    0.50    2.50    2.50   87.50

Estimated of all             bad-0.5   bad-1   bad-2   bad-4      D1
  a                     hsad   66.67   33.33   33.33   33.33   33.33
  long name             x          -       -       -       -       -
  b                     hsad    0.00    0.00    0.00    0.00    0.00
  mean of 2             hsad   33.33   16.67   16.67   16.67   16.67
";
        assert_eq!(tables(&records, &["hsad", "x"]), expected);

        let alone = tables(&records[2..], &["hsad"]);
        assert!(!alone.contains("hsad") && !alone.contains("mean"), "{alone}");
        assert!(
            alone.ends_with(
                "\nEvery pixel has an estimate: the figures of the estimated pixels alone are those of all pixels.\n"
            ),
            "{alone}"
        );
    }
}
