//! Wrong pixels with the disparity range found and with the range told.

use hsad::{Backend, Config, Preset};

use crate::{
    AnyError, Named,
    markdown::{columns, heading, mean, percent, row},
    matched::matched,
    scores,
};

pub fn print(backend: &Backend, scenes: &[Named]) -> Result<(), AnyError> {
    for preset in [Preset::Fast, Preset::Balanced, Preset::Quality] {
        heading(&format!("Ranges: preset `{preset}`, wrong by over 1 px or without disparity"));
        columns(&[
            "scene",
            "range of the truth, px",
            "range found, px",
            "truth outside, %",
            "found: non-occluded, %",
            "told: non-occluded, %",
            "found: all, %",
            "told: all, %",
        ]);
        let mut shares: Vec<[f64; 5]> = Vec::new();
        for Named { name, scene } in scenes {
            eprintln!("{name}: {preset}");
            let known = scores::known(scene);
            let truth = scores::range(&known)?;
            let config = preset.config();
            let found = matched(backend, scene, &config)?.outcome;
            let told = matched(backend, scene, &Config { range: Some(truth), ..config })?.outcome;
            let searched = found.range;
            let inside = |disparity: f32| (searched.min as f32..=searched.last() as f32).contains(&disparity);
            let outside = known.iter().filter(|&&disparity| !inside(disparity)).count() as f64 / known.len() as f64;
            let [by_found, by_told] = [scores::bad_one(scene, &found.dense)?, scores::bad_one(scene, &told.dense)?];
            let figures = [outside, by_found.non_occluded, by_told.non_occluded, by_found.all, by_told.all];
            let ranges = [truth, searched].map(|range| format!("{} to {}", range.min, range.last()));
            line(name, ranges, figures);
            shares.push(figures);
        }
        let dashes = ["-", "-"].map(str::to_owned);
        line("mean", dashes, [0, 1, 2, 3, 4].map(|i| mean(shares.iter().map(|figures| figures[i]))));
    }
    Ok(())
}

fn line(name: &str, ranges: [String; 2], [outside, bad @ ..]: [f64; 5]) {
    let start = [name.to_owned()].into_iter().chain(ranges).chain([format!("{:.2}", 100.0 * outside)]);
    row(&start.chain(bad.map(percent)).collect::<Vec<_>>());
}
