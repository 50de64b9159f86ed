//! The figures of a change, on scenes with known truth: dense error and the share of matches that are right.
//!
//! `cargo run --example measure -- FOLDER [SCENE...]`, where `FOLDER/SCENE/` holds `left.png`, `right.png`,
//! `disp_left.pfm` and `nonocc.png` as `data/` does.
#![expect(clippy::print_stdout, reason = "a measurement prints")]

use std::path::{Path, PathBuf};

use hsad::{
    config::{Config, Method, Preset},
    dense::{Dense, DenseConfig},
    disparity::{DisparityMap, DisparityRange, SCALE},
    eval::score,
    features::Feature,
    gpu::DeviceChoice,
    hybrid::HybridParameters,
    image::Plane,
    io::{Picture, load, pfm},
    matching::{MatchConfig, Rows, Seed, match_features, refine},
    pair::{Backend, Pair},
    pipeline,
};

type AnyError = Box<dyn std::error::Error>;

struct Scene {
    name: String,
    left: Picture,
    right: Picture,
    truth: Plane<f32>,
    visible: Plane<u8>,
}

impl Scene {
    fn read(folder: &Path) -> Result<Self, AnyError> {
        let file = |name: &str| folder.join(name);
        Ok(Self {
            name: folder.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            left: load::load(&file("left.png"))?,
            right: load::load(&file("right.png"))?,
            truth: pfm::read(&file("disp_left.pfm"))?,
            visible: load::load(&file("nonocc.png"))?.luma(),
        })
    }

    /// Wrong pixels in per cent: non-occluded and all, of all known; the same of those estimated; estimated ones.
    fn bad(&self, map: &DisparityMap) -> Result<[f64; 5], AnyError> {
        let visible = score(map, &self.truth, Some(&self.visible), &[1.0])?;
        let all = score(map, &self.truth, None, &[1.0])?;
        let shares = [
            visible.bad[0].of_known,
            all.bad[0].of_known,
            visible.bad[0].of_estimated,
            all.bad[0].of_estimated,
            all.coverage(),
        ];
        Ok(shares.map(|share| 100.0 * share))
    }

    /// Per cent of pixels that are wrong by more than 2 px among the more confident half of all that are known.
    fn confident(&self, dense: &Dense) -> f64 {
        let known = self.truth.data().iter().zip(dense.disparity.data()).zip(dense.confidence.data());
        let mut pixels: Vec<(u8, bool)> = known
            .filter(|((truth, _), _)| truth.is_finite())
            .map(|((truth, &d), &confidence)| (confidence, (d as f32 / SCALE as f32 - truth).abs() > 2.0))
            .collect();
        // Of equal confidence the wrong ones first, so that nothing is gained by a tie.
        pixels.sort_unstable_by(|a, b| b.cmp(a));
        pixels.truncate(pixels.len() / 2);
        100.0 * pixels.iter().filter(|(_, wrong)| *wrong).count() as f64 / pixels.len() as f64
    }

    /// Whether a seed lies within 1 px of the truth, in its column and in its row; `None` where that is not known.
    fn is_right(&self, seed: &Seed) -> Option<bool> {
        let (width, height) = self.truth.size();
        let (x, y) = (seed.x.round(), seed.y.round());
        if x < 0.0 || y < 0.0 || x >= width as f32 || y >= height as f32 {
            return None;
        }
        let truth = self.truth.get(x as u32, y as u32);
        truth.is_finite().then(|| (seed.disparity - truth).abs() <= 1.0 && seed.dy.abs() <= 1.0)
    }

    /// Matches, and the right ones in per cent: of all, of the first 10, 100 and 500.
    fn right(&self, seeds: &[Seed]) -> [f64; 5] {
        let known: Vec<bool> = seeds.iter().filter_map(|seed| self.is_right(seed)).collect();
        let share = |count: usize| {
            let first = &known[..known.len().min(count)];
            100.0 * first.iter().filter(|&&right| right).count() as f64 / first.len() as f64
        };
        [known.len() as f64, share(known.len()), share(10), share(100), share(500)]
    }
}

