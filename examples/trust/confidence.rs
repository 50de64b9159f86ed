//! Wrong pixels among those that the confidences call sure.

use hsad::{Backend, Dense, Preset, disparity, eval::scene::Scene};

use crate::{
    AnyError, Named,
    markdown::{columns, heading, mean, percent, row},
    matched::matched,
    variant::Variant,
};

/// Confidence from which a pixel is sure, of 255.
const SURE: u8 = 192;
/// Least confidences of the lines of the table by confidence; the largest is that of the line before the next.
const LEAST: [u16; 17] = [0, 1, 2, 4, 8, 10, 12, 14, 16, 56, 96, 128, 160, 192, 208, 224, 240];
/// Largest error of a right pixel, in pixels.
const RIGHT: f32 = 2.0;

pub fn print(backend: &Backend, scenes: &[Named]) -> Result<(), AnyError> {
    for preset in [Preset::Fast, Preset::Balanced] {
        of_preset(backend, scenes, preset)?;
    }
    of_blur(backend, scenes)
}

/// Prints one line per kind of blur: shares of wrong pixels in the maps that are trusted, their mean and the largest.
fn of_blur(backend: &Backend, scenes: &[Named]) -> Result<(), AnyError> {
    heading("Confidence of blurred views: preset `balanced`, maps of exit code 0, mean and largest");
    columns(&[
        "variant",
        "maps of exit code 0",
        "all pixels, %",
        "surer half, %",
        "confidence from 192, %",
        "confidence from 192: share of the picture, %",
    ]);
    for variant in Variant::of_blur() {
        let mut shares: Vec<[f64; 4]> = Vec::new();
        for Named { name, scene } in scenes {
            eprintln!("{name}: {}", variant.name());
            let (changed, config) = variant.of(scene, &scene.right)?;
            let found = matched(backend, &changed, &config)?;
            if found.exit_code == 0 {
                shares.push(figures(&judged(&changed, &found.outcome.dense), &found.outcome.dense));
            }
        }
        let part = |i: usize| shares.iter().map(move |figures| figures[i]);
        let cell = |i| format!("{}; {}", percent(mean(part(i))), percent(part(i).fold(0.0, f64::max)));
        row(&[variant.name(), shares.len().to_string(), cell(0), cell(1), cell(2), percent(mean(part(3)))]);
    }
    Ok(())
}

fn of_preset(backend: &Backend, scenes: &[Named], preset: Preset) -> Result<(), AnyError> {
    heading(&format!("Confidence: preset `{preset}`, wrong by over 2 px"));
    columns(&[
        "scene",
        "all pixels, %",
        "surer half, %",
        "confidence from 192, %",
        "confidence from 192: share of the picture, %",
    ]);
    let (mut shares, mut classes): (Vec<[f64; 4]>, Vec<[[f64; 2]; LEAST.len()]>) = (Vec::new(), Vec::new());
    for Named { name, scene } in scenes {
        eprintln!("{name}: confidence, {preset}");
        let dense = matched(backend, scene, &preset.config())?.outcome.dense;
        let judged = judged(scene, &dense);
        let figures = figures(&judged, &dense);
        line(name, figures);
        shares.push(figures);
        classes.push(by_confidence(&judged));
    }
    line("mean", [0, 1, 2, 3].map(|i| mean(shares.iter().map(|figures| figures[i]))));
    heading(&format!("By confidence: preset `{preset}`, mean of the scenes"));
    columns(&["confidence", "share of the map, %", "wrong by over 2 px, %"]);
    for (i, least) in LEAST.into_iter().enumerate() {
        let last = LEAST.get(i + 1).map_or(255, |next| next - 1);
        let [share, wrong] = [0, 1].map(|part| mean(classes.iter().map(|classes| classes[i][part])));
        let name = if least == last { least.to_string() } else { format!("{least} to {last}") };
        row(&[name, percent(share), percent(wrong / share)]);
    }
    Ok(())
}

