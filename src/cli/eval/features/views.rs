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

use crate::cli::eval::{scenes, truth_scale::TruthOptions};

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
const SETS: &str = "a homography set holds img1.png and for others of its views, such as 3, img3.png and H1to3p; or 1.ppm, 3.ppm and H_1_3";

/// The objection to a scale of disparities where there are none.
const NO_SCALE: &str = "--truth-scale is for disparities, but there are homographies only";

/// File extensions of the views of homography sets, in the order in which they are tried.
const EXTENSIONS: [&str; 4] = ["png", "ppm", "pgm", "jpg"];

/// Views of a homography set after the first.
const VIEWS: std::ops::Range<u32> = 2..100;

/// How a homography set names its files.
#[derive(Clone, Copy)]
enum Naming {
    /// img1.png and H1to2p, as those of Oxford (K. Mikolajczyk et al., 'A Comparison of Affine Region Detectors', IJCV 65, 2005).
    Oxford,
    /// 1.ppm and H_1_2, as HPatches (V. Balntas et al., 'HPatches', CVPR 2017).
    HPatches,
}

impl Naming {
    /// The naming of the set in `folder`, if it has a first view.
    fn of(folder: &Path) -> Option<Self> {
        [Self::Oxford, Self::HPatches].into_iter().find(|naming| naming.view(folder, 1).is_file())
    }

    /// The file of view `k`; the name as PNG if there is none.
    fn view(self, folder: &Path, k: u32) -> PathBuf {
        let name = match self {
            Self::Oxford => format!("img{k}"),
            Self::HPatches => k.to_string(),
        };
        let path = |extension: &str| folder.join(&name).with_extension(extension);
        EXTENSIONS.map(path).into_iter().find(|path| path.is_file()).unwrap_or_else(|| path(EXTENSIONS[0]))
    }

    /// The name of the homography from the first view to view `k`.
    fn homography(self, k: u32) -> String {
        match self {
            Self::Oxford => format!("H1to{k}p"),
            Self::HPatches => format!("H_1_{k}"),
        }
    }
}

impl Pair {
    /// The pairs at `path`: one per stereo scene; for a homography set, and each of a folder of sets, one per view after the first, or
    /// only the requested `view`.
    ///
    /// # Errors
    /// As [`SceneFiles::find`]; [`Error::Format`] if the requested view does not exist, or options for stereo scenes have no scene.
    pub fn find(path: &Path, view: Option<u32>, truth: TruthOptions) -> Result<Vec<Self>> {
        let wrong = |reason: String| Error::Format { path: path.into(), reason };
        if let Some(naming) = Naming::of(path) {
            return if truth.truth_scale.is_some() {
                Err(wrong(NO_SCALE.into()))
            } else {
                Self::of_set(path, naming, view)
            };
        }
        let sets = sets(path).into_iter().map(|(folder, naming)| Self::of_set(&folder, naming, view));
        let mut pairs: Vec<Self> = sets.collect::<Result<Vec<_>>>()?.into_iter().flatten().collect();
        let scenes = match scenes::in_folder(path, truth) {
            Err(Error::Format { .. }) if !pairs.is_empty() => Vec::new(),
            Err(Error::Format { reason, .. }) => return Err(wrong(format!("{reason}; {SETS}"))),
            found => found?,
        };
        match (view, truth.truth_scale, scenes.is_empty()) {
            (Some(view), _, false) => {
                Err(wrong(format!("view {view} was requested, but this is a stereo scene, with one pair")))
            }
            (_, Some(_), true) => Err(wrong(NO_SCALE.into())),
            _ => {
                pairs.extend(scenes.into_iter().map(|files| Self::new(files.name.clone(), Files::Stereo(files))));
                Ok(pairs)
            }
        }
    }

    fn of_set(folder: &Path, naming: Naming, view: Option<u32>) -> Result<Vec<Self>> {
        let pair = |k: u32| {
            let [first, second] = [1, k].map(|k| naming.view(folder, k));
            let matrix = folder.join(naming.homography(k));
            matrix
                .is_file()
                .then(|| Self::new(format!("{} 1-{k}", folder_name(folder)), Files::Plane { first, second, matrix }))
        };
        let pairs: Vec<_> = VIEWS.filter(|&k| view.is_none_or(|view| view == k)).filter_map(pair).collect();
        if pairs.is_empty() {
            let reason = match view {
                Some(view) => format!("view {view} was requested, but there is no {}", naming.homography(view)),
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

/// The homography sets in the subfolders of `path`.
fn sets(path: &Path) -> Vec<(PathBuf, Naming)> {
    let mut folders: Vec<PathBuf> = path.read_dir().into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    folders.sort();
    let has_homography =
        |folder: &Path, naming: Naming| VIEWS.into_iter().any(|k| folder.join(naming.homography(k)).is_file());
    let set = |folder: PathBuf| {
        let naming = Naming::of(&folder).filter(|&naming| has_homography(&folder, naming))?;
        Some((folder, naming))
    };
    folders.into_iter().filter_map(set).collect()
}

/// Last component of a folder's canonical path.
fn folder_name(folder: &Path) -> String {
    let name = folder.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    name.unwrap_or_else(|| folder.display().to_string())
}
