//! The curves: the paper's figures 7 to 9, and precision over coverage.

use hsad::eval::curves::{accuracy_of_first, f_measure_over_recall, recall_precision};

use super::record::{Record, steps};
use crate::cli::names::CURVES;

/// A kind of curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Precision over recall (figure 7).
    RecallPrecision,
    /// F-measure over recall (figure 8).
    FMeasure,
    /// Accuracy of the k most confident matches over k (figure 9).
    Accuracy,
    /// Precision over the share of the picture that is matched; not in the paper.
    Coverage,
}

/// A point of a curve, for the `k` most confident matches. Shares are 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub k: usize,
    pub x: f64,
    pub y: f64,
}

impl Figure {
    pub const ALL: [Self; 4] = [Self::RecallPrecision, Self::FMeasure, Self::Accuracy, Self::Coverage];

    /// Names of the CSV and the SVG file.
    pub fn files(self) -> [&'static str; 2] {
        CURVES[self as usize]
    }

    /// Names of the axes in the CSV file.
    fn axes(self) -> [&'static str; 2] {
        match self {
            Self::RecallPrecision => ["recall", "precision"],
            Self::FMeasure => ["recall", "f_measure"],
            Self::Accuracy => ["k", "accuracy"],
            Self::Coverage => ["coverage", "precision"],
        }
    }

    /// The curve of one method under one condition, the most confident match first.
    pub fn curve(self, record: &Record) -> Vec<Sample> {
        let counted = |points: Vec<(f64, f64)>| (1..).zip(points).map(|(k, (x, y))| Sample { k, x, y }).collect();
        let Record { right, shown, pixels, everywhere, .. } = record;
        match self {
            Self::RecallPrecision => {
                counted(recall_precision(right, *shown).iter().map(|point| (point.recall, point.precision)).collect())
            }
            Self::FMeasure => counted(f_measure_over_recall(right, *shown)),
            Self::Accuracy => counted((1..=right.len()).map(|k| (k as f64, accuracy_of_first(right, k))).collect()),
            Self::Coverage => everywhere
                .iter()
                .map(|&(k, right)| Sample { k, x: k as f64 / *pixels as f64, y: right as f64 / k as f64 })
                .collect(),
        }
    }

    /// The mean of curves at each `k`: of the `k` most confident matches under each condition, or of all if there are
    /// fewer. A condition without matches counts as 0.
    pub fn mean(self, curves: &[Vec<Sample>]) -> Vec<Sample> {
        let last = curves.iter().filter_map(|curve| curve.last()).map(|sample| sample.k).max().unwrap_or(0);
        let count = curves.len() as f64;
        let mean = |k: usize| {
            let held = curves.iter().filter_map(|curve| curve[..curve.partition_point(|sample| sample.k <= k)].last());
            let (x, y) = held.fold((0.0, 0.0), |(x, y), sample| (x + sample.x, y + sample.y));
            Sample { k, x: if self == Self::Accuracy { k as f64 } else { x / count }, y: y / count }
        };
        match self {
            Self::Coverage => steps(last).into_iter().map(mean).collect(),
            _ => (1..=last).map(mean).collect(),
        }
    }
}

/// All curves of a kind as CSV, one line per sample: `condition,method,k` and the two axes.
pub fn csv<'c>(figure: Figure, curves: impl Iterator<Item = (&'c str, &'c str, &'c [Sample])>) -> String {
    let [x, y] = figure.axes();
    let is_k = figure == Figure::Accuracy;
    let mut text = String::from("condition,method,k,");
    text += &if is_k { format!("{y}\n") } else { format!("{x},{y}\n") };
    for (condition, method, curve) in curves {
        for Sample { k, x, y } in curve {
            text += &format!("{condition},{method},{k},");
            text += &if is_k { format!("{y:.6}\n") } else { format!("{x:.6},{y:.6}\n") };
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{
        super::{method::Method, record::tests::record},
        *,
    };

    fn samples(figure: Figure, shown: usize, right: &str) -> Vec<(usize, f64, f64)> {
        let curve = figure.curve(&record("none", Method::Sparse, shown, right));
        curve.iter().map(|sample| (sample.k, sample.x, sample.y)).collect()
    }

    #[test]
    fn curves_by_hand() {
        let of = |figure| samples(figure, 4, "101");
        assert_eq!(of(Figure::RecallPrecision), [(1, 0.25, 1.0), (2, 0.25, 0.5), (3, 0.5, 2.0 / 3.0)]);
        // 2 * 0.25 * 1 / 1.25, 2 * 0.25 * 0.5 / 0.75
        let f = of(Figure::FMeasure);
        assert!((f[0].2 - 0.4).abs() < 1e-12 && (f[1].2 - 1.0 / 3.0).abs() < 1e-12 && f[2].1 == 0.5);
        assert_eq!(of(Figure::Accuracy), [(1, 1.0, 1.0), (2, 2.0, 0.5), (3, 3.0, 2.0 / 3.0)]);
        assert_eq!(of(Figure::Coverage), [(1, 0.001, 1.0), (2, 0.002, 0.5), (3, 0.003, 2.0 / 3.0)]);
    }

    #[test]
    fn means_hold_the_last_of_short_curves() {
        let curves = ["11", "0", ""].map(|right| Figure::RecallPrecision.curve(&record("", Method::Sparse, 4, right)));
        let mean = Figure::RecallPrecision.mean(&curves);
        let expected = [(1, 0.25 / 3.0, 1.0 / 3.0), (2, 0.5 / 3.0, 1.0 / 3.0)];
        assert_eq!(mean, expected.map(|(k, x, y)| Sample { k, x, y }));
        let accuracy = Figure::Accuracy.mean(&curves.map(|curve| curve[..].to_vec()));
        assert_eq!(accuracy.iter().map(|sample| sample.x).collect::<Vec<_>>(), [1.0, 2.0]);
        assert_eq!(Figure::Accuracy.mean(&[]), []);
    }

    #[test]
    fn csv_has_a_line_a_sample() {
        let curve = [Sample { k: 1, x: 0.25, y: 1.0 }];
        let text = |figure| csv(figure, [("none", "sparse", &curve[..])].into_iter());
        assert_eq!(text(Figure::FMeasure), "condition,method,k,recall,f_measure\nnone,sparse,1,0.250000,1.000000\n");
        assert_eq!(text(Figure::Accuracy), "condition,method,k,accuracy\nnone,sparse,1,1.000000\n");
    }
}
