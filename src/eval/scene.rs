//! Stereo pairs with ground truth, in the file layouts of the benchmarks.
//!
//! | folder | views | ground truth of the left and the right view | non-occlusion mask (255: both views see the pixel) |
//! |---|---|---|---|
//! | as in `data/` | `left.png`, `right.png` (or .jpg, .ppm, .pgm) | `disp_left.pfm`, `disp_right.pfm` | `nonocc.png`, `nonocc_right.png` |
//! | Middlebury 2014 | `im0.png`, `im1.png` | `disp0.pfm` (or `disp0GT.pfm`), `disp1.pfm` (or `disp1GT.pfm`) | `mask0nocc.png`, `mask1nocc.png` |
//! | KITTI 2015 | `image_2/N_10.png`, `image_3/N_10.png` | `disp_occ_0/N_10.png`, none | where `disp_noc_0/N_10.png` is known |
//!
//! Masks may be missing, and so may the ground truth of a view that is not read.

use std::path::{Path, PathBuf};

use glam::DVec2;

use super::{Score, conditions::Changed, score_pixels};
use crate::{
    dense::View,
    error::{Error, Result},
    image::{Plane, Size},
    io::{
        Picture, disparities,
        load::{self, LoadedPair, Unseen},
    },
};

/// File extensions of `left` and `right`, in the order in which they are tried.
const VIEW_EXTENSIONS: [&str; 4] = ["png", "jpg", "ppm", "pgm"];

/// Error thresholds of the wrong-pixel shares, in pixels.
pub const THRESHOLDS: [f32; 4] = [0.5, 1.0, 2.0, 4.0];

/// Paths of a scene's files.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFiles {
    /// Name of the folder; for KITTI the name of the frame.
    pub name: String,
    left: PathBuf,
    right: PathBuf,
    /// Ground truth of the left and of the right view.
    truth: [Option<TruthFiles>; 2],
}

#[derive(Clone, Debug, PartialEq)]
struct TruthFiles {
    disparities: PathBuf,
    non_occluded: Option<Mask>,
}

#[derive(Clone, Debug, PartialEq)]
enum Mask {
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

/// A pair of views and the ground truth of one of them.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The left view.
    pub left: Picture,
    /// The right view.
    pub right: Picture,
    /// The reference view, which the ground truth belongs to.
    pub reference: View,
    /// True disparities of the reference view, in pixels, +inf where unknown; positive if the right view's pixel lies
    /// further to the left.
    pub truth: Plane<f32>,
    /// Non-occlusion mask of the reference view, 255 where both views see the same point; `None` if there is no mask.
    pub non_occluded: Option<Plane<u8>>,
}

impl Scene {
    /// The scene with its right view changed, of which the left view is the reference: pixels whose partner the changed view does not
    /// show have no ground truth.
    #[must_use]
    pub fn changed(self, changed: &Changed) -> Self {
        let partner = |x: u32, y: u32| DVec2::new(f64::from(x) - f64::from(self.truth.get(x, y)), y.into());
        let truth = Plane::from_fn(self.truth.size(), |x, y| {
            if changed.shows(partner(x, y)) { self.truth.get(x, y) } else { f32::INFINITY }
        });
        Self { right: changed.picture.clone(), truth, ..self }
    }
}

/// Scores of a map over all pixels and over the non-occluded ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Scores {
    /// Score over all pixels with ground truth.
    pub all: Score,
    /// Score over the non-occluded pixels with ground truth; `None` without a mask.
    pub non_occluded: Option<Score>,
}

