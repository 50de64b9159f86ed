//! The scenes below a path, in any of the layouts.

use std::path::Path;

use super::{
    files::{SceneFiles, sorted_entries},
    layouts, scene_flow,
};
use crate::error::{Error, Result};

impl SceneFiles {
    /// The scenes at `path`, sorted by name: the folder of a scene, a folder of KITTI with `image_2` or `colored_0` in it, one of
    /// SceneFlow with `disparity` in it or below its `frames_cleanpass`, one frame's picture, or a folder of such folders.
    ///
    /// # Errors
    /// [`Error::Io`] if `path` cannot be read, [`Error::Format`] if it holds no scene.
    pub fn find(path: &Path) -> Result<Vec<Self>> {
        let failed = |source| Error::Io { path: path.into(), source };
        // The canonical path gives '.' and '..' a name.
        let whole = path.canonicalize().map_err(failed)?;
        if whole.is_file() {
            return layouts::frame(&whole).map(|frame| vec![frame]).ok_or_else(|| no_scene(path, "a file"));
        }
        if let Some(scenes) = Self::in_folder(&whole) {
            return Ok(scenes);
        }
        let mut scenes = Vec::new();
        for folder in sorted_entries(&whole).map_err(failed)? {
            scenes.extend(Self::in_folder(&folder).into_iter().flatten());
        }
        if scenes.is_empty() { Err(no_scene(path, "a folder without a scene")) } else { Ok(scenes) }
    }

    /// The scenes of a folder itself, not of its subfolders; `None` if it is no scene. A scene with a missing file is
    /// found, too, so that reading it names the file.
    fn in_folder(folder: &Path) -> Option<Vec<Self>> {
        let scene = layouts::shipped(folder)
            .or_else(|| layouts::middlebury(folder))
            .or_else(|| layouts::middlebury_to_2006(folder));
        scene.map(|scene| vec![scene]).or_else(|| layouts::kitti(folder)).or_else(|| scene_flow::frames(folder))
    }
}

fn no_scene(path: &Path, what: &str) -> Error {
    Error::Format {
        path: path.into(),
        reason: format!(
            "{what}: a scene is a folder with left.png, right.png and disp_left.pfm, one of Middlebury or ETH3D (im0.png, im1.png and \
             disp0.pfm; im2, im6 and disp2; view1, view5 and disp1), of KITTI (image_2, image_3 and disp_occ_0; colored_0, colored_1 \
             and disp_occ), of SceneFlow (frames_cleanpass and disparity), or a picture of KITTI"
        ),
    }
}
