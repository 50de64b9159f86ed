//! The curves as SVG plots: one panel per condition and mean, one line per method.

use hsad::image::Size;
use std::error::Error;

use plotters::prelude::*;

use super::{
    curve::{Figure, Sample},
    method::Method,
    results::Group,
};

/// Number of panels in a row.
const COLUMNS: usize = 4;
/// Width and height of a panel, in pixels.
const PANEL: Size = Size::new(240, 190);
/// Height of the header with the title and the legend, in pixels.
const HEADER: u32 = 46;
/// Font size that plotters needs for text of 1 px.
const EM: f64 = 1.24;
/// Samples nearer to the last drawn one than this share of both axes are left out.
const NEAR: f64 = 1.0 / 80.0;

/// The horizontal axis.
struct Axis {
    /// Position of a sample on the axis.
    place: fn(&Sample) -> f64,
    ends: [f64; 2],
    /// Whether the axis shows powers of ten, of which only whole ones have a label.
    logarithmic: bool,
}

impl Axis {
    fn new(figure: Figure, curves: &[Vec<Sample>]) -> Self {
        let all = || curves.iter().flatten();
        match figure {
            Figure::RecallPrecision | Figure::FMeasure => {
                Self { place: |sample| 100.0 * sample.x, ends: [0.0, 100.0], logarithmic: false }
            }
            Figure::Accuracy => {
                let place = |sample: &Sample| sample.x.log10();
                let most = all().map(place).fold(1.0, f64::max);
                Self { place, ends: [0.0, most], logarithmic: true }
            }
            Figure::Coverage => {
                let place = |sample: &Sample| (100.0 * sample.x).log10();
                let least = all().map(place).fold(1.0, f64::min).floor();
                Self { place, ends: [least, 2.0], logarithmic: true }
            }
        }
    }

    fn label(&self, at: f64) -> String {
        match self.logarithmic {
            false => format!("{at:.0}"),
            true if (at - at.round()).abs() > 1e-6 => String::new(),
            true => format!("{}", 10f64.powf(at.round())),
        }
    }
}

fn title(figure: Figure) -> &'static str {
    match figure {
        Figure::RecallPrecision => "precision (%) over recall (%), as the paper's figure 7",
        Figure::FMeasure => "F-measure (%) over recall (%), as the paper's figure 8",
        Figure::Accuracy => "accuracy (%) of the k most confident answers over k, as the paper's figure 9",
        Figure::Coverage => "precision (%) over the share of the picture's pixels that are answered (%)",
    }
}

fn color(method: Method) -> RGBColor {
    match method {
        Method::Sparse => RGBColor(0, 90, 181),
        Method::Kamencay => RGBColor(213, 94, 0),
        Method::Balanced => RGBColor(0, 140, 100),
    }
}

/// The curves of a scene as SVG; the means come first.
///
/// # Errors
/// The errors of plotters; there is no file that could fail.
pub fn svg(figure: Figure, scene: &str, groups: &[Group]) -> Result<String, Box<dyn Error + Send + Sync>> {
    let curves: Vec<Vec<Sample>> = groups.iter().map(|group| group.curve(figure)).collect();
    let axis = Axis::new(figure, &curves);
    let mut names: Vec<&str> = Vec::new();
    for group in groups {
        if !names.contains(&&*group.name) {
            names.push(&group.name);
        }
    }
    names.sort_by_key(|name| !name.starts_with("mean "));

    let rows = names.len().div_ceil(COLUMNS);
    let columns = names.len().min(COLUMNS);
    let size = (PANEL.width * COLUMNS as u32, HEADER + PANEL.height * rows as u32);
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE)?;
        let (header, panels) = root.split_vertically(HEADER);
        header.draw(&Text::new(format!("{scene}: {}", title(figure)), (12, 6), ("sans-serif", 16.0 * EM)))?;
        for (place, method) in (0..).zip(Method::ALL) {
            let x = 14 + 110 * place;
            header.draw(&PathElement::new([(x, 35), (x + 22, 35)], color(method).stroke_width(2)))?;
            header.draw(&Text::new(method.name(), (x + 28, 28), ("sans-serif", 12.0 * EM)))?;
        }
        let width = PANEL.width * columns as u32;
        let (panels, _) = panels.split_horizontally(width);
        for (name, panel) in names.iter().zip(panels.split_evenly((rows, columns.max(1)))) {
            let [from, to] = axis.ends;
            let mut chart = ChartBuilder::on(&panel)
                .caption(name, ("sans-serif", 12.0 * EM))
                .margin(4)
                .margin_right(14)
                .x_label_area_size(20)
                .y_label_area_size(30)
                .build_cartesian_2d(from..to, 0.0..100.0)?;
            chart
                .configure_mesh()
                .max_light_lines(0)
                .bold_line_style(RGBColor(225, 225, 225))
                .axis_style(RGBColor(120, 120, 120))
                .set_all_tick_mark_size(3)
                .label_style(("sans-serif", 9.0 * EM))
                .x_labels(5)
                .y_labels(5)
                .x_label_formatter(&|at| axis.label(*at))
                .y_label_formatter(&|at| format!("{at:.0}"))
                .draw()?;
            // The first method has the shortest curve and is drawn on top.
            for (group, curve) in groups.iter().zip(&curves).filter(|(group, _)| group.name == *name).rev() {
                chart.draw_series(LineSeries::new(thinned(curve, &axis), color(group.method).stroke_width(2)))?;
            }
        }
        root.present()?;
    }
    Ok(text)
}

/// The samples of a curve that are visibly apart.
fn thinned(curve: &[Sample], axis: &Axis) -> Vec<(f64, f64)> {
    let [from, to] = axis.ends;
    let mut places: Vec<(f64, f64)> = Vec::new();
    for (index, sample) in curve.iter().enumerate() {
        let place = ((axis.place)(sample), 100.0 * sample.y);
        let is_far = places.last().is_none_or(|last| {
            (place.0 - last.0).abs() > NEAR * (to - from) || (place.1 - last.1).abs() > NEAR * 100.0
        });
        if place.0.is_finite() && place.1.is_finite() && (is_far || index + 1 == curve.len()) {
            places.push(place);
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::{
        super::results::{groups, tests::records},
        *,
    };

    #[test]
    fn each_condition_has_a_panel_and_each_method_a_line() {
        let records = records();
        let groups = groups(&records);
        for figure in Figure::ALL {
            let text = svg(figure, "Art", &groups).unwrap();
            for expected in ["mean of 2", "mean of 3", "none", "blur=2", "rotation=90", "Art: ", "kamencay"] {
                assert_eq!(text.matches(&format!("\n{expected}")).count(), 1, "{figure:?}: {expected}");
            }
            assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>") && text.len() < 60_000);
        }
    }

    #[test]
    fn thin_curves_keep_their_ends() {
        let curve: Vec<Sample> = (1..=1000).map(|k| Sample { k, x: k as f64 / 1_048_576.0, y: 0.5 }).collect();
        let axis = Axis::new(Figure::RecallPrecision, &[]);
        assert_eq!(thinned(&curve, &axis), [1.0, 1000.0].map(|k| (100.0 * k / 1_048_576.0, 50.0)));
        assert_eq!(thinned(&[], &axis), []);
    }

    #[test]
    fn only_whole_powers_are_named() {
        let axis = Axis { place: |sample| sample.x, ends: [-2.0, 2.0], logarithmic: true };
        assert_eq!([-2.0, 0.0, 0.5, 2.0].map(|at| axis.label(at)), ["0.01", "1", "", "100"]);
    }
}