impl SceneFiles {
    /// The scenes at `path`, sorted by name: the folder of a scene, a KITTI folder with `image_2` in it, one frame's
    /// picture in `image_2`, or a folder of such folders.
    ///
    /// # Errors
    /// [`Error::Io`] if `path` cannot be read, [`Error::Format`] if it holds no scene.
    pub fn find(path: &Path) -> Result<Vec<Self>> {
        let failed = |source| Error::Io { path: path.into(), source };
        // The canonical path gives '.' and '..' a name.
        let whole = path.canonicalize().map_err(failed)?;
        if whole.is_file() {
            return Self::frame(&whole).map(|frame| vec![frame]).ok_or_else(|| no_scene(path, "a file"));
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
        if let Some(scene) = Self::shipped(folder).or_else(|| Self::middlebury(folder)) {
            return Some(vec![scene]);
        }
        let frames = sorted_entries(&folder.join("image_2")).ok()?;
        let frames: Vec<_> = frames.iter().filter_map(|picture| Self::frame(picture)).collect();
        (!frames.is_empty()).then_some(frames)
    }

    /// The layout of `data/`.
    fn shipped(folder: &Path) -> Option<Self> {
        let view = |name: &str| {
            let file = |extension: &&str| folder.join(name).with_extension(extension);
            VIEW_EXTENSIONS.iter().map(file).find(|path| path.is_file())
        };
        let truth = |disparities: &str, mask: &str| {
            let mask = folder.join(mask);
            Some(TruthFiles {
                disparities: folder.join(disparities),
                non_occluded: mask.is_file().then_some(Mask::Picture(mask)),
            })
        };
        let (left, right) = (view("left"), view("right"));
        (left.is_some() || right.is_some()).then(|| Self {
            name: name(folder),
            left: left.unwrap_or_else(|| folder.join("left.png")),
            right: right.unwrap_or_else(|| folder.join("right.png")),
            truth: [truth("disp_left.pfm", "nonocc.png"), truth("disp_right.pfm", "nonocc_right.png")],
        })
    }

    /// The layout of Middlebury 2014 (D. Scharstein et al., 'High-resolution stereo datasets with subpixel-accurate
    /// ground truth', GCPR 2014), with the file names of the data sets or of the third version of the evaluation.
    fn middlebury(folder: &Path) -> Option<Self> {
        let [left, right] = ["im0.png", "im1.png"].map(|name| folder.join(name));
        let truth = |disparities: [&str; 2], masks: [&str; 2]| {
            let [usual, evaluation] = disparities.map(|name| folder.join(name));
            let mask = masks.map(|name| folder.join(name)).into_iter().find(|path| path.is_file());
            Some(TruthFiles {
                disparities: if evaluation.is_file() && !usual.is_file() { evaluation } else { usual },
                non_occluded: mask.map(Mask::Picture),
            })
        };
        (left.is_file() || right.is_file()).then(|| Self {
            name: name(folder),
            left,
            right,
            truth: [
                truth(["disp0.pfm", "disp0GT.pfm"], ["mask0nocc.png", "mask0nocc"]),
                truth(["disp1.pfm", "disp1GT.pfm"], ["mask1nocc.png", "mask1nocc"]),
            ],
        })
    }

    /// The layout of KITTI 2015 (M. Menze and A. Geiger, 'Object Scene Flow for Autonomous Vehicles', CVPR 2015), from
    /// the left picture of a frame with ground truth: the first frame, N_10, of a training sequence.
    fn frame(picture: &Path) -> Option<Self> {
        let (file, folder) = (picture.file_name()?, picture.parent()?);
        if folder.file_name()? != "image_2" {
            return None;
        }
        let there = |name: &str| folder.with_file_name(name).join(file);
        let (disparities, visible) = (there("disp_occ_0"), there("disp_noc_0"));
        disparities.is_file().then(|| Self {
            name: picture.file_stem().unwrap_or(file).to_string_lossy().into_owned(),
            left: picture.into(),
            right: there("image_3"),
            truth: [
                Some(TruthFiles { disparities, non_occluded: visible.is_file().then_some(Mask::Disparities(visible)) }),
                None,
            ],
        })
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
    /// [`Error::Io`] and [`Error::Format`] with the file; [`Error::SizesDiffer`] if the views differ in size.
    pub fn read(&self, reference: View) -> Result<Scene> {
        let files = self.truth(reference)?;
        let LoadedPair { left, right, .. } = load::load_pair(&self.left, &self.right, &Unseen::default())?;
        if left.size() != right.size() {
            return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
        }
        let truth = disparities::read(&files.disparities)?;
        same_size(&files.disparities, truth.size(), left.size())?;
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

impl Scene {
    /// The picture of the reference view.
    pub fn reference_view(&self) -> &Picture {
        match self.reference {
            View::Left => &self.left,
            View::Right => &self.right,
        }
    }

    /// Scores `map`, in pixels and not finite where there is no estimate, with the thresholds [`THRESHOLDS`].
    ///
    /// # Errors
    /// [`Error::Parameter`] if the size of `map` differs from that of the scene.
    pub fn score(&self, map: &Plane<f32>) -> Result<Scores> {
        let score = |mask| score_pixels(map, &self.truth, mask, &THRESHOLDS);
        Ok(Scores {
            all: score(None)?,
            non_occluded: self.non_occluded.as_ref().map(|mask| score(Some(mask))).transpose()?,
        })
    }
}

fn name(folder: &Path) -> String {
    folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned()
}

fn sorted_entries(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut paths = folder.read_dir()?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

fn no_scene(path: &Path, what: &str) -> Error {
    Error::Format {
        path: path.into(),
        reason: format!(
            "{what}: a scene is a folder with left.png, right.png and disp_left.pfm, a folder of Middlebury with im0.png, \
             im1.png and disp0.pfm, a folder of KITTI with image_2, image_3 and disp_occ_0, or a picture in image_2"
        ),
    }
}

fn same_size(path: &Path, Size { width, height }: Size, views: Size) -> Result<()> {
    if Size::new(width, height) == views {
        return Ok(());
    }
    Err(Error::Format {
        path: path.into(),
        reason: format!(
            "its size is {width}x{height} and that of the views {}x{}: it belongs to other pictures",
            views.width, views.height
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        disparity::{DisparityMap, NONE},
        io::{disparity_png, pfm, png},
    };

    /// Writes grey pictures of 3x2 pixels, each of one value.
    fn pictures(folder: &Path, names: &[(&str, u8)]) {
        for &(name, grey) in names {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            let mut bytes = Vec::new();
            png::write_grey8(&mut bytes, &Plane::filled((3, 2), grey)).unwrap();
            std::fs::write(path, bytes).unwrap();
        }
    }

    /// Writes a map of 3x2 disparities as PNG or PFM, by the file extension.
    fn map(path: &Path, disparities: [i32; 6]) {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        let (map, mut bytes) = (DisparityMap::new((3, 2), disparities.to_vec()).unwrap(), Vec::new());
        if path.extension().unwrap() == "png" {
            disparity_png::write(&mut bytes, &map).unwrap();
        } else {
            pfm::write_disparities(&mut bytes, &map).unwrap();
        }
        std::fs::write(path, bytes).unwrap();
    }

    fn only(path: &Path) -> SceneFiles {
        let mut scenes = SceneFiles::find(path).unwrap();
        assert_eq!(scenes.len(), 1);
        scenes.remove(0)
    }

    const KNOWN: [i32; 6] = [256, 512, 768, 1024, 128, NONE];
    const PIXELS: [f32; 6] = [1.0, 2.0, 3.0, 4.0, 0.5, f32::INFINITY];

    #[test]
    fn the_layout_of_the_shipped_scenes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("Art");
        pictures(&path, &[("left.png", 1), ("right.png", 2), ("nonocc.png", 255), ("nonocc_right.png", 0)]);
        map(&path.join("disp_left.pfm"), KNOWN);
        let files = only(&path);
        assert_eq!(files.name, "Art");
        assert_eq!(files.files(View::Left).unwrap().len(), 4);
        let scene = files.read(View::Left).unwrap();
        assert_eq!((scene.left.rgb(0, 0), scene.right.rgb(0, 0)), ([1; 3], [2; 3]));
        assert_eq!((scene.truth.data(), scene.non_occluded.as_ref().unwrap().data()), (&PIXELS[..], &[255; 6][..]));
        assert!(files.read(View::Right).unwrap_err().to_string().contains("disp_right.pfm"));
        map(&path.join("disp_right.pfm"), [256; 6]);
        let right = files.read(View::Right).unwrap();
        assert_eq!((right.truth.get(0, 0), right.non_occluded.as_ref().unwrap().get(0, 0)), (1.0, 0));
        assert_eq!(right.reference_view().rgb(0, 0), [2; 3]);

        let scores = scene.score(&Plane::filled((3, 2), 1.0)).unwrap();
        assert_eq!((scores.all.known, scores.all.average), (5, 6.5 / 5.0));
        assert_eq!(scores.non_occluded, Some(scores.all));
        std::fs::remove_file(path.join("nonocc.png")).unwrap();
        assert_eq!(only(&path).read(View::Left).unwrap().score(&scene.truth).unwrap().non_occluded, None);
        std::fs::remove_file(path.join("right.png")).unwrap();
        assert!(only(&path).read(View::Left).unwrap_err().to_string().contains("right.png"));
    }

    #[test]
    fn middlebury_in_both_forms() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        pictures(path, &[("im0.png", 1), ("im1.png", 2), ("mask0nocc.png", 128)]);
        map(&path.join("disp0GT.pfm"), [1; 6]);
        let scene = only(path).read(View::Left).unwrap();
        assert_eq!((scene.truth.get(0, 0), scene.non_occluded.as_ref().unwrap().get(0, 0)), (1.0 / 256.0, 128));
        assert_eq!(scene.score(&scene.truth).unwrap().non_occluded.unwrap().known, 0);
        map(&path.join("disp0.pfm"), KNOWN);
        std::fs::rename(path.join("mask0nocc.png"), path.join("mask0nocc")).unwrap();
        let scene = only(path).read(View::Left).unwrap();
        assert_eq!((scene.truth.data(), scene.non_occluded.unwrap().get(0, 0)), (&PIXELS[..], 128));
    }

    #[test]
    fn kitti_by_frame_and_as_a_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("training");
        for frame in ["000001_10", "000000_10", "000000_11"] {
            let of = |folder: &str| format!("{folder}/{frame}.png");
            pictures(&path, &[(&of("image_2"), 1), (&of("image_3"), 2)]);
            if frame.ends_with("10") {
                map(&path.join(of("disp_occ_0")), KNOWN);
                map(&path.join(of("disp_noc_0")), [256, NONE, NONE, NONE, NONE, NONE]);
            }
        }
        let frames = SceneFiles::find(&path).unwrap();
        let names: Vec<_> = frames.iter().map(|frame| &*frame.name).collect();
        assert_eq!(names, ["000000_10", "000001_10"]);
        assert_eq!(SceneFiles::find(folder.path()).unwrap(), frames);
        assert_eq!(only(&path.join("image_2/000001_10.png")), frames[1]);
        let scene = frames[1].read(View::Left).unwrap();
        assert_eq!(scene.truth.data(), PIXELS);
        assert_eq!(scene.non_occluded.unwrap().data(), [255, 0, 0, 0, 0, 0]);
        assert!(frames[0].read(View::Right).unwrap_err().to_string().contains("no truth for the right view"));
        let without_truth = SceneFiles::find(&path.join("image_2/000000_11.png")).unwrap_err().to_string();
        assert!(without_truth.contains("a scene is a folder with"), "{without_truth}");
    }

    #[test]
    fn what_does_not_belong_together_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        assert!(SceneFiles::find(path).unwrap_err().to_string().contains("a folder without a scene"));
        assert!(SceneFiles::find(&path.join("missing")).unwrap_err().to_string().contains("missing"));
        pictures(path, &[("left.png", 1), ("right.png", 2), ("nonocc.png", 255)]);
        std::fs::write(path.join("disp_left.pfm"), b"Pf\n1 1\n-1\n\0\0\0\0").unwrap();
        let message = |path: &Path| only(path).read(View::Left).unwrap_err().to_string();
        assert!(message(path).contains("disp_left.pfm: its size is 1x1 and that of the views 3x2"));
        map(&path.join("disp_left.pfm"), KNOWN);
        let mut bytes = Vec::new();
        png::write_grey8(&mut bytes, &Plane::filled((2, 2), 255)).unwrap();
        std::fs::write(path.join("nonocc.png"), &bytes).unwrap();
        assert!(message(path).contains("nonocc.png: its size is 2x2"));
        std::fs::write(path.join("right.png"), &bytes).unwrap();
        assert!(message(path).contains("the right view 2x2"));
    }
}
