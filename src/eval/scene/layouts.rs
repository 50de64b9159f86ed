//! The file layouts of the benchmarks but SceneFlow's.

use std::path::{Path, PathBuf};

use super::files::{Mask, SceneFiles, TruthFiles, sorted_entries};

/// File extensions of pictures, in the order in which they are tried.
const VIEW_EXTENSIONS: [&str; 4] = ["png", "jpg", "ppm", "pgm"];

/// Folders of KITTI 2015 (M. Menze and A. Geiger, 'Object Scene Flow for Autonomous Vehicles', CVPR 2015) and KITTI 2012 (A. Geiger et
/// al., 'Are we ready for Autonomous Driving?', CVPR 2012): the left and the right view, the truth, and the truth of pixels that both
/// views see.
const KITTI: [[&str; 4]; 3] = [
    ["image_2", "image_3", "disp_occ_0", "disp_noc_0"],
    ["colored_0", "colored_1", "disp_occ", "disp_noc"],
    ["image_0", "image_1", "disp_occ", "disp_noc"],
];

/// Views and truths of Middlebury's data sets of 2001 and 2003 (D. Scharstein and R. Szeliski, 'A Taxonomy and Evaluation of Dense
/// Two-Frame Stereo Correspondence Algorithms', IJCV 2002; 'High-Accuracy Stereo Depth Maps Using Structured Light', CVPR 2003), and of
/// those of 2005 and 2006 (H. Hirschmueller and D. Scharstein, 'Evaluation of Cost Functions for Stereo Matching', CVPR 2007).
const MIDDLEBURY_TO_2006: [[&str; 4]; 2] = [["im2", "im6", "disp2", "disp6"], ["view1", "view5", "disp1", "disp5"]];

/// The layout of `data/`.
pub(super) fn shipped(folder: &Path) -> Option<SceneFiles> {
    let (left, right) = (picture(folder, "left"), picture(folder, "right"));
    let truth = |disparities: &str, mask: &str| {
        let mask = folder.join(mask);
        truth(folder.join(disparities), mask.is_file().then_some(Mask::Picture(mask)))
    };
    (left.is_some() || right.is_some()).then(|| SceneFiles {
        name: name(folder),
        left: left.unwrap_or_else(|| folder.join("left.png")),
        right: right.unwrap_or_else(|| folder.join("right.png")),
        truth: [truth("disp_left.pfm", "nonocc.png"), truth("disp_right.pfm", "nonocc_right.png")],
    })
}

/// The layout of Middlebury 2014 (D. Scharstein et al., 'High-resolution stereo datasets with subpixel-accurate
/// ground truth', GCPR 2014), with the file names of the data sets or of the third version of the evaluation, and of ETH3D's pairs (T.
/// Schoeps et al., 'A Multi-View Stereo Benchmark with High-Resolution Images and Multi-Camera Videos', CVPR 2017).
pub(super) fn middlebury(folder: &Path) -> Option<SceneFiles> {
    let [left, right] = ["im0.png", "im1.png"].map(|name| folder.join(name));
    let truth = |disparities: [&str; 2], masks: [&str; 2]| {
        let [usual, evaluation] = disparities.map(|name| folder.join(name));
        let mask = masks.map(|name| folder.join(name)).into_iter().find(|path| path.is_file());
        truth(if evaluation.is_file() && !usual.is_file() { evaluation } else { usual }, mask.map(Mask::Picture))
    };
    (left.is_file() || right.is_file()).then(|| SceneFiles {
        name: name(folder),
        left,
        right,
        truth: [
            truth(["disp0.pfm", "disp0GT.pfm"], ["mask0nocc.png", "mask0nocc"]),
            truth(["disp1.pfm", "disp1GT.pfm"], ["mask1nocc.png", "mask1nocc"]),
        ],
    })
}

/// The layouts of Middlebury's data sets up to 2006, whose folders may have more views.
pub(super) fn middlebury_to_2006(folder: &Path) -> Option<SceneFiles> {
    MIDDLEBURY_TO_2006.iter().find_map(|[left, right, of_left, of_right]| {
        let truth = |name: &str| {
            let png = folder.join(name).with_extension("png");
            truth(picture(folder, name).unwrap_or(png), None)
        };
        let (left, right) = (picture(folder, left)?, picture(folder, right)?);
        Some(SceneFiles { name: name(folder), left, right, truth: [truth(of_left), truth(of_right)] })
    })
}

/// The frames of a folder of KITTI.
pub(super) fn kitti(folder: &Path) -> Option<Vec<SceneFiles>> {
    KITTI.iter().find_map(|[left, ..]| {
        let frames = sorted_entries(&folder.join(left)).ok()?;
        let frames: Vec<_> = frames.iter().filter_map(|picture| frame(picture)).collect();
        (!frames.is_empty()).then_some(frames)
    })
}

/// The scene of KITTI whose left picture this is, of a frame with ground truth: the first frame, N_10, of a training sequence.
pub(super) fn frame(picture: &Path) -> Option<SceneFiles> {
    let (file, folder) = (picture.file_name()?, picture.parent()?);
    let [_, right, truth_folder, visible] =
        KITTI.iter().find(|[left, ..]| folder.file_name() == Some(left.as_ref()))?;
    let there = |name: &str| folder.with_file_name(name).join(file);
    let (disparities, visible) = (there(truth_folder), there(visible));
    disparities.is_file().then(|| SceneFiles {
        name: picture.file_stem().unwrap_or(file).to_string_lossy().into_owned(),
        left: picture.into(),
        right: there(right),
        truth: [truth(disparities, visible.is_file().then_some(Mask::Disparities(visible))), None],
    })
}

/// A truth in its file's own unit.
pub(super) fn truth(disparities: PathBuf, non_occluded: Option<Mask>) -> Option<TruthFiles> {
    Some(TruthFiles { disparities, non_occluded, scale: None })
}

/// The picture of this name, without its extension.
fn picture(folder: &Path, name: &str) -> Option<PathBuf> {
    VIEW_EXTENSIONS.iter().map(|extension| folder.join(name).with_extension(extension)).find(|path| path.is_file())
}

fn name(folder: &Path) -> String {
    folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned()
}
