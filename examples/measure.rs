//! Figures that `hsad eval dense` does not give, for judging a change: plain block matching over the true range,
//! quality of the confidence and of the disparity range found, and precision of the matches.
//!
//! `cargo run --example measure -- [SCENE...]`, with a `SCENE` as for `hsad eval dense`; scenes without a non-occlusion
//! mask are left out. The default is the scenes of `data/`.
#![expect(clippy::print_stdout, reason = "a measurement prints")]

use std::path::Path;

use hsad::{
    Backend, Pair,
    config::{Config, Method, Preset},
    dense::{Aggregation, Dense, DenseConfig, DenseParameters, Search, View},
    disparity::{self, DisparityRange, SCALE},
    eval::scene::{self, SceneFiles},
    features::Feature,
    gpu::{DeviceChoice, block_on},
    image::Size,
    internals::{cpu, dense::CellBand},
    kamencay::KamencayParameters,
    matching::{MatchConfig, Rows, Seed, match_features, refine},
    pipeline,
};

type AnyError = Box<dyn std::error::Error>;

struct Scene {
    name: String,
    data: scene::Scene,
}

impl Scene {
    /// The known disparities of the ground truth, in pixels.
    fn known(&self) -> impl Iterator<Item = f32> {
        self.data.truth.data().iter().copied().filter(|disparity| disparity.is_finite())
    }

    /// Per cent of wrong pixels (error above 2 px) among the more confident half of the pixels with ground truth.
    fn confident(&self, dense: &Dense) -> f64 {
        let known = self.data.truth.data().iter().zip(dense.disparity.data()).zip(dense.confidence.data());
        let mut pixels: Vec<(u8, bool)> = known
            .filter(|((truth, _), _)| truth.is_finite())
            .map(|((truth, &d), &confidence)| (confidence, (d as f32 / SCALE as f32 - truth).abs() > 2.0))
            .collect();
        // Among equally confident pixels the wrong ones come first, so that ties never help.
        pixels.sort_unstable_by(|a, b| b.cmp(a));
        pixels.truncate(pixels.len() / 2);
        100.0 * pixels.iter().filter(|(_, wrong)| *wrong).count() as f64 / pixels.len() as f64
    }

    /// Whether a seed lies within 1 px of the ground truth, in column and row; `None` where that is unknown.
    fn is_right(&self, seed: &Seed) -> Option<bool> {
        let Size { width, height } = self.data.truth.size();
        let (x, y) = (seed.x.round(), seed.y.round());
        if x < 0.0 || y < 0.0 || x >= width as f32 || y >= height as f32 {
            return None;
        }
        let truth = self.data.truth.get(x as u32, y as u32);
        truth.is_finite().then(|| (seed.disparity - truth).abs() <= 1.0 && seed.dy.abs() <= 1.0)
    }

    /// Number of matches, and their precision in per cent: of all, and of the first 10, 100 and 500.
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
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.is_empty() {
        arguments.push("data".into());
    }
    let mut scenes = Vec::new();
    for argument in &arguments {
        for files in SceneFiles::find(Path::new(argument))? {
            let data = files.read(View::Left)?;
            if data.non_occluded.is_some() {
                scenes.push(Scene { name: files.name, data });
            }
        }
    }
    let backend = Backend::open(&DeviceChoice::Best)?;
    println!("on {}", backend.name());

