//! Which format a file has, and which files belong together.

use std::path::{Path, PathBuf};

use super::{
    colmap, euroc, kalibr, kitti, middlebury, numbers, opencv, own, ros,
    tree::{Field, Node},
    xml, yaml,
};
use crate::{
    calibration::{Calibration, StereoCalibration},
    error::{Error, Result, shown},
    image::Size,
    io::{malformed, read_whole},
};

/// Longest file that is read, in bytes: COLMAP lists every point that a picture shows.
const MAX_BYTES: u64 = 1 << 27;
/// Longest file of any other format, in bytes.
const MAX_SHORT: usize = 1 << 20;

const ACCEPTED: &str = "calibrations are read from Middlebury's calib.txt, OpenCV's YAML and XML (M1, D1, M2, D2, R, T), ROS \
                        camera_info, Kalibr's camchain, KITTI, EuRoC's sensor.yaml, COLMAP's cameras.txt with images.txt, \
                        K.txt with a baseline, and hsad's own JSON (docs/calibration.md)";

/// What is known of a pair besides its calibration files.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hints<'a> {
    /// Files of the left and the right picture: formats of many cameras or pictures are searched for them.
    pub pictures: Option<[&'a Path; 2]>,
    /// Sizes of the left and the right picture, in pixels: files that describe pictures before and after rectification tell these
    /// apart by their sizes.
    pub sizes: Option<[Size; 2]>,
    /// The unit of length of the files, in metres: 0.001 for millimetres. `None` for the unit that the format has.
    pub unit: Option<f64>,
}

/// A calibration from files.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The pair as its pictures were taken, or as they are if the files describe a rectified pair alone.
    pub stereo: StereoCalibration,
    /// The geometry of pictures that were rectified with the projection matrices of the same files.
    pub rectified: Option<Calibration>,
    /// What was assumed, one sentence each.
    pub notes: Vec<String>,
}

impl Loaded {
    /// The geometry of pictures of `size`, in pixels, that are rectified already.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the files describe only pictures that are not rectified, or pictures of another size.
    pub fn for_rectified(&self, size: Size) -> Result<Calibration> {
        let calibration = self.rectified.ok_or_else(|| Error::Parameter {
            name: "the calibration",
            value: "of pictures as they were taken".into(),
            expected: "these are matched along rows: rectify the pair by the calibration first".into(),
        })?;
        calibration.check_size(size)?;
        Ok(calibration)
    }
}

/// A format of calibration files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Middlebury's `calib.txt`.
    Middlebury,
    /// KITTI's `calib_cam_to_cam.txt`, or the projection matrices `P0` to `P3`.
    Kitti,
    /// `cameras.txt` of COLMAP and ETH3D.
    ColmapCameras,
    /// `images.txt` of COLMAP and ETH3D.
    ColmapImages,
    /// A camera matrix and a baseline, ten numbers.
    Numbers,
    /// OpenCV's FileStorage, YAML or XML.
    OpenCv,
    /// ROS `camera_info` of one camera.
    Ros,
    /// Kalibr's `camchain.yaml`.
    Kalibr,
    /// EuRoC's `sensor.yaml` of one camera.
    Euroc,
    /// hsad's own JSON.
    Own,
}

/// A file with its text, its values if it is YAML, JSON or XML, and its format.
struct File<'a> {
    path: &'a Path,
    text: &'a str,
    node: Option<Node>,
    format: Format,
}

impl<'a> File<'a> {
    fn new(path: &'a Path, text: &'a str) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        if let Some(format) = of_lines(text) {
            check_length(text, path, format)?;
            return Ok(Self { path, text, node: None, format });
        }
        check_length(text, path, Format::OpenCv)?;
        let node = if text.trim_start().starts_with('<') { xml::parse(text, path) } else { yaml::parse(text, path) };
        let node = node.map_err(|error| unknown(path, &error.to_string()))?;
        let format = of_values(&Field::root(&node, path))
            .ok_or_else(|| malformed(path, format!("the file has no calibration that hsad knows: {ACCEPTED}")))?;
        Ok(Self { path, text, node: Some(node), format })
    }

    fn field(&self) -> Field<'_> {
        static EMPTY: Node = Node::Map(Vec::new());
        Field::root(self.node.as_ref().unwrap_or(&EMPTY), self.path)
    }
}

/// Reads the calibration of a pair from one or two files.
///
/// # Errors
/// [`Error::Io`] if a file cannot be read, otherwise as [`parse`].
pub fn read(paths: &[PathBuf], hints: &Hints<'_>) -> Result<Loaded> {
    with_texts(paths, |texts| parse(texts, hints))
}

/// Checks, before any picture is known, that one or two files are the calibration of a pair; `unit` is that of [`Hints`]. Of files with many
/// cameras or pictures, which are KITTI's and COLMAP's, only the format is checked.
///
/// # Errors
/// As [`read`].
pub fn check(paths: &[PathBuf], unit: Option<f64>) -> Result<()> {
    with_texts(paths, |texts| {
        let files = recognised(texts)?;
        let formats: Vec<Format> = files.iter().map(|file| file.format).collect();
        match formats[..] {
            [Format::Kitti]
            | [Format::ColmapCameras, Format::ColmapImages]
            | [Format::ColmapImages, Format::ColmapCameras] => Ok(()),
            _ => of_all(&files, &Hints { unit, ..Hints::default() }, &mut Vec::new()).map(|_| ()),
        }
    })
}

fn with_texts<T>(paths: &[PathBuf], then: impl FnOnce(&[(&Path, &str)]) -> Result<T>) -> Result<T> {
    let texts = paths.iter().map(|path| {
        let bytes = read_whole(path, MAX_BYTES)?;
        Ok((path.as_path(), String::from_utf8_lossy(&bytes).into_owned()))
    });
    let texts: Vec<(&Path, String)> = texts.collect::<Result<_>>()?;
    let texts: Vec<(&Path, &str)> = texts.iter().map(|(path, text)| (*path, text.as_str())).collect();
    then(&texts)
}

