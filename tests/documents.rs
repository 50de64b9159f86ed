//! The pages name files that exist.

use std::{fs, path::Path};

/// Pages, and the folders whose files they name.
const PAGES: [&str; 14] = [
    "README.md",
    "CONTRIBUTING.md",
    "docs/ARCHITECTURE.md",
    "docs/benchmarks.md",
    "docs/calibration.md",
    "docs/cli.md",
    "docs/embedding.md",
    "docs/evaluation.md",
    "docs/python.md",
    "docs/rectification.md",
    "docs/results.md",
    "docs/trust.md",
    "docs/verify.md",
    "examples/README.md",
];
const FOLDERS: [&str; 8] = ["src/", "python/", "shaders/", "tests/", "docs/", "examples/", "data/", "benches/"];

/// The paths that a page names: between backticks, and as targets of links, relative to the page.
fn named(page: &str, text: &str) -> Vec<String> {
    let folder = Path::new(page).parent().unwrap();
    let quoted =
        text.split('`').skip(1).step_by(2).filter(|code| FOLDERS.iter().any(|folder| code.starts_with(folder)));
    // Placeholders and patterns name no file.
    let quoted = quoted.filter(|code| !code.contains(['<', '*', ' ', '{'])).map(str::to_owned);
    let links = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    let links = links.filter(|link| !link.is_empty() && !link.contains(':'));
    quoted.chain(links.map(|link| folder.join(link).to_str().unwrap().to_owned())).collect()
}

fn missing(page: &str, text: &str) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    named(page, text).into_iter().filter(|path| !root.join(path).exists()).collect()
}

#[test]
fn every_named_file_exists() {
    for page in PAGES {
        let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(page)).unwrap();
        assert_eq!(missing(page, &text), [""; 0], "{page}");
        assert!(page == "docs/results.md" || !named(page, &text).is_empty(), "{page} names nothing");
    }
}

#[test]
fn a_missing_file_is_seen() {
    let text =
        "`src/lib.rs`, `src/gone.rs`, `src/<room>/`, [x](../src/lib.rs#a), [y](../none.md), [z](https://example.org)";
    assert_eq!(missing("docs/page.md", text), ["src/gone.rs", "docs/../none.md"]);
}
