//! Pairs from the folders of the benchmarks and of recordings.

use std::{
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

/// Calibration in the folder of a pair.
const CALIBRATION: &str = "calib.txt";

/// What the folder must be.
const EXPECTED: &str = "expected folders image_2 and image_3 (KITTI), cam0/data and cam1/data (EuRoC) or left and right with files of the \
                        same names, or a folder per pair with im0.png and im1.png (Middlebury, ETH3D) or left.png and right.png";

/// The pairs in `folder`, in the order of their names.
///
/// # Errors
/// A folder that cannot be read or has no pairs, and a left view without a right one.
pub fn pairs(folder: &Path) -> Result<Vec<Pair>> {
    if let Some([left, right]) = FOLDERS
        .map(|both| both.map(|one| folder.join(one)))
        .into_iter()
        .find(|both| both.iter().all(|one| one.is_dir()))
    {
        return same_names(&left, &right);
    }
    let of_scene = |scene: &PathBuf| {
        let both = FILES.map(|both| both.map(|file| scene.join(file)));
        let [left, right] = both.into_iter().find(|both| both.iter().all(|file| file.is_file()))?;
        let calibration = Some(scene.join(CALIBRATION)).filter(|file| file.is_file());
        let name = scene.file_name()?.to_str()?.to_owned();
        Some(Pair { name, left, right: Some(right), calibration })
    };
    let pairs: Vec<_> = entries(folder)?.iter().filter_map(of_scene).collect();
    if pairs.is_empty() {
        bail!("{}: no pairs: {EXPECTED}", folder.display());
    }
    Ok(pairs)
}

/// The pairs of files with the same name in two folders.
fn same_names(left: &Path, right: &Path) -> Result<Vec<Pair>> {
    let mut pairs = Vec::new();
    for file in entries(left)?.into_iter().filter(|file| file.is_file()) {
        let (Some(file_name), Some(stem)) = (file.file_name(), file.file_stem().and_then(|stem| stem.to_str())) else {
            continue;
        };
        // Lists and notes lie among the pictures.
        if ["csv", "txt", "yaml", "yml", "json"]
            .iter()
            .any(|other| file.extension().is_some_and(|found| found == *other))
        {
            continue;
        }
        let partner = right.join(file_name);
        if !partner.is_file() {
            bail!("{} has no partner {}", file.display(), partner.display());
        }
        pairs.push(Pair { name: stem.into(), left: file.clone(), right: Some(partner), calibration: None });
    }
    if pairs.is_empty() {
        bail!("{}: no pictures", left.display());
    }
    Ok(pairs)
}

/// What is in a folder, sorted by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let read =
        fs::read_dir(folder).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>());
    let mut entries = read.with_context(|| folder.display().to_string())?;
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
        assert!(pairs(Path::new("/nonexistent")).is_err());
    }
}
