//! Pairs from the folders of the benchmarks and of recordings.

use std::{
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail};

use super::pair::Pair;

/// Folders of the left and the right view whose files have the same names: KITTI 2015, KITTI 2012 and odometry, EuRoC, and plain ones.
const FOLDERS: [[&str; 2]; 6] = [
    ["image_2", "image_3"],
    ["colored_0", "colored_1"],
    ["image_0", "image_1"],
    ["cam0/data", "cam1/data"],
    ["mav0/cam0/data", "mav0/cam1/data"],
    ["left", "right"],
];

/// Files of the left and the right view in a folder per pair: Middlebury, ETH3D, and hsad's own; then their calibration.
const FILES: [[&str; 2]; 6] = [
    ["im0.png", "im1.png"],
    ["left.png", "right.png"],
    ["left.jpg", "right.jpg"],
    ["left.ppm", "right.ppm"],
    ["left.pgm", "right.pgm"],
    ["view1.png", "view5.png"],
];

/// Extensions of pictures: other files lie among them.
const PICTURES: [&str; 12] = ["png", "jpg", "jpeg", "ppm", "pgm", "pnm", "pfm", "bmp", "tif", "tiff", "webp", "jps"];

/// Calibration in the folder of a pair.
const CALIBRATION: &str = "calib.txt";

/// What the folder must be.
const EXPECTED: &str = "expected folders image_2 and image_3 (KITTI), cam0/data and cam1/data (EuRoC) or left and right with files of the \
                        same names, or a folder per pair with im0.png and im1.png (Middlebury, ETH3D) or left.png and right.png";

/// The pairs in `folder`, in the order of their names.
///
/// # Errors
/// A folder that cannot be read or has no pairs, a view without the other one, and a name that is no text.
pub fn pairs(folder: &Path) -> Result<Vec<Pair>> {
    if let Some([left, right]) = FOLDERS
        .map(|both| both.map(|one| folder.join(one)))
        .into_iter()
        .find(|both| both.iter().all(|one| one.is_dir()))
    {
        return same_names(&left, &right);
    }
    let mut pairs = Vec::new();
    for scene in entries(folder)?.into_iter().filter(|entry| entry.is_dir()) {
        let both = FILES.map(|both| both.map(|file| scene.join(file)));
        let Some([left, right]) = both.into_iter().find(|both| both.iter().any(|file| file.is_file())) else {
            continue;
        };
        for (file, partner) in [(&left, &right), (&right, &left)] {
            check_partner(file, partner)?;
        }
        let calibration = Some(scene.join(CALIBRATION)).filter(|file| file.is_file());
        pairs.push(Pair { name: text(scene.file_name(), &scene)?, left, right: Some(right), calibration });
    }
    if pairs.is_empty() {
        bail!("{}: no pairs: {EXPECTED}", hsad::shown(folder));
    }
    Ok(pairs)
}

/// Checks that a file that is there has its partner.
fn check_partner(file: &Path, partner: &Path) -> Result<()> {
    if file.is_file() && !partner.is_file() {
        bail!("{} has no partner {}", hsad::shown(file), hsad::shown(partner));
    }
    Ok(())
}

/// A name as text, which lists and reports are.
fn text(name: Option<&OsStr>, path: &Path) -> Result<String> {
    let name = name.and_then(OsStr::to_str).map(String::from);
    name.with_context(|| format!("{}: the name is no text in UTF-8: rename it", hsad::shown(path)))
}

/// The pairs of files with the same name in two folders.
fn same_names(left: &Path, right: &Path) -> Result<Vec<Pair>> {
    let is_picture = |file: &PathBuf| {
        let extension = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        file.is_file() && PICTURES.contains(&extension.as_str())
    };
    let partner = |file: &Path, folder: &Path| folder.join(file.file_name().unwrap_or_default());
    for file in entries(right)?.iter().filter(|&file| is_picture(file)) {
        check_partner(file, &partner(file, left))?;
    }
    let mut pairs = Vec::new();
    for file in entries(left)?.into_iter().filter(is_picture) {
        let right = partner(&file, right);
        check_partner(&file, &right)?;
        pairs.push(Pair { name: text(file.file_stem(), &file)?, left: file, right: Some(right), calibration: None });
    }
    if pairs.is_empty() {
        bail!("{}: no pictures", hsad::shown(left));
    }
    Ok(pairs)
}

/// What is in a folder, sorted by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let read =
        fs::read_dir(folder).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>());
    let mut entries = read.with_context(|| hsad::shown(folder).to_string())?;
    entries.sort();
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(files: &[&str]) -> Result<Vec<String>> {
        let folder = tempfile::tempdir().expect("a folder");
        for file in files {
            let file = folder.path().join(file);
            fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
            fs::write(file, "").expect("a file");
        }
        let name = |pair: Pair| pair.name + if pair.calibration.is_some() { " calibrated" } else { "" };
        Ok(pairs(folder.path())?.into_iter().map(name).collect())
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
    }

    #[test]
    fn what_is_no_tree_is_told() {
        assert!(names(&["a.png"]).expect_err("no pairs").to_string().contains("no pairs: expected folders image_2"));
        let error = names(&["left/1.png", "left/2.png", "right/1.png"]).expect_err("no partner").to_string();
        assert!(error.contains("2.png has no partner"), "{error}");
        for views in [
            ["left/1.png", "right/1.png", "right/2.png"],
            ["a/im0.png", "a/im1.png", "b/im0.png"],
            ["a/left.png", "a/right.png", "b/right.png"],
        ] {
            assert!(names(&views).expect_err("no partner").to_string().contains("has no partner"), "{views:?}");
        }
        assert_eq!(names(&["left/1.png", "right/1.png", "left/.DS_Store", "left/Thumbs.db"]).expect("pairs"), ["1"]);
        assert!(pairs(Path::new("/nonexistent")).is_err());
    }
}