/// Confidence of each pixel with a disparity and known truth, and whether it is wrong; the most confident first.
fn judged(scene: &Scene, dense: &Dense) -> Vec<(u8, bool)> {
    let pixels = scene.truth.data().iter().zip(dense.disparity.data()).zip(dense.confidence.data());
    let mut judged: Vec<(u8, bool)> = pixels
        .filter(|((truth, _), _)| truth.is_finite())
        .filter_map(|((truth, &found), &sure)| Some((sure, (disparity::pixels(found)? - truth).abs() > RIGHT)))
        .collect();
    // Of equally confident pixels the wrong ones come first, so that ties never help.
    judged.sort_unstable_by(|a, b| b.cmp(a));
    judged
}

/// Per line of the table by confidence: shares of the pixels, and of wrong ones, in all.
fn by_confidence(judged: &[(u8, bool)]) -> [[f64; 2]; LEAST.len()] {
    let class = |confidence: u8| LEAST.partition_point(|&least| least <= confidence.into()) - 1;
    let mut counts = [[0.0; 2]; LEAST.len()];
    for &(confidence, wrong) in judged {
        let [all, of_wrong] = &mut counts[class(confidence)];
        *all += 1.0;
        *of_wrong += f64::from(u8::from(wrong));
    }
    counts.map(|counts| counts.map(|count| count / judged.len() as f64))
}

/// Shares of wrong pixels of all `judged` pixels, of the surer half of these, and of those with a confidence of at least [`SURE`];
/// then the share of the picture with such a confidence.
fn figures(judged: &[(u8, bool)], dense: &Dense) -> [f64; 4] {
    let wrong = |pixels: &[(u8, bool)]| share(pixels, |(_, wrong)| *wrong);
    let sure = judged.iter().take_while(|(confidence, _)| *confidence >= SURE).count();
    [
        wrong(judged),
        wrong(&judged[..judged.len() / 2]),
        wrong(&judged[..sure]),
        share(dense.confidence.data(), |confidence| *confidence >= SURE),
    ]
}

fn share<T>(items: &[T], wanted: impl Fn(&T) -> bool) -> f64 {
    items.iter().filter(|item| wanted(item)).count() as f64 / items.len() as f64
}

fn line(name: &str, figures: [f64; 4]) {
    row(&[name.to_owned()].into_iter().chain(figures.map(percent)).collect::<Vec<_>>());
}

#[cfg(test)]
mod tests {
    use hsad::{
        Picture,
        dense::View,
        disparity::{NONE, SCALE},
        image::Plane,
    };

    use super::*;

    #[test]
    fn figures_by_hand() {
        // Of eight pixels, one has no disparity and one no truth; of the other six, the pixels of 200 and 100 are wrong.
        let plane = |values: [i32; 8]| Plane::new((8, 1), values.to_vec()).unwrap();
        let found = [10, 10, NONE, 10, 13, 10, 13, 10].map(|px| if px == NONE { NONE } else { px * SCALE });
        let confidence = Plane::new((8, 1), vec![255, 192, 255, 191, 200, 250, 100, 0]).unwrap();
        let mut truth = Plane::filled((8, 1), 10.0);
        truth.set(5, 0, f32::INFINITY);
        let picture = Picture::filled((8, 1), [0; 4]);
        let scene = Scene { left: picture.clone(), right: picture, reference: View::Left, truth, non_occluded: None };
        let dense = Dense { disparity: plane(found), confidence };
        // All: 2 of 6. The surer half: 255, 200 (wrong), 192. From 192: the same; 5 of 8 pixels have such a confidence.
        let judged = judged(&scene, &dense);
        assert_eq!(figures(&judged, &dense), [2.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 5.0 / 8.0]);
        let classes = by_confidence(&judged);
        // 0; 100; 191 and 192; 200; 255. Wrong: 100 and 200.
        assert_eq!(
            [0, 10, 12, 13, 16].map(|line| classes[line].map(|share| (6.0 * share).round())),
            [[1.0, 0.0], [1.0, 1.0], [1.0, 0.0], [2.0, 1.0], [1.0, 0.0]]
        );
    }
}
