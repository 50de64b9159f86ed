//! Imports: shared WGSL, put in front of a shader before compilation.
//!
//! A line `#import line` in a shader or in a shared part includes `shaders/shared/line.wgsl`. Each part is included
//! once, in the order of first mention, behind the parts that it imports itself.

/// The table of shared parts: their names and texts.
macro_rules! parts {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../shaders/shared/", $name, ".wgsl")))),*]
    };
}

const PARTS: &[(&str, &str)] = parts![
    "bitmap_rows",
    "block_search",
    "brightness",
    "catmull_rom",
    "cell_layout",
    "census_bits",
    "consistent",
    "edges",
    "edges_of_costs",
    "exchange_memory",
    "exchange_subgroups",
    "floor_div",
    "haar",
    "halving",
    "keypoint",
    "lane_words_1",
    "lane_words_2",
    "lane_words_4",
    "line",
    "luma_words",
    "map_fixed_point",
    "map_pixels",
    "path_step",
    "pixel_cost",
    "point_rule",
    "quotient",
    "selection",
    "support_rule",
    "texel_bytes",
    "warp_map",
    "whole_layout",
    "words",
];

/// Puts the shared parts that `source` imports in front of it.
///
/// # Panics
/// If a part is unknown, or part of an import cycle: all shaders are ours, and a test covers them.
pub(crate) fn imported(source: &str) -> String {
    imported_from(PARTS, source)
}

fn imported_from(parts: &[(&str, &str)], source: &str) -> String {
    let mut out = String::new();
    append(parts, source, &mut Vec::new(), &mut Vec::new(), &mut out);
    out
}

/// Appends the imports of `source` that are not in `done`, then `source` itself. `chain` holds the imports that led
/// here.
fn append<'a>(
    parts: &[(&str, &'a str)],
    source: &'a str,
    chain: &mut Vec<&'a str>,
    done: &mut Vec<&'a str>,
    out: &mut String,
) {
    for name in source.lines().filter_map(import_of) {
        assert!(!chain.contains(&name), "shared parts import each other: {} -> {name}", chain.join(" -> "));
        if done.contains(&name) {
            continue;
        }
        let part = parts.iter().find(|part| part.0 == name).map(|part| part.1);
        let part =
            part.unwrap_or_else(|| panic!("no shared part {name}: shaders/shared/{name}.wgsl, in src/gpu/imports.rs"));
        chain.push(name);
        append(parts, part, chain, done, out);
        chain.pop();
        done.push(name);
        out.push('\n');
    }
    for line in source.split_inclusive('\n').filter(|line| import_of(line).is_none()) {
        out.push_str(line);
    }
}

/// The shared part that `line` imports, if any.
fn import_of(line: &str) -> Option<&str> {
    line.strip_prefix("#import ").map(str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOME: &[(&str, &str)] = &[
        ("a", "// a\n"),
        ("b", "#import a\n// b\n"),
        ("c", "// c\n#import b\n"),
        ("round", "#import about\n"),
        ("about", "#import round\n"),
    ];

    #[test]
    fn each_part_comes_once_and_behind_its_own_imports() {
        let lines = |source| {
            let text = imported_from(SOME, source);
            text.lines().filter(|line| !line.is_empty()).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(lines("#import c\n#import a\nmain\n"), ["// a", "// b", "// c", "main"]);
        assert_eq!(lines("head\n#import a\n#import b\nmain\n"), ["// a", "// b", "head", "main"]);
    }

    #[test]
    fn a_text_without_imports_stays() {
        let source = "// Not a line of its own: #import a\nfn main() {}\n";
        assert_eq!(imported_from(SOME, source), source);
    }

    #[test]
    #[should_panic(expected = "no shared part d")]
    fn an_unknown_part_is_a_mistake() {
        imported_from(SOME, "#import d\n");
    }

    #[test]
    #[should_panic(expected = "shared parts import each other: round -> about -> round")]
    fn a_cycle_is_a_mistake() {
        imported_from(SOME, "#import round\n");
    }

    #[test]
    fn the_table_holds_the_folder() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/shared");
        let mut names: Vec<_> = std::fs::read_dir(folder)
            .expect("the folder of shared parts")
            .map(|entry| entry.expect("an entry").file_name().into_string().expect("a name in ASCII"))
            .collect();
        names.sort();
        assert_eq!(names, PARTS.iter().map(|(name, _)| format!("{name}.wgsl")).collect::<Vec<_>>());
    }
}
