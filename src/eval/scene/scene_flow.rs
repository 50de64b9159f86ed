//! The layout of SceneFlow (N. Mayer et al., 'A Large Dataset to Train Convolutional Networks for Disparity, Optical Flow, and Scene Flow
//! Estimation', CVPR 2016): pictures and disparities in two trees of the same folders, which end in `left` and `right`.

use std::path::{Component, Path, PathBuf};

use super::{
    files::{SceneFiles, sorted_entries},
    layouts,
};

/// Roots of the trees of pictures, in the order in which they are tried: of the data sets, of their samples, and of the subset.
const PICTURES: [&str; 6] =
    ["frames_cleanpass", "RGB_cleanpass", "image_clean", "frames_finalpass", "RGB_finalpass", "image_final"];
/// Root of the tree of disparities, beside that of the pictures.
const DISPARITIES: &str = "disparity";
/// Most folders between the root and `left`, as TRAIN/A/0000 or 35mm_focallength/scene_forwards/fast.
const DEPTH: usize = 3;

/// The frames with truth of a folder that has both trees, or that lies in the tree of pictures.
pub(super) fn frames(folder: &Path) -> Option<Vec<SceneFiles>> {
    let (root, start) = if folder.join(DISPARITIES).is_dir() {
        let root = PICTURES.iter().map(|name| folder.join(name)).find(|root| root.is_dir())?;
        (root.clone(), root)
    } else {
        let is_root = |folder: &&Path| PICTURES.iter().any(|&name| folder.file_name() == Some(name.as_ref()));
        (folder.ancestors().find(is_root)?.into(), folder.into())
    };
    let mut frames = Vec::new();
    below(&root, &start, &mut frames);
    (!frames.is_empty()).then_some(frames)
}

fn below(root: &Path, folder: &Path, frames: &mut Vec<SceneFiles>) {
    let (left, right) = (folder.join("left"), folder.join("right"));
    if left.is_dir() && right.is_dir() {
        let pictures = sorted_entries(&left).unwrap_or_default();
        frames.extend(pictures.iter().filter_map(|picture| frame(root, folder, picture)));
    } else if folder.strip_prefix(root).is_ok_and(|inside| inside.components().count() < DEPTH) {
        let folders = sorted_entries(folder).unwrap_or_default();
        folders.iter().filter(|path| path.is_dir()).for_each(|path| below(root, path, frames));
    }
}

/// The frame of a left picture; `None` without a truth.
fn frame(root: &Path, folder: &Path, left: &Path) -> Option<SceneFiles> {
    let (sequence, file) = (folder.strip_prefix(root).ok()?, left.file_name()?);
    let of = |side: &str| -> PathBuf {
        root.with_file_name(DISPARITIES).join(sequence).join(side).join(file).with_extension("pfm")
    };
    let parts = sequence.components().map(Component::as_os_str).chain(left.file_stem());
    let name = parts.map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("-");
    of("left").is_file().then(|| SceneFiles {
        name,
        left: left.into(),
        right: folder.join("right").join(file),
        truth: [layouts::truth(of("left"), None), layouts::truth(of("right"), None)],
    })
}
