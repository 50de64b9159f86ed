//! Pairs from the folders of the benchmarks and of recordings.

use std::{
    collections::{BTreeMap, HashMap},
    ffi::{OsStr, OsString},
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail};

use super::{
    listing::{Listing, is_hidden},
    pair::Pair,
};

/// Folders of the left and the right view whose files have the same names: KITTI 2015, KITTI 2012 and odometry, raw KITTI, EuRoC, and plain ones.
const FOLDERS: [[&str; 2]; 8] = [
    ["image_2", "image_3"],
    ["colored_0", "colored_1"],
    ["image_0", "image_1"],
    ["image_02/data", "image_03/data"],
    ["image_00/data", "image_01/data"],
    ["cam0/data", "cam1/data"],
    ["mav0/cam0/data", "mav0/cam1/data"],
    ["left", "right"],
];

/// Files of the left and the right view in a folder per pair: Middlebury, ETH3D, and hsad's own; then their calibration.
const FILES: [[&str; 2]; 9] = [
    ["im0.png", "im1.png"],
    ["left.png", "right.png"],
    ["left.jpg", "right.jpg"],
    ["left.ppm", "right.ppm"],
    ["left.pgm", "right.pgm"],
    ["view1.png", "view5.png"],
    ["left.heic", "right.heic"],
    ["left.heif", "right.heif"],
    ["left.avif", "right.avif"],
];

/// Extensions of pictures: other files lie among them. Those of phones are not read, which each pair's record says.
const PICTURES: [&str; 16] = [
    "png", "jpg", "jpeg", "ppm", "pgm", "pnm", "pfm", "bmp", "tif", "tiff", "webp", "jps", "heic", "heif", "hif",
    "avif",
];

/// Calibration in the folder of a pair.
const CALIBRATION: &str = "calib.txt";

/// What the folder must be.
const EXPECTED: &str = "expected folders image_2 and image_3 (KITTI), cam0/data and cam1/data (EuRoC) or left and right with files of the \
                        same names, or a folder of such folders, or a folder per pair with im0.png and im1.png (Middlebury, ETH3D) or left.png and \
                        right.png";

/// What is in `folder`, in the order of the names. Hidden files are passed over.
///
/// # Errors
/// A folder that cannot be read or has no pairs, and a name that is no text.
pub fn pairs(folder: &Path) -> Result<Listing> {
    let listing = match folders_of_views(folder) {
        Some(both) => {
            let mut listing = Listing::default();
            same_names(both, "", &mut listing)?;
            listing
        }
        None => folder_per_scene(folder)?,
    };
    if listing.pairs.is_empty() {
        let alone = listing.left_out().map(|alone| format!("{alone}; ")).unwrap_or_default();
        bail!("{}: no pairs: {alone}{EXPECTED}", hsad::shown(folder));
    }
    Ok(listing)
}

/// The folders of the left and of the right views in `folder`, if it has any that are known.
pub fn folders_of_views(folder: &Path) -> Option<[PathBuf; 2]> {
    let both = FOLDERS.map(|both| both.map(|one| folder.join(one)));
    both.into_iter().find(|both| both.iter().all(|one| one.is_dir()))
}

/// The pairs of folders in `folder`: one each, or those of a sequence, whose names begin with that of its folder.
fn folder_per_scene(folder: &Path) -> Result<Listing> {
    let mut listing = Listing::default();
    for scene in entries(folder)?.into_iter().filter(|entry| entry.is_dir()) {
        let sequence = folders_of_views(&scene);
        let both = FILES.map(|both| both.map(|file| scene.join(file)));
        let is_whole = |both: &&[PathBuf; 2]| both.iter().all(|file| file.is_file());
        // A single picture beside a sequence is none of its views.
        let is_part = |both: &&[PathBuf; 2]| sequence.is_none() && both.iter().any(|file| file.is_file());
        let found = both.iter().find(is_whole).or_else(|| both.iter().find(is_part)).cloned();
        if let Some(both) = sequence {
            let name = text(scene.file_name(), &scene)?;
            same_names(both, &format!("{name}/"), &mut listing)?;
        }
        let Some(both) = found else { continue };
        let are_there = both.each_ref().map(|file| file.is_file());
        let [left, right] = both;
        match are_there {
            [true, true] => {
                let calibration = Some(scene.join(CALIBRATION)).filter(|file| file.is_file());
                let name = text(scene.file_name(), &scene)?;
                listing.pairs.push(Pair { name, left, right: Some(right), calibration });
            }
            [true, false] => listing.alone[0].push(left),
            _ => listing.alone[1].push(right),
        }
    }
    Ok(listing)
}

/// A name as text, which lists and reports are.
fn text(name: Option<&OsStr>, path: &Path) -> Result<String> {
    let name = name.and_then(OsStr::to_str).map(String::from);
    name.with_context(|| format!("{}: the name is no text in UTF-8: rename it", hsad::shown(path)))
}

/// Adds the pairs of pictures with the same name in a left and a right folder. Their names follow `prefix`, and have the extension where others
/// differ in it alone.
fn same_names([left, right]: [PathBuf; 2], prefix: &str, listing: &mut Listing) -> Result<()> {
    let (mut rights, mut both, mut stems) = (pictures(&right)?, Vec::new(), HashMap::new());
    for (name, left) in pictures(&left)? {
        match rights.remove(&name) {
            Some(right) => {
                *stems.entry(left.file_stem().unwrap_or_default().to_owned()).or_insert(0) += 1;
                both.push([left, right]);
            }
            None => listing.alone[0].push(left),
        }
    }
    listing.alone[1].extend(rights.into_values());
    for [left, right] in both {
        let stem = left.file_stem().filter(|stem| stems.get(*stem) == Some(&1));
        let name = prefix.to_owned() + &text(stem.or(left.file_name()), &left)?;
        listing.pairs.push(Pair { name, left, right: Some(right), calibration: None });
    }
    Ok(())
}

