//! Pairs of views with ground truth, from folders.

use std::{
    cell::OnceCell,
    path::{Path, PathBuf},
};

use hsad::{
    Error, Result,
    dense::View,
    eval::{Truth, scene::SceneFiles},
    io::{Picture, homography, load},
};

/// A pair of views, read when it is first needed; with saved results that may be never.
pub struct Pair {
    pub name: String,
    files: Files,
    views: OnceCell<Views>,
}

enum Files {
    Stereo(SceneFiles),
    /// A pair of a homography set.
    Plane {
        first: PathBuf,
        second: PathBuf,
        matrix: PathBuf,
    },
}

/// Two views and the ground truth that maps points of the first to the second.
pub struct Views {
    pub first: Picture,
    pub second: Picture,
    pub truth: Truth,
}

/// Description of a homography set, for errors.
const SETS: &str = "a homography set holds img1.png and for others of its views, such as 3, img3.png and H1to3p";

impl Pair {
    /// The pairs at `path`: one per stereo scene; for a homography set one per view after the first, or only the
    /// requested `view`.
    ///
    /// # Errors
    /// As [`SceneFiles::find`]; [`Error::Format`] if the requested view does not exist.
    pub fn find(path: &Path, view: Option<u32>) -> Result<Vec<Self>> {
        if path.join("img1.png").is_file() {
            return Self::of_set(path, view);
        }
        let wrong = |reason: String| Error::Format { path: path.into(), reason };
        let scenes = SceneFiles::find(path).map_err(|error| match error {
            Error::Format { reason, .. } => wrong(format!("{reason}; {SETS}")),
            other => other,
        })?;
        if let Some(view) = view {
            return Err(wrong(format!("view {view} was requested, but this is a stereo scene, with one pair")));
        }
        Ok(scenes.into_iter().map(|files| Self::new(files.name.clone(), Files::Stereo(files))).collect())
    }

    fn of_set(folder: &Path, view: Option<u32>) -> Result<Vec<Self>> {
        let pair = |k: u32| {
            let [first, second] = [1, k].map(|k| folder.join(format!("img{k}.png")));
            let matrix = folder.join(format!("H1to{k}p"));
            matrix
                .is_file()
                .then(|| Self::new(format!("{} 1-{k}", folder_name(folder)), Files::Plane { first, second, matrix }))
        };
        let pairs: Vec<_> = (2..100).filter(|&k| view.is_none_or(|view| view == k)).filter_map(pair).collect();
        if pairs.is_empty() {
            let reason = match view {
                Some(view) => format!("view {view} was requested, but there is no H1to{view}p"),
                None => format!("there is no homography: {SETS}"),
            };
            return Err(Error::Format { path: folder.into(), reason });
        }
        Ok(pairs)
    }

    fn new(name: String, files: Files) -> Self {
        Self { name, files, views: OnceCell::new() }
    }

    /// Paths of the pair's files: both views and the ground truth.
    ///
    /// # Errors
    /// As [`SceneFiles::files`].
    pub fn files(&self) -> Result<Vec<&Path>> {
        match &self.files {
            Files::Stereo(files) => files.files(View::Left),
            Files::Plane { first, second, matrix } => Ok(vec![first, second, matrix]),
        }
    }

    /// Both views and their ground truth.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Format`] with the file; [`Error::SizesDiffer`] for the views of a stereo pair.
    pub fn views(&self) -> Result<&Views> {
        if let Some(views) = self.views.get() {
            return Ok(views);
        }
        let views = match &self.files {
            Files::Stereo(files) => {
                let scene = files.read(View::Left)?;
                let truth = Truth::stereo(scene.truth, scene.non_occluded.as_ref())?;
                Views { first: scene.left, second: scene.right, truth }
            }
            Files::Plane { first, second, matrix } => {
                let (first, second) = (load::load(first)?, load::load(second)?);
                let truth = Truth::homography(homography::read(matrix)?, first.size(), second.size())
                    .map_err(|error| Error::Format { path: matrix.clone(), reason: error.to_string() })?;
                Views { first, second, truth }
            }
        };
        Ok(self.views.get_or_init(|| views))
    }
}

/// Last component of a folder's canonical path.
fn folder_name(folder: &Path) -> String {
    let name = folder.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    name.unwrap_or_else(|| folder.display().to_string())
}