    let columns = ["non-occ", "all", "est n-o", "est all", "covered"];
    table("7x7 SAD, winner-take-all, from 0 to the truth's largest, in whole sixteens", &columns, &scenes, |scene| {
        let largest = scene.known().fold(0.0, f32::max);
        let config = DenseConfig::new(DisparityRange::new(0, (largest as u32 + 1).next_multiple_of(16))?);
        let dense =
            block_on(async { Pair::new(&backend, &scene.data.left, &scene.data.right).await?.dense(&config).await })?;
        let scores = scene.data.score(&disparity::in_pixels(&dense.disparity))?;
        let visible = scores.non_occluded.ok_or("no mask")?.bad[1];
        let all = scores.all.bad[1];
        let shares = [visible.of_known, all.of_known, visible.of_estimated, all.of_estimated, scores.all.coverage()];
        Ok(shares.map(|share| 100.0 * share))
    })?;
    let kamencay = Method::Kamencay(KamencayParameters::default());
    for (name, config) in [
        ("preset fast", Preset::Fast.config()),
        ("preset balanced", Preset::Balanced.config()),
        ("preset quality", Preset::Quality.config()),
        ("method kamencay", Config { method: kamencay, ..Preset::Balanced.config() }),
    ] {
        let columns = ["from px", "to px", "inside", "half bad"];
        table(&format!("{name}, the range found"), &columns, &scenes, |scene| {
            let views = (&scene.data.left, &scene.data.right);
            let outcome = pipeline::run(&backend, views, &config, |_| ())?;
            let range = outcome.range;
            let inside = scene.known().filter(|d| range.contains(d.round() as i32)).count();
            let share = 100.0 * inside as f64 / scene.known().count() as f64;
            Ok([range.min.into(), range.last().into(), share, scene.confident(&outcome.dense)])
        })?;
    }
    let columns = ["searched", "non-occ", "all", "whole n-o", "whole all"];
    table("preset Fast, coarse to fine, and over the whole range", &columns, &scenes, |scene| {
        let views = (&scene.data.left, &scene.data.right);
        let coarse = Preset::Fast.dense_parameters();
        let whole = match coarse.aggregation {
            Aggregation::Sad { side, compared, .. } => Aggregation::Sad { side, search: Search::Whole, compared },
            costs => costs,
        };
        let mut figures = [0.0; 5];
        for (i, parameters) in [coarse, DenseParameters { aggregation: whole, ..coarse }].into_iter().enumerate() {
            let config = Config { method: Method::Hsad(parameters), ..Preset::Fast.config() };
            let outcome = pipeline::run(&backend, views, &config, |_| ())?;
            if i == 0 {
                let brightness = outcome.brightness;
                let config = DenseConfig { brightness, ..Preset::Fast.dense_config(outcome.range) };
                figures[0] = searched(&block_on(Pair::new(&backend, views.0, views.1))?, &config)?;
            }
            let scores = scene.data.score(&disparity::in_pixels(&outcome.dense.disparity))?;
            let visible = scores.non_occluded.ok_or("no mask")?.bad[1];
            figures[2 * i + 1] = 100.0 * visible.of_known;
            figures[2 * i + 2] = 100.0 * scores.all.bad[1].of_known;
        }
        Ok(figures)
    })?;
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
            let pair = block_on(Pair::new(&backend, &scene.data.left, &scene.data.right))?;
            let features = block_on(pair.features(&Preset::Balanced.config().features))?;
            Ok(scene.right(&seeds(&pair, &features.map(|view| view.features))?))
        })?;
    }
    println!(
        "\nper cent; searched: pixel-disparities, those at half the size among them, of those of the whole range; wrong: by more than 1 px; inside: of the truth, in the range; half bad: of the more confident half, \
         wrong by over 2 px; right: by at most 1 px"
    );
    Ok(())
}

/// Share of the pixel-disparities that a search of the whole range visits that a coarse-to-fine search visits, in per cent:
/// those of the cells, and each searched view at half the size; computed by the CPU twins.
fn searched(pair: &Pair, config: &DenseConfig) -> Result<f64, AnyError> {
    let (size, range) = (pair.size(), config.range);
    let plain = |parameters: &mut DenseParameters| {
        parameters.consistency = None;
        parameters.agreement = 0;
        if let Aggregation::Sad { search, .. } = &mut parameters.aggregation {
            *search = Search::Whole;
        }
    };
    let half =
        DenseConfig { range: CellBand::new(size, (0, size.height), range).map_range, ..config.clone().with(plain) };
    let map = block_on(async { pair.reduced(2).await?.dense(&half).await })?.disparity;
    let ranges = cpu::dense::cell_ranges(&map, size, range);
    let share = |cells: &cpu::dense::CellPlane| {
        let counts = cells.data().iter().map(|&(_, count)| f64::from(count) / f64::from(range.count));
        counts.sum::<f64>() / cells.data().len() as f64
    };
    let views = if config.parameters.consistency.is_some() { 2.0 } else { 1.0 };
    Ok(100.0 * (share(&ranges) + views / 8.0) / views)
}

/// Prints one row of figures per scene, and their means.
fn table<const N: usize>(
    title: &str,
    columns: &[&str; N],
    scenes: &[Scene],
    mut figures: impl FnMut(&Scene) -> Result<[f64; N], AnyError>,
) -> Result<(), AnyError> {
    println!("\n{title}\n{:24}{}", "", columns.map(|column| format!("{column:>9}")).concat());
    let mut sums = [0.0; N];
    let row = |name: &str, figures: [f64; N]| {
        println!("{name:24}{}", figures.map(|figure| format!("{figure:9.2}")).concat());
    };
    for scene in scenes {
        let figures = figures(scene)?;
        sums.iter_mut().zip(figures).for_each(|(sum, figure)| *sum += figure);
        row(&scene.name, figures);
    }
    row("mean", sums.map(|sum| sum / scenes.len() as f64));
    Ok(())
}
