//! The head of a WGSL file: the shared parts that it imports, and the constants that Rust writes in front of the
//! module.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

use hsad::internals::Stage;

/// The shared parts: name and text.
type Parts = BTreeMap<String, String>;

fn shared_parts() -> Parts {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders/shared");
    let files = fs::read_dir(folder).expect("the folder of shared parts").map(|entry| entry.expect("an entry").path());
    files
        .map(|path| {
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            (name, fs::read_to_string(path).expect("a shared part"))
        })
        .collect()
}

fn imports(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter_map(|line| line.strip_prefix("#import "))
}

/// A text and its imports, direct and indirect.
fn with_imports<'a>(name: &'a str, text: &'a str, parts: &'a Parts) -> BTreeMap<&'a str, &'a str> {
    let mut texts = BTreeMap::from([(name, text)]);
    let mut left: Vec<_> = imports(text).collect();
    while let Some(name) = left.pop() {
        if texts.insert(name, &parts[name]).is_none() {
            left.extend(imports(&parts[name]));
        }
    }
    texts
}

/// The words of the code, which are names, keywords and numbers, without comments and imports.
fn words(text: &str) -> BTreeSet<&str> {
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.split("//").next())
        .flat_map(|code| code.split(|c: char| !c.is_alphanumeric() && c != '_'))
        .filter(|word| !word.is_empty())
        .collect()
}

/// The module-scope names that a text declares.
fn declared(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter_map(|line| ["fn ", "struct ", "const ", "alias "].iter().find_map(|keyword| line.strip_prefix(keyword)))
        .filter_map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next())
}

/// The constants that a head lists, one per line after `// Constants:`, as `//   NAME   meaning`; a line that is indented
/// further goes on with the meaning.
fn listed(text: &str) -> BTreeMap<&str, &str> {
    let list = text.lines().skip_while(|line| *line != "// Constants:").skip(1);
    list.map_while(|line| line.strip_prefix("//   "))
        .filter(|line| !line.starts_with(' '))
        .map(|line| line.split_once(' ').unwrap_or((line, "")))
        .map(|(name, meaning)| (name, meaning.trim()))
        .collect()
}

/// The unused imports of a text, and declarations that a shared part must not have.
fn import_mistakes(name: &str, text: &str, parts: &Parts) -> Vec<String> {
    let words = words(text);
    let mut mistakes: Vec<_> = imports(text)
        .filter(|import| !declared(&parts[*import]).any(|declared| words.contains(declared)))
        .map(|import| format!("{name} uses nothing of {import}"))
        .collect();
    if parts.contains_key(name) {
        mistakes.extend(
            ["compute", "binding"]
                .iter()
                .filter(|&word| words.contains(word))
                .map(|word| format!("{name} has @{word}, which belongs to the shaders that import it")),
        );
    }
    mistakes
}

/// The constants of a stage that a text uses and does not list, or lists and does not use, or that no text uses.
fn constant_mistakes(stage: &Stage, parts: &Parts) -> Vec<String> {
    let mut mistakes = Vec::new();
    let constants: BTreeSet<_> = stage.constants.iter().map(|(name, _)| *name).collect();
    let mut used_anywhere = BTreeSet::new();
    for (name, text) in with_imports(stage.name, stage.source, parts) {
        let words = words(text);
        let used: BTreeSet<_> = constants.intersection(&words).copied().collect();
        let listed = listed(text);
        for constant in used.iter().filter(|used| !listed.contains_key(**used)) {
            mistakes.push(format!("{name} does not list {constant}"));
        }
        for (constant, meaning) in listed {
            if !constants.contains(constant) {
                mistakes.push(format!("{name} lists {constant}, which Rust does not give {}", stage.name));
            } else if !used.contains(constant) {
                mistakes.push(format!("{name} lists {constant} and does not use it"));
            }
            if meaning.is_empty() {
                mistakes.push(format!("{name} does not say what {constant} means"));
            }
        }
        used_anywhere.extend(used);
    }
    mistakes.extend(constants.difference(&used_anywhere).map(|unused| format!("{} does not use {unused}", stage.name)));
    mistakes
}

#[test]
fn imports_are_needed() {
    let (stages, parts) = (hsad::internals::stages(), shared_parts());
    let shaders: BTreeMap<_, _> = stages.iter().map(|stage| (stage.source, stage.name)).collect();
    let texts = shaders.iter().map(|(text, name)| (*name, *text)).chain(parts.iter().map(|(n, t)| (&**n, &**t)));
    let mistakes: Vec<_> = texts.flat_map(|(name, text)| import_mistakes(name, text, &parts)).collect();
    assert!(mistakes.is_empty(), "{mistakes:#?}");
    let imported: BTreeSet<_> =
        shaders.iter().flat_map(|(text, name)| with_imports(name, text, &parts).into_keys()).collect();
    let of_none: Vec<_> = parts.keys().filter(|part| !imported.contains(&***part)).collect();
    assert!(of_none.is_empty(), "no shader imports {of_none:?}");
}

#[test]
fn constants_are_listed_and_used() {
    let parts = shared_parts();
    let mistakes: BTreeSet<_> =
        hsad::internals::stages().iter().flat_map(|stage| constant_mistakes(stage, &parts)).collect();
    assert!(mistakes.is_empty(), "{mistakes:#?}");
}

/// The checks themselves must be able to fail.
#[test]
fn mistakes_in_heads_are_seen() {
    let part = "// Constants:\n//   STEP   pixels\n//          to the next\n\nfn next(x: u32) -> u32 {\n    return x + STEP;\n}\n";
    let parts = Parts::from([("part".into(), part.into())]);
    let good = "// Constants:\n//   WIDTH   pixels\n\n#import part\n\nfn main() {\n    next(WIDTH); // OTHER\n}\n";
    let stage = |source: &str, constants: &[&'static str]| Stage {
        name: "stage",
        source: source.to_owned().leak(),
        bindings: &[],
        constants: constants.iter().map(|name| (*name, 1)).collect(),
    };
    let both = ["WIDTH", "STEP"];
    assert!(constant_mistakes(&stage(good, &both), &parts).is_empty());
    for (source, constants, mistake) in [
        (good.replace("//   WIDTH   pixels\n", ""), &both[..], "stage does not list WIDTH"),
        (good.replace("   pixels", ""), &both, "stage does not say what WIDTH means"),
        (good.replace("next(WIDTH)", "next(1)"), &both, "stage lists WIDTH and does not use it"),
        (good.into(), &both[..1], "part lists STEP, which Rust does not give stage"),
        (good.into(), &["WIDTH", "STEP", "OTHER"], "stage does not use OTHER"),
    ] {
        assert!(constant_mistakes(&stage(&source, constants), &parts).contains(&mistake.into()), "{mistake}");
    }
    assert!(import_mistakes("stage", good, &parts).is_empty());
    let unused = good.replace("next(", "last(");
    assert_eq!(import_mistakes("stage", &unused, &parts), ["stage uses nothing of part"]);
    let binding = format!("{part}@group(0) @binding(4) var<storage> words: array<u32>;\n");
    assert_eq!(import_mistakes("part", &binding, &parts).len(), 1);
    assert!(import_mistakes("stage", &binding, &parts).is_empty());
}
