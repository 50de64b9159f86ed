//! The files of a scene, and how they are read.

use std::{
    io,
    path::{Path, PathBuf},
};

use super::Scene;
use crate::{
    dense::View,
    error::{Error, Result},
    image::{Plane, Size},
    io::{
        disparities::{self, Stored},
        load::{self, LoadedPair, Unseen},
    },
};

/// Paths of a scene's files.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFiles {
    /// Name of the folder; for KITTI the name of the frame, for SceneFlow that of the sequence and of the frame.
    pub name: String,
    pub(super) left: PathBuf,
    pub(super) right: PathBuf,
    /// Ground truth of the left and of the right view.
    pub(super) truth: [Option<TruthFiles>; 2],
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct TruthFiles {
    pub disparities: PathBuf,
    pub non_occluded: Option<Mask>,
    /// Factor from the file's disparities to pixels; `None`: 1, and for grey of 8 bits what the size of the pictures tells.
    pub scale: Option<f32>,
}

impl TruthFiles {
    /// The disparities in pixels, for views of this size.
    fn read(&self, views: Size) -> Result<Plane<f32>> {
        let path = &self.disparities;
        let unknown = || Error::Format {
            path: path.clone(),
            reason: "nothing tells by what its values of 8 bits are scaled: name the scale of the truth".into(),
        };
        let (disparities, told) = match disparities::read_stored(path)? {
            Stored::Pixels(disparities) => (disparities, Some(1.0)),
            Stored::Grey8(values) => (values, scale_of_grey(views)),
        };
        let scale = self.scale.or(told).ok_or_else(unknown)?;
        Ok(disparities.map(|&disparity| if disparity.is_finite() { disparity * scale } else { f32::INFINITY }))
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Mask {
    /// Picture that is 255 at non-occluded pixels.
    Picture(PathBuf),
    /// Disparity map that is known at non-occluded pixels only.
    Disparities(PathBuf),
}

impl Mask {
    fn path(&self) -> &Path {
        let (Self::Picture(path) | Self::Disparities(path)) = self;
        path
    }
}

impl SceneFiles {
    /// The scene whose truth has to be multiplied by `scale`, to be in pixels and positive where the right view's pixel lies further to
    /// the left.
    #[must_use]
    pub fn with_truth_scale(mut self, scale: f32) -> Self {
        self.truth.iter_mut().flatten().for_each(|truth| truth.scale = Some(scale));
        self
    }

    fn truth(&self, reference: View) -> Result<&TruthFiles> {
        let [left, right] = &self.truth;
        let (truth, side) = match reference {
            View::Left => (left, "left"),
            View::Right => (right, "right"),
        };
        truth.as_ref().ok_or_else(|| Error::Format {
            path: self.left.clone(),
            reason: format!("this benchmark has no truth for the {side} view: use the other view as reference"),
        })
    }

    /// Paths of the scene's files: both views, the ground truth of `reference`, and its mask if there is one.
    ///
    /// # Errors
    /// [`Error::Format`] if the benchmark has no ground truth for this view.
    pub fn files(&self, reference: View) -> Result<Vec<&Path>> {
        let truth = self.truth(reference)?;
        let mask = truth.non_occluded.as_ref().map(Mask::path);
        Ok([&*self.left, &*self.right, &*truth.disparities].into_iter().chain(mask).collect())
    }

    /// Reads the scene with the ground truth of `reference`.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Format`] with the file, also for a truth without a known pixel; [`Error::SizesDiffer`] if the views differ
    /// in size.
    pub fn read(&self, reference: View) -> Result<Scene> {
        let files = self.truth(reference)?;
        let LoadedPair { left, right, .. } = load::load_pair(&self.left, &self.right, &Unseen::default())?;
        if left.size() != right.size() {
            return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
        }
        let truth = files.read(left.size())?;
        same_size(&files.disparities, truth.size(), left.size())?;
        if truth.data().iter().all(|disparity| !disparity.is_finite()) {
            let reason = "no pixel has a known disparity: there is nothing to compare a map with";
            return Err(Error::Format { path: files.disparities.clone(), reason: reason.into() });
        }
        let non_occluded = match &files.non_occluded {
            None => None,
            Some(Mask::Picture(path)) => Some(load::load(path)?.luma()),
            Some(Mask::Disparities(path)) => {
                Some(disparities::read(path)?.map(|disparity| if disparity.is_finite() { 255 } else { 0 }))
            }
        };
        if let (Some(mask), Some(files)) = (&non_occluded, &files.non_occluded) {
            same_size(files.path(), mask.size(), left.size())?;
        }
        Ok(Scene { left, right, reference, truth, non_occluded })
    }
}

/// By what Middlebury's data sets up to 2006 divide their grey values, by the height of the pictures: thirds, halves and full size of 2005
/// and 2006, quarters, halves and full size of 2003, and the scenes of 2001, of 216 and 379 to 383 rows.
fn scale_of_grey(size: Size) -> Option<f32> {
    let divisor = match size.height {
        370 => 3.0,
        375 => 4.0,
        555 | 750 => 2.0,
        1110 | 1500 => 1.0,
        216 | 379..=383 => 8.0,
        _ => return None,
    };
    Some(1.0 / divisor)
}

/// What is in a folder, sorted by name.
pub(super) fn sorted_entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut paths = folder.read_dir()?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

fn same_size(path: &Path, size: Size, views: Size) -> Result<()> {
    if size == views {
        return Ok(());
    }
    let aspect = |size: Size| f64::from(size.width) / f64::from(size.height);
    let ratio = f64::from(size.width) / f64::from(views.width);
    let what = if (aspect(size) / aspect(views) - 1.0).abs() < 0.01 {
        format!("it belongs to pictures {ratio:.3} times as wide, take files of one size, and disparities of that size")
    } else {
        "it belongs to other pictures".into()
    };
    let (Size { width, height }, of) = (size, views);
    let reason = format!("its size is {width}x{height} and that of the views {}x{}: {what}", of.width, of.height);
    Err(Error::Format { path: path.into(), reason })
}
