//! Pairs of views with known truth, from folders.

use std::{
    fs,
    path::{Path, PathBuf},
};

use glam::DMat3;
use hsad::{
    Error, Result,
    eval::Truth,
    io::{Picture, load, pfm},
};

/// Two views and where the second has the points of the first.
pub struct Views {
    pub name: String,
    pub first: Picture,
    pub second: Picture,
    pub truth: Truth,
}

/// What a folder must hold.
const KINDS: &str = "a scene holds left.png, right.png, disp_left.pfm and mostly nonocc.png; a homography set holds \
                     img1.png and for others of its views, such as 3, img3.png and H1to3p";

/// The pairs of a folder: a stereo scene is one, a homography set has one for each view after the first, or only the one
/// that is asked for.
pub fn read(folder: &Path, view: Option<u32>) -> Result<Vec<Views>> {
    let name = folder_name(folder);
    let file = |name: &str| folder.join(name);
    let wrong = |reason: String| Error::Format { path: folder.into(), reason };
    if file("disp_left.pfm").is_file() {
        if let Some(view) = view {
            return Err(wrong(format!("view {view} was asked for, but this is a stereo scene, with one pair")));
        }
        return stereo(folder, name).map(|views| vec![views]);
    }
    if !file("img1.png").is_file() {
        return Err(wrong(format!("no truth is here: {KINDS}")));
    }
    let first = load::load(&file("img1.png"))?;
    let numbers: Vec<u32> =
        (2..100).filter(|&k| view.is_none_or(|view| view == k) && matrix_file(folder, k).is_file()).collect();
    if numbers.is_empty() {
        return Err(wrong(match view {
            Some(view) => format!("view {view} was asked for, but there is no H1to{view}p"),
            None => format!("there is no homography: {KINDS}"),
        }));
    }
    let pair = |&k: &u32| {
        let second = load::load(&file(&format!("img{k}.png")))?;
        let file = matrix_file(folder, k);
        let truth = Truth::homography(matrix(&file)?, first.size(), second.size())
            .map_err(|error| Error::Format { path: file, reason: error.to_string() })?;
        Ok(Views { name: format!("{name} 1-{k}"), first: first.clone(), second, truth })
    };
    numbers.iter().map(pair).collect()
}

/// What a folder is called.
pub fn folder_name(folder: &Path) -> String {
    let name = folder.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    name.unwrap_or_else(|| folder.display().to_string())
}

fn stereo(folder: &Path, name: String) -> Result<Views> {
    let [first, second] = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)));
    let (first, second) = (first?, second?);
    let misfit = |error: Error| Error::Format { path: folder.into(), reason: error.to_string() };
    if first.size() != second.size() {
        return Err(misfit(Error::SizesDiffer { left: first.size(), right: second.size() }));
    }
    let disparities = pfm::read(&folder.join("disp_left.pfm"))?;
    if disparities.size() != first.size() {
        let (width, height) = disparities.size();
        let reason =
            format!("it has {width}x{height} values, but left.png {}x{} pixels", first.width(), first.height());
        return Err(Error::Format { path: folder.join("disp_left.pfm"), reason });
    }
    let mask = folder.join("nonocc.png");
    let mask = if mask.is_file() { Some(load::load(&mask)?.luma()) } else { None };
    let truth = Truth::stereo(disparities, mask.as_ref()).map_err(misfit)?;
    Ok(Views { name, first, second, truth })
}

fn matrix_file(folder: &Path, view: u32) -> PathBuf {
    folder.join(format!("H1to{view}p"))
}

/// Nine numbers, row by row.
fn matrix(path: &Path) -> Result<DMat3> {
    let text = fs::read_to_string(path).map_err(|source| Error::Io { path: path.into(), source })?;
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    match numbers.as_deref().map(<[f64; 9]>::try_from) {
        Some(Ok(rows)) => Ok(DMat3::from_cols_array(&rows).transpose()),
        _ => Err(Error::Format { path: path.into(), reason: "a homography is nine numbers, row by row".into() }),
    }
}