fn main() -> Result<(), AnyError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = arguments.first().map_or_else(|| PathBuf::from("data"), PathBuf::from);
    let mut names = arguments.get(1..).unwrap_or_default().to_vec();
    if names.is_empty() {
        for entry in folder.read_dir()? {
            let entry = entry?;
            if entry.path().join("nonocc.png").is_file() {
                names.push(entry.file_name().to_string_lossy().into_owned());
            }
        }
        names.sort();
    }
    let scenes = names.iter().map(|name| Scene::read(&folder.join(name))).collect::<Result<Vec<_>, _>>()?;
    let backend = Backend::open(&DeviceChoice::Best)?;
    println!("on {}", backend.name());

    table("7x7 SAD, winner-take-all, from 0 to the truth's largest, in whole sixteens", &DENSE, &scenes, |scene| {
        let largest = scene.truth.data().iter().filter(|d| d.is_finite()).fold(0.0_f32, |a, &b| a.max(b));
        let config = DenseConfig::new(DisparityRange::new(0, (largest as u32 + 1).next_multiple_of(16))?);
        let dense = Pair::new(&backend, &scene.left, &scene.right)?.dense(&config)?;
        scene.bad(&dense.disparity)
    })?;
    let hybrid = Method::Kamencay(HybridParameters::default());
    for (name, config) in [
        ("preset fast", Preset::Fast.config()),
        ("preset balanced", Preset::Balanced.config()),
        ("preset quality", Preset::Quality.config()),
        ("method kamencay", Config { method: hybrid, ..Preset::Balanced.config() }),
    ] {
        table(&format!("{name}, the range found"), &DENSE, &scenes, |scene| {
            let outcome = pipeline::run(&backend, (&scene.left, &scene.right), &config, |_| ())?;
            let known = scene.truth.data().iter().filter(|d| d.is_finite()).collect::<Vec<_>>();
            let inside = known.iter().filter(|d| outcome.range.contains(d.round() as i32)).count();
            println!(
                "  {} to {} px, which {:.2} % of the truth lie in; {:.2} % of the more confident half wrong by over 2 px",
                outcome.range.min,
                outcome.range.last(),
                100.0 * inside as f64 / known.len() as f64,
                scene.confident(&outcome.dense)
            );
            scene.bad(&outcome.dense.disparity)
        })?;
    }
    type Seeds = fn(&Pair, &[Vec<Feature>; 2]) -> Result<Vec<Seed>, AnyError>;
    let kinds: [(&str, Seeds); 2] = [
        ("matches as they are, any row", |_, [left, right]| {
            let matches = match_features(left, right, &MatchConfig::default())?;
            Ok(matches.iter().map(|found| Seed::from_match(left, right, found)).collect())
        }),
        ("the same, refined along their rows", |pair, [left, right]| {
            let matches = match_features(left, right, &MatchConfig::default())?;
            Ok(refine(pair.views(), (left, right), &matches, Rows::Matched))
        }),
    ];
    for (title, seeds) in kinds {
        table(title, &["matches", "all", "of 10", "of 100", "of 500"], &scenes, |scene| {
            let pair = Pair::new(&backend, &scene.left, &scene.right)?;
            let features = pair.features(&Preset::Balanced.config().features)?;
            Ok(scene.right(&seeds(&pair, &features)?))
        })?;
    }
    println!("\nper cent; wrong: by more than 1 px; right: by at most 1 px; disparities in 1/{SCALE} px");
    Ok(())
}

const DENSE: [&str; 5] = ["non-occ", "all", "est n-o", "est all", "covered"];

/// Prints a row of figures a scene, and their means.
fn table(
    title: &str,
    columns: &[&str; 5],
    scenes: &[Scene],
    mut figures: impl FnMut(&Scene) -> Result<[f64; 5], AnyError>,
) -> Result<(), AnyError> {
    println!("\n{title}\n{:24}{}", "", columns.map(|column| format!("{column:>9}")).concat());
    let mut sums = [0.0; 5];
    let row = |name: &str, figures: [f64; 5]| {
        println!("{name:24}{}", figures.map(|figure| format!("{figure:9.1}")).concat());
    };
    for scene in scenes {
        let figures = figures(scene)?;
        sums.iter_mut().zip(figures).for_each(|(sum, figure)| *sum += figure);
        row(&scene.name, figures);
    }
    row("mean", sums.map(|sum| sum / scenes.len() as f64));
    Ok(())
}
