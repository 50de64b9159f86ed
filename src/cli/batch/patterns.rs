//! Pairs from two patterns: files whose paths differ from the pattern's in what `*` stands for.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail};
use hsad::shown;

use super::{
    listing::{Listing, is_hidden},
    pair::Pair,
};

/// The pairs of the files that both patterns match with the same text in place of `*`, which is the pair's name; sorted by it, whole
/// numbers by their value.
///
/// # Errors
/// A pattern without exactly one `*`, a folder that cannot be read, and no pair at all.
pub fn pairs(left: &str, right: &str) -> Result<Listing> {
    let (lefts, mut rights) = (matches(left)?, matches(right)?);
    for (pattern, files) in [(left, &lefts), (right, &rights)] {
        check_any(pattern, files)?;
    }
    let mut listing = Listing::default();
    for (name, left) in lefts {
        match rights.remove(&name) {
            Some(right) => listing.pairs.push(Pair { name: name.1, left, right: Some(right), calibration: None }),
            None => listing.alone[0].push(left),
        }
    }
    listing.alone[1].extend(rights.into_values());
    if let (true, Some(alone)) = (listing.pairs.is_empty(), listing.left_out()) {
        bail!("no pairs: no text in place of * gives files of both patterns; {alone}");
    }
    Ok(listing)
}

/// The pairs of the pictures that the pattern matches, each of which has both views; sorted as [`pairs`] are.
///
/// # Errors
/// A pattern without exactly one `*`, a folder that cannot be read, and no file at all.
pub fn pictures_of_both(pattern: &str) -> Result<Vec<Pair>> {
    let pictures = matches(pattern)?;
    check_any(pattern, &pictures)?;
    let pair = |((_, name), file)| Pair { name, left: file, right: None, calibration: None };
    Ok(pictures.into_iter().map(pair).collect())
}

fn check_any(pattern: &str, files: &BTreeMap<Name, PathBuf>) -> Result<()> {
    if files.is_empty() { bail!("no file matches {}", shown(Path::new(pattern))) } else { Ok(()) }
}

/// What `*` stands for, behind its digits as a number: texts with numbers are sorted by them.
type Name = (u128, String);

/// The files that match a pattern; hidden ones only if the pattern names them so.
fn matches(pattern: &str) -> Result<BTreeMap<Name, PathBuf>> {
    let [before, after] = pattern.split('*').collect::<Vec<_>>()[..] else {
        bail!("a pattern has one * in it: '{}' has not", shown(Path::new(pattern)));
    };
    let (folder, prefix) = before.rsplit_once('/').map_or(("", before), |(folder, prefix)| (folder, prefix));
    let folder = if before.starts_with('/') && folder.is_empty() { "/" } else { folder };
    let (suffix, below) = after.split_once('/').map_or((after, None), |(suffix, below)| (suffix, Some(below)));
    let read = if folder.is_empty() { Path::new(".") } else { Path::new(folder) };
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(read).with_context(|| shown(read))? {
        let entry = entry.with_context(|| shown(read))?.file_name();
        let Some(name) = entry.to_str().and_then(|name| name.strip_prefix(prefix)?.strip_suffix(suffix)) else {
            continue;
        };
        if is_hidden(&entry) && !prefix.starts_with('.') {
            continue;
        }
        let file = Path::new(folder).join(&entry);
        let file = below.map_or(file.clone(), |below| file.join(below));
        if !name.is_empty() && file.is_file() {
            let digits: String = name.chars().filter(char::is_ascii_digit).collect();
            found.insert((digits.parse().unwrap_or(u128::MAX), name.to_owned()), file);
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        for file in files {
            let file = folder.path().join(file);
            fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
            fs::write(file, "").expect("a file");
        }
        folder
    }

    fn paired(files: &[&str], left: &str, right: &str) -> Result<Vec<String>> {
        let folder = folder(files);
        let at = |pattern: &str| format!("{}/{pattern}", folder.path().display());
        let name = |pair: &Pair| {
            let right = pair.right.as_ref().expect("a right view").strip_prefix(folder.path()).expect("in the folder");
            format!(
                "{}: {} {}",
                pair.name,
                pair.left.strip_prefix(folder.path()).expect("in it").display(),
                right.display()
            )
        };
        Ok(pairs(&at(left), &at(right))?.pairs.iter().map(name).collect())
    }

    #[test]
    fn files_are_paired_by_what_the_star_stands_for() {
        let files = ["l/10.png", "l/9.png", "r/9.png", "r/10.png", "r/note.txt"];
        assert_eq!(
            paired(&files, "l/*.png", "r/*.png").expect("pairs"),
            ["9: l/9.png r/9.png", "10: l/10.png r/10.png"]
        );
        let files = ["s1/im0.png", "s1/im1.png", "s2/im0.png", "s2/im1.png", "more/a.png"];
        let expected = ["1: s1/im0.png s1/im1.png", "2: s2/im0.png s2/im1.png"];
        assert_eq!(paired(&files, "s*/im0.png", "s*/im1.png").expect("pairs"), expected);
    }

    #[test]
    fn files_without_a_partner_are_counted_and_hidden_ones_passed_over() {
        let folder = folder(&["l/1.png", "l/2.png", "l/._1.png", "r/1.png", "r/._1.png", "r/3.png"]);
        let at = |pattern: &str| format!("{}/{pattern}", folder.path().display());
        let Listing { pairs: found, alone } = pairs(&at("l/*.png"), &at("r/*.png")).expect("a pair");
        assert_eq!((found.len(), &*found[0].name), (1, "1"));
        assert!(alone[0][0].ends_with("l/2.png") && alone[1][0].ends_with("r/3.png"), "{alone:?}");
        assert_eq!(pairs(&at("l/._*.png"), &at("r/._*.png")).expect("a pair that is asked for").pairs.len(), 1);
    }

    #[test]
    fn pictures_of_both_views_need_no_partner() {
        let folder = folder(&["f/10.png", "f/9.png", "f/9.txt"]);
        let pairs = pictures_of_both(&format!("{}/f/*.png", folder.path().display())).expect("pairs");
        let names: Vec<_> = pairs.iter().map(|pair| (pair.name.as_str(), pair.right.is_none())).collect();
        assert_eq!(names, [("9", true), ("10", true)]);
        assert!(pictures_of_both(&format!("{}/f/*.jpg", folder.path().display())).is_err());
    }

    #[test]
    fn what_cannot_be_paired_is_told() {
        for (left, right, told) in [
            ("l/*.png", "r/*.jpg", "no file matches"),
            ("l/1*.png", "r/9*.png", "no pairs: no text in place of *"),
            ("l/*.png", "l/9.png", "a pattern has one *"),
            ("l/*.tif", "r/*.png", "no file matches"),
            ("m/*.png", "r/*.png", "/m"),
        ] {
            let error = format!(
                "{:#}",
                paired(&["l/10.png", "l/9.png", "r/9.png", "r/10.png", "r/99.png"], left, right).expect_err(told)
            );
            assert!(error.contains(told), "{told}: {error}");
        }
    }
}
