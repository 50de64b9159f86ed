//! Wrong pixels among those that the confidences call sure.

use hsad::{Backend, Dense, Preset, disparity, eval::scene::Scene};

use crate::{
    AnyError, Named,
    markdown::{columns, heading, mean, percent, row},
    matched::matched,
};

/// Confidence from which a pixel is sure, of 255.
const SURE: u8 = 192;
/// Largest error of a right pixel, in pixels.
const RIGHT: f32 = 2.0;

pub fn print(backend: &Backend, scenes: &[Named]) -> Result<(), AnyError> {
    for preset in [Preset::Fast, Preset::Balanced] {
        of_preset(backend, scenes, preset)?;
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
    let mut shares: Vec<[f64; 4]> = Vec::new();
    for Named { name, scene } in scenes {
        eprintln!("{name}: confidence, {preset}");
        let dense = matched(backend, scene, &preset.config())?.outcome.dense;
        let figures = figures(scene, &dense);
        line(name, figures);
        shares.push(figures);
    }
    line("mean", [0, 1, 2, 3].map(|i| mean(shares.iter().map(|figures| figures[i]))));
    Ok(())
}

/// Shares of wrong pixels of all pixels with a disparity and known truth, of the surer half of these, and of those with a
/// confidence of at least [`SURE`]; then the share of the picture with such a confidence.
fn figures(scene: &Scene, dense: &Dense) -> [f64; 4] {
    let pixels = scene.truth.data().iter().zip(dense.disparity.data()).zip(dense.confidence.data());
    let mut judged: Vec<(u8, bool)> = pixels
        .filter(|((truth, _), _)| truth.is_finite())
        .filter_map(|((truth, &found), &sure)| Some((sure, (disparity::pixels(found)? - truth).abs() > RIGHT)))
        .collect();
    // Of equally confident pixels the wrong ones come first, so that ties never help.
    judged.sort_unstable_by(|a, b| b.cmp(a));
    let wrong = |pixels: &[(u8, bool)]| share(pixels, |(_, wrong)| *wrong);
    let sure = judged.iter().take_while(|(confidence, _)| *confidence >= SURE).count();
    [
        wrong(&judged),
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
        assert_eq!(figures(&scene, &dense), [2.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 5.0 / 8.0]);
    }
}