/// Parses the texts of one or two files; their paths are named in errors.
///
/// # Errors
/// [`Error::Format`] for an unknown format, for a file without its other half, and for values that are missing or wrong; the message
/// says what to write instead. [`Error::Parameter`] for another number of files.
pub fn parse(texts: &[(&Path, &str)], hints: &Hints<'_>) -> Result<Loaded> {
    let mut notes = Vec::new();
    let (stereo, rectified) = of_all(&recognised(texts)?, hints, &mut notes)?;
    Ok(Loaded { rectified: rectified.or_else(|| stereo.rectified()), stereo, notes })
}

type Found = (StereoCalibration, Option<Calibration>);

fn recognised<'a>(texts: &[(&'a Path, &'a str)]) -> Result<Vec<File<'a>>> {
    texts.iter().map(|&(path, text)| File::new(path, text)).collect()
}

fn of_all(files: &[File<'_>], hints: &Hints<'_>, notes: &mut Vec<String>) -> Result<Found> {
    match files {
        [file] => of_one(file, hints, notes),
        [first, second] => of_two(first, second, hints, notes),
        _ => Err(Error::Parameter {
            name: "the number of calibration files",
            value: files.len().to_string(),
            expected: "it must be one, or two for formats with a file per camera".into(),
        }),
    }
}

fn of_one(file: &File<'_>, hints: &Hints<'_>, notes: &mut Vec<String>) -> Result<Found> {
    let File { path, text, .. } = *file;
    let missing = |what: &str| Err(malformed(path, what));
    match file.format {
        Format::Middlebury => Ok((middlebury::stereo(text, path, hints.unit)?, None)),
        Format::Kitti => kitti::read(text, path, hints, notes),
        Format::Numbers => Ok((numbers::read(text, path, hints)?, None)),
        Format::OpenCv => opencv::read(&[file.field()], hints, notes),
        Format::Kalibr => Ok((kalibr::read(&file.field(), hints.unit)?, None)),
        Format::Own => Ok((own::read(&file.field(), hints.unit)?, None)),
        Format::Ros => {
            missing("this is ROS camera_info of one camera: name the files of the left and of the right one")
        }
        Format::Euroc => missing("this is one camera's sensor.yaml: name those of the left and of the right camera"),
        Format::ColmapCameras => missing("cameras.txt has no positions: name images.txt after it"),
        Format::ColmapImages => missing("images.txt has no camera parameters: name cameras.txt before it"),
    }
}

fn of_two(first: &File<'_>, second: &File<'_>, hints: &Hints<'_>, notes: &mut Vec<String>) -> Result<Found> {
    match (first.format, second.format) {
        (Format::Ros, Format::Ros) => ros::read(&[first.field(), second.field()], hints.unit),
        (Format::Euroc, Format::Euroc) => Ok((euroc::read(&[first.field(), second.field()], hints.unit)?, None)),
        (Format::OpenCv, Format::OpenCv) => opencv::read(&[first.field(), second.field()], hints, notes),
        (Format::ColmapCameras, Format::ColmapImages) => {
            Ok((colmap::read(first.at(), second.at(), hints, notes)?, None))
        }
        (Format::ColmapImages, Format::ColmapCameras) => {
            Ok((colmap::read(second.at(), first.at(), hints, notes)?, None))
        }
        (own, other) => {
            let reason = format!(
                "this file has the format {other:?} and {} the format {own:?}: two files are two ROS camera_info, two EuRoC \
                 sensor.yaml, OpenCV's intrinsics and extrinsics, or COLMAP's cameras.txt and images.txt",
                shown(first.path)
            );
            Err(malformed(second.path, reason))
        }
    }
}

impl<'a> File<'a> {
    fn at(&self) -> (&'a str, &'a Path) {
        (self.text, self.path)
    }
}

/// The format of a file of lines.
fn of_lines(text: &str) -> Option<Format> {
    if text.trim_start().starts_with(['<', '{', '%']) {
        return None;
    }
    if let Some(format) = colmap::recognised(text) {
        return Some(format);
    }
    if middlebury::recognised(text) {
        return Some(Format::Middlebury);
    }
    if kitti::recognised(text) {
        return Some(Format::Kitti);
    }
    numbers::recognised(text).then_some(Format::Numbers)
}

/// The format of a file of nested values.
fn of_values(root: &Field<'_>) -> Option<Format> {
    if root.get(&["cam0", "cam1"]).is_some_and(|camera| camera.has(&["camera_model", "intrinsics"])) {
        Some(Format::Kalibr)
    } else if root.get(&["left", "right"]).is_some_and(|camera| camera.has(&["focal"])) {
        Some(Format::Own)
    } else if root.has(&["T_BS"]) {
        Some(Format::Euroc)
    } else if ros::recognised(root) {
        Some(Format::Ros)
    } else {
        opencv::recognised(root).then_some(Format::OpenCv)
    }
}

fn check_length(text: &str, path: &Path, format: Format) -> Result<()> {
    if matches!(format, Format::ColmapCameras | Format::ColmapImages) || text.len() <= MAX_SHORT {
        return Ok(());
    }
    Err(malformed(path, format!("the file is longer than {MAX_SHORT} bytes, the most that a calibration has")))
}

fn unknown(path: &Path, error: &str) -> Error {
    let prefix = format!("{}: ", shown(path));
    malformed(path, format!("{}; {ACCEPTED}", error.strip_prefix(&prefix).unwrap_or(error)))
}
