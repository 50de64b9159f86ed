//! Trust against the share of the map that is wrong.

use hsad::{Backend, pipeline::TRUSTED};

use crate::{
    AnyError, Named,
    markdown::{columns, heading, percent, row},
    matched::matched,
    scores,
    variant::Variant,
};

/// Shares of wrong pixels above which a map must not be trusted, and below which it must be, 0 to 1.
const MOST_WRONG: f64 = 0.3;
const FEW_WRONG: f64 = 0.1;

/// A map of a variant.
struct Map {
    variant: String,
    scene: String,
    /// Share of the map's pixels with known truth that are wrong by over 2 px, 0 to 1; NaN without such pixels.
    wrong: f64,
    trust: f32,
    exit_code: u8,
    /// Share of the picture with a measured disparity, 0 to 1.
    measured: f64,
}

impl Map {
    fn cells(&self) -> [String; 6] {
        let Self { variant, scene, wrong, trust, exit_code, measured } = self;
        [
            variant.clone(),
            scene.clone(),
            percent(*wrong),
            format!("{trust:.3}"),
            exit_code.to_string(),
            percent(*measured),
        ]
    }
}

pub fn print(backend: &Backend, scenes: &[Named]) -> Result<(), AnyError> {
    let mut maps = Vec::new();
    for (index, Named { name, scene }) in scenes.iter().enumerate() {
        // The scene half the list away: neighbours in the list can be takes of one scene.
        let other = &scenes[(index + scenes.len() / 2) % scenes.len()].scene.right;
        for variant in Variant::all(scenes.len() > 1) {
            eprintln!("{name}: {}", variant.name());
            let (changed, config) = variant.of(scene, other)?;
            let found = matched(backend, &changed, &config)?;
            maps.push(Map {
                variant: variant.name(),
                scene: name.clone(),
                wrong: scores::wrong(&changed, &found.outcome.dense)?,
                trust: found.outcome.trust,
                exit_code: found.exit_code,
                measured: found.outcome.dense.measured(),
            });
        }
    }
    maps.sort_by(|a, b| b.wrong.total_cmp(&a.wrong));
    heading("Trust");
    list(maps.iter());
    heading("Trust by variant");
    by_variant(&maps);
    promises(&maps);
    Ok(())
}

/// Prints one line per variant: least and largest figures of its maps, the most wrong variant first.
fn by_variant(maps: &[Map]) {
    let mut variants: Vec<&str> = Vec::new();
    for map in maps {
        if !variants.contains(&map.variant.as_str()) {
            variants.push(&map.variant);
        }
    }
    columns(&["variant", "wrong by over 2 px, %", "trust", "maps of exit code 0", "of 3", "of 4"]);
    for variant in variants {
        let of_variant = || maps.iter().filter(|map| map.variant == variant);
        let [least, most] = ends(of_variant().map(|map| map.wrong)).map(percent);
        let [low, high] = ends(of_variant().map(|map| map.trust.into()));
        let count = |code| of_variant().filter(|map| map.exit_code == code).count().to_string();
        let [wrong, trust] = [format!("{least} to {most}"), format!("{low:.3} to {high:.3}")];
        row(&[variant.into(), wrong, trust, count(0), count(3), count(4)]);
    }
}

/// The smallest and the largest value.
fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)])
}

/// Prints the maps that break a promise of trust.
fn promises(maps: &[Map]) {
    let most_wrong = |map: &Map| map.wrong > MOST_WRONG;
    let few_wrong = |map: &Map| map.wrong < FEW_WRONG;
    let refused = maps.iter().filter(|map| map.exit_code == 3).count();
    println!("\n{} maps, {refused} of them of pairs that are refused without `--force`.", maps.len());
    type Test<'t> = &'t dyn Fn(&Map) -> bool;
    let promises: [(&str, Test, Test); 2] = [
        ("over 30 % wrong with a trust of at least 0.5", &most_wrong, &|map| map.trust >= TRUSTED),
        ("under 10 % wrong with a trust below 0.5", &few_wrong, &|map| map.trust < TRUSTED),
    ];
    for (text, applies, is_broken) in promises {
        let all = maps.iter().filter(|map| applies(map)).count();
        let broken: Vec<&Map> = maps.iter().filter(|map| applies(map) && is_broken(map)).collect();
        println!("\nMaps {text}: {} of {all}.", broken.len());
        if !broken.is_empty() {
            println!();
            list(broken);
        }
    }
}

fn list<'m>(maps: impl IntoIterator<Item = &'m Map>) {
    columns(&["variant", "scene", "wrong by over 2 px, %", "trust", "exit code", "measured, %"]);
    maps.into_iter().for_each(|map| row(&map.cells()));
}