/// The pictures in a folder, by their names.
fn pictures(folder: &Path) -> Result<BTreeMap<OsString, PathBuf>> {
    let is_picture = |file: &PathBuf| {
        let extension = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        file.is_file() && PICTURES.contains(&extension.as_str())
    };
    let files = entries(folder)?.into_iter().filter(is_picture);
    Ok(files.filter_map(|file| Some((file.file_name()?.to_owned(), file))).collect())
}

/// What is in a folder and not hidden, sorted by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let read =
        fs::read_dir(folder).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>());
    let mut entries = read.with_context(|| hsad::shown(folder).to_string())?;
    entries.retain(|entry| !entry.file_name().is_some_and(is_hidden));
    entries.sort();
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names of the pairs in a folder of these files, and what is told of the others.
    fn found(files: &[&str]) -> Result<(Vec<String>, Option<String>)> {
        let folder = tempfile::tempdir().expect("a folder");
        for file in files {
            let file = folder.path().join(file);
            fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
            fs::write(file, "").expect("a file");
        }
        let name = |pair: Pair| pair.name + if pair.calibration.is_some() { " calibrated" } else { "" };
        let listing = pairs(folder.path())?;
        let told = listing.left_out().map(|told| told.replace(&format!("{}/", folder.path().display()), ""));
        Ok((listing.pairs.into_iter().map(name).collect(), told))
    }

    fn names(files: &[&str]) -> Result<Vec<String>> {
        found(files).map(|(names, _)| names)
    }

    #[test]
    fn the_folders_of_benchmarks_and_recordings_are_known() {
        let kitti =
            ["image_2/000001_10.png", "image_3/000001_10.png", "image_2/000000_10.png", "image_3/000000_10.png"];
        assert_eq!(names(&kitti).expect("KITTI"), ["000000_10", "000001_10"]);
        let euroc =
            ["mav0/cam0/data/17.png", "mav0/cam1/data/17.png", "mav0/cam0/sensor.yaml", "mav0/cam0/data/data.csv"];
        assert_eq!(names(&euroc).expect("EuRoC"), ["17"]);
        let middlebury = ["Art/im0.png", "Art/im1.png", "Art/calib.txt", "Books/im0.png", "Books/im1.png", "notes.txt"];
        assert_eq!(names(&middlebury).expect("Middlebury"), ["Art calibrated", "Books"]);
        let drives =
            ["1/image_02/data/7.png", "1/image_03/data/7.png", "2/image_02/data/7.png", "2/image_03/data/7.png"];
        assert_eq!(names(&drives).expect("raw KITTI"), ["1/7", "2/7"]);
        let sequences = ["b/cam0/data/7.png", "b/cam1/data/7.png", "a/left.png", "a/right.png"];
        assert_eq!(names(&sequences).expect("a sequence beside a pair"), ["a", "b/7"]);
        let with_thumbnail = [&sequences[..], &["b/left.png"]].concat();
        assert_eq!(names(&with_thumbnail).expect("a sequence with a picture"), ["a", "b/7"]);
        let with_pair = [&with_thumbnail[..], &["b/right.png"]].concat();
        assert_eq!(names(&with_pair).expect("a sequence and a pair"), ["a", "b/7", "b"]);
    }

    #[test]
    fn views_without_a_partner_are_told_and_hidden_files_are_passed_over() {
        let files =
            ["left/1.png", "left/2.png", "left/._1.png", "left/3.png", "right/1.png", "right/4.png", "right/5.png"];
        let told = "views without a partner: 2 left, 2 right (left/2.png, left/3.png, right/4.png, ...)";
        assert_eq!(found(&files).expect("a pair"), (vec!["1".into()], Some(told.into())));
        let files = ["a/im0.png", "a/im1.png", "b/im0.png", "c/right.png", ".d/im0.png", ".d/im1.png"];
        let told = "views without a partner: 1 left, 1 right (b/im0.png, c/right.png)";
        assert_eq!(found(&files).expect("a pair"), (vec!["a".into()], Some(told.into())));
        let files = ["a/im0.png", "a/left.png", "a/right.png"];
        assert_eq!(found(&files).expect("a pair"), (vec!["a".into()], None));
        let files = ["left/1.png", "left/1.jpg", "left/1.2.png", "left/3.png", "left/3.jpg"];
        let files = [&files[..], &["right/1.png", "right/1.jpg", "right/1.2.png", "right/3.png"]].concat();
        let told = "views without a partner: 1 left, 0 right (left/3.jpg)";
        assert_eq!(
            found(&files).expect("pairs"),
            (["1.2", "1.jpg", "1.png", "3"].map(String::from).into(), Some(told.into()))
        );
        let files = ["left/1.HEIC", "right/1.HEIC", "left/2.avif", "right/2.avif"];
        assert_eq!(found(&files).expect("pairs that fail"), (vec!["1".into(), "2".into()], None));
    }

    #[test]
    fn what_is_no_tree_is_told() {
        assert!(names(&["a.png"]).expect_err("no pairs").to_string().contains("no pairs: expected folders image_2"));
        let error = names(&["left/1.png", "left/2.png", "right/3.png"]).expect_err("no pairs").to_string();
        assert!(error.contains("no pairs: views without a partner: 2 left, 1 right"), "{error}");
        assert_eq!(names(&["left/1.png", "right/1.png", "left/Thumbs.db"]).expect("pairs"), ["1"]);
        assert!(pairs(Path::new("/nonexistent")).is_err());
    }
}
