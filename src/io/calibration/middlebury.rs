//! Middlebury's calibration of a rectified pair.
//!
//! `calib.txt` of the Middlebury 2014 data (Scharstein et al., 'High-resolution stereo datasets
//! with subpixel-accurate ground truth', GCPR 2014):
//!
//! ```text
//! cam0=[999.421 0 294.182; 0 999.421 252.932; 0 0 1]
//! cam1=[999.421 0 326.96; 0 999.421 252.932; 0 0 1]
//! doffs=32.778
//! baseline=193.001
//! width=741
//! height=497
//! ```

use std::{collections::HashMap, path::Path};

use glam::DVec2;
#[cfg(feature = "calibrations")]
use glam::{DMat3, DVec3};

#[cfg(feature = "calibrations")]
use crate::calibration::{CameraModel, StereoCalibration};
use crate::{
    calibration::Calibration,
    error::{Error, Result},
    image::Size,
    io::{malformed, read_whole},
};

/// Longest calibration file that is read, in bytes: a few lines, with room for many comments.
const MAX_BYTES: u64 = 1 << 16;

/// Largest difference of `doffs` and of what the camera matrices say, in pixels: some files have whole numbers.
const DOFFS_TOLERANCE: f64 = 0.1;
/// Shortest baseline that is believed without a stated unit, in millimetres: below, metres are meant.
const LEAST_BASELINE: f64 = 1.0;

impl Calibration {
    /// Reads a Middlebury `calib.txt`, whose baseline is in millimetres.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read, otherwise as [`Self::parse`].
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(String::from_utf8_lossy(&read_whole(path, MAX_BYTES)?).trim_start_matches('\u{feff}'), path)
    }

    /// Parses the text of a `calib.txt` of a rectified pair; `path` is named in errors.
    ///
    /// The keys `cam0` and `baseline` are required, and one of `cam1` and `doffs`, which must agree; `width` and `height` are
    /// optional, and other keys are ignored. White space around `=`, commas between numbers and a semicolon at a line's end are
    /// accepted.
    ///
    /// # Errors
    /// [`Error::Format`] with the line that is wrong, or the key that is missing.
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let entries = Entries::new(text, path)?;
        let Pair { cameras: [left, right], baseline, doffs, size } = Pair::new(&entries, None)?;
        for (key, camera) in [("cam0", left), ("cam1", right)] {
            let focal = camera.focal;
            if (focal - left.focal.x).abs().max_element() > 1e-3 * left.focal.x {
                return Err(entries.required(key)?.wrong(ONE_FOCAL_LENGTH));
            }
        }
        let Camera { focal, centre } = left;
        let calibration = Self { focal: focal.x, baseline, doffs, cx: centre.x, cy: centre.y, size };
        calibration.validate().map_err(|error| malformed(path, error.to_string()))?;
        Ok(calibration)
    }
}

const ONE_FOCAL_LENGTH: &str =
    "[f 0 cx; 0 f cy; 0 0 1] with one focal length f, above 0, for both cameras: rectify the pair first";

/// True for lines of the form `cam0=...`.
#[cfg(feature = "calibrations")]
pub(super) fn recognised(text: &str) -> bool {
    text.lines().filter_map(|line| line.split_once('=')).any(|(key, _)| matches!(key.trim(), "cam0" | "doffs"))
}

/// The pair of a `calib.txt`, rectified or with cameras side by side that differ; `unit` is the unit of the baseline, in metres.
#[cfg(feature = "calibrations")]
pub(super) fn stereo(text: &str, path: &Path, unit: Option<f64>) -> Result<StereoCalibration> {
    let Pair { cameras, baseline, size, .. } = Pair::new(&Entries::new(text, path)?, unit)?;
    let refused = |error: Error| malformed(path, error.to_string());
    let [left, right] = cameras.map(|Camera { focal, centre }| CameraModel::pinhole(focal, centre).map_err(refused));
    let shift = DVec3::new(-baseline, 0.0, 0.0);
    StereoCalibration::new([left?, right?], [size; 2], DMat3::IDENTITY, shift).map_err(refused)
}

/// What a file says.
struct Pair {
    cameras: [Camera; 2],
    /// Baseline in metres.
    baseline: f64,
    /// Principal point of the right camera minus the left camera's, in pixels.
    doffs: f64,
    size: Option<Size>,
}

impl Pair {
    fn new(entries: &Entries<'_>, unit: Option<f64>) -> Result<Self> {
        let left = entries.required("cam0")?.camera()?;
        let given = entries.get("doffs").map(|entry| entry.number("a number of pixels")).transpose()?;
        let (right, doffs) = match (entries.get("cam1"), given) {
            (Some(entry), given) => {
                let right = entry.camera()?;
                let shift = right.centre.x - left.centre.x;
                if let Some(doffs) = given.filter(|doffs| (doffs - shift).abs() > DOFFS_TOLERANCE) {
                    let shift = (1e4 * shift).round() / 1e4;
                    let rule = format!("{shift}, cx of cam1 minus cx of cam0: correct doffs {doffs} or the cameras");
                    return Err(entries.required("doffs")?.wrong(&rule));
                }
                (right, given.unwrap_or(shift))
            }
            (None, Some(doffs)) => (Camera { centre: left.centre + DVec2::new(doffs, 0.0), ..left }, doffs),
            (None, None) => {
                entries.required("doffs")?;
                (left, 0.0)
            }
        };
        let size = match (entries.get("width"), entries.get("height")) {
            (Some(width), Some(height)) => Some(Size::new(width.side()?, height.side()?)),
            (None, None) => None,
            (Some(alone), None) | (None, Some(alone)) => return Err(alone.wrong("there with both width and height")),
        };
        let entry = entries.required("baseline")?;
        let baseline = entry.positive("a distance in mm above 0")?;
        if unit.is_none() && baseline < LEAST_BASELINE {
            let rule =
                format!("a distance in mm, {LEAST_BASELINE} at least: for metres write baseline={}", 1e3 * baseline);
            return Err(entry.wrong(&rule));
        }
        Ok(Self { cameras: [left, right], baseline: unit.unwrap_or(1e-3) * baseline, doffs, size })
    }
}

/// Camera matrix `[fx 0 cx; 0 fy cy; 0 0 1]`, in pixels.
#[derive(Clone, Copy)]
struct Camera {
    focal: DVec2,
    centre: DVec2,
}

/// The `key=value` lines of a file.
struct Entries<'a> {
    by_key: HashMap<&'a str, Entry<'a>>,
    path: &'a Path,
}

impl<'a> Entries<'a> {
    fn new(text: &'a str, path: &'a Path) -> Result<Self> {
        let mut by_key = HashMap::new();
        for (number, line) in (1..).zip(text.lines()) {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let Some((key, value)) = line.split_once('=') else {
                let start: String = line.chars().take(40).collect();
                return Err(malformed(path, format!("line {number}: '{start}' is not of the form key=value")));
            };
            let (key, value) = (key.trim(), value.trim().trim_end_matches(';').trim_end());
            if by_key.insert(key, Entry { number, key, value, path }).is_some() {
                return Err(malformed(path, format!("line {number}: {key} is there twice")));
            }
        }
        Ok(Self { by_key, path })
    }

    fn get(&self, key: &str) -> Option<&Entry<'a>> {
        self.by_key.get(key)
    }

    fn required(&self, key: &str) -> Result<&Entry<'a>> {
        self.get(key).ok_or_else(|| {
            let reason =
                format!("there is no line {key}=...: a Middlebury calibration has cam0, baseline, and cam1 or doffs");
            malformed(self.path, reason)
        })
    }
}

struct Entry<'a> {
    number: usize,
    key: &'a str,
    value: &'a str,
    path: &'a Path,
}

impl Entry<'_> {
    fn wrong(&self, rule: &str) -> Error {
        let start: String = self.value.chars().take(80).collect();
        malformed(self.path, format!("line {}: {} is '{start}', but it must be {rule}", self.number, self.key))
    }

    fn number(&self, rule: &str) -> Result<f64> {
        finite(self.value).ok_or_else(|| self.wrong(rule))
    }

    fn positive(&self, rule: &str) -> Result<f64> {
        // Subnormal numbers are refused: the change of units would make them 0.
        finite(self.value).filter(|&value| value >= f64::MIN_POSITIVE).ok_or_else(|| self.wrong(rule))
    }

    fn side(&self) -> Result<u32> {
        self.value.parse().ok().filter(|&side| side > 0).ok_or_else(|| self.wrong("a number of pixels from 1 on"))
    }

    fn camera(&self) -> Result<Camera> {
        const RULE: &str = "[fx 0 cx; 0 fy cy; 0 0 1] with focal lengths above 0";
        let inner = self.value.strip_prefix('[').and_then(|value| value.strip_suffix(']'));
        let separated = |c: char| c.is_whitespace() || c == ',';
        let rows = inner.ok_or_else(|| self.wrong(RULE))?.split(';');
        let rows: Vec<Vec<&str>> =
            rows.map(|row| row.split(separated).filter(|word| !word.is_empty()).collect()).collect();
        let numbers: Option<Vec<f64>> = rows.iter().flatten().map(|text| finite(text)).collect();
        let is_3x3 = rows.len() == 3 && rows.iter().all(|row| row.len() == 3);
        match numbers.as_deref() {
            Some(&[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]) if is_3x3 && fx > 0.0 && fy > 0.0 => {
                Ok(Camera { focal: DVec2::new(fx, fy), centre: DVec2::new(cx, cy) })
            }
            _ => Err(self.wrong(RULE)),
        }
    }
}

/// Parses a finite number.
fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOTORCYCLE: &str = "cam0=[999.421 0 294.182; 0 999.421 252.932; 0 0 1]\n\
        cam1=[999.421 0 326.96; 0 999.421 252.932; 0 0 1]\ndoffs=32.778\nbaseline=193.001\nwidth=741\n\
        height=497\nndisp=70\nisint=0\nvmin=7\nvmax=65\ndyavg=0.23\ndymax=0.379\n";

    fn parse(text: &str) -> Result<Calibration> {
        Calibration::parse(text, Path::new("calib.txt"))
    }

    #[test]
    fn reads_a_middlebury_file() {
        let calibration = parse(MOTORCYCLE).unwrap();
        assert!((calibration.baseline - 0.193001).abs() < 1e-12);
        let rest = (calibration.focal, calibration.doffs, calibration.cx, calibration.cy, calibration.size);
        assert_eq!(rest, (999.421, 32.778, 294.182, 252.932, Some(Size::new(741, 497))));
        // cam1 has its principal point in column 326.96.
        assert!((calibration.seen_from_right().cx - 326.96).abs() < 1e-9);
        assert_eq!(parse(&MOTORCYCLE.replace('\n', "\r\n")).unwrap(), calibration);
    }

    #[test]
    fn lines_as_people_write_them_are_read() {
        let calibration = parse(MOTORCYCLE).unwrap();
        let assert_same = |text: &str| {
            let other = parse(text).unwrap();
            assert!((other.doffs - calibration.doffs).abs() < 1e-9, "{text}");
            assert_eq!(Calibration { doffs: calibration.doffs, ..other }, calibration, "{text}");
        };
        assert_same(&MOTORCYCLE.replace(' ', ", "));
        assert_same(&MOTORCYCLE.replace('\n', ";\n"));
        assert_same(&MOTORCYCLE.replace('=', " = "));
        assert_same(&MOTORCYCLE.replace("doffs=32.778\n", ""));
        assert_same(&MOTORCYCLE.replace("cam1=[999.421 0 326.96; 0 999.421 252.932; 0 0 1]\n", ""));
    }

    #[test]
    fn a_wrong_line_is_named() {
        for (from, to, expected) in [
            ("doffs=32.778", "doffs=NaN", "line 3: doffs is 'NaN'"),
            ("doffs=32.778", "doffs", "line 3: 'doffs' is not of the form key=value"),
            ("baseline=193.001\n", "", "no line baseline=..."),
            ("cam0", "cam2", "no line cam0=..."),
            ("baseline=193.001", "baseline=-1", "line 4: baseline is '-1', but it must be a distance in mm above 0"),
            ("baseline=193.001", "baseline=0", "line 4"),
            ("baseline=193.001", "baseline=inf", "line 4"),
            ("baseline=193.001", "baseline=5e-324", "line 4"),
            ("height=497", "height=0", "line 6: height is '0'"),
            ("height=497\n", "", "line 5: width is '741', but it must be there with both width and height"),
            ("doffs=32.778", "doffs=-1e300", "doffs"),
            ("doffs=32.778", "doffs=0", "line 3: doffs is '0', but it must be 32.778, cx of cam1 minus cx of cam0"),
            (
                "baseline=193.001",
                "baseline=0.193",
                "line 4: baseline is '0.193', but it must be a distance in mm, 1 at",
            ),
            ("baseline=193.001", "baseline=0.193", "for metres write baseline=193"),
            ("cam1=[999.421 0 326.96; 0 999.421 252.932; 0 0 1]\ndoffs=32.778\n", "", "no line doffs=..."),
            ("baseline=193.001", "baseline=1e308", "the baseline"),
            ("width=741", "width=-741", "line 5"),
            ("ndisp=70", "doffs=70", "line 7: doffs is there twice"),
            ("cam0=[999.421", "cam0=[-999.421", "line 1: cam0"),
            ("cam0=[999.421", "cam0=[0", "line 1: cam0"),
            ("cam0=[999.421", "cam0=999.421", "line 1: cam0"),
            ("0 999.421 252.932; 0 0 1]\ncam1", "0 500 252.932; 0 0 1]\ncam1", "line 1: cam0"),
            ("; 0 0 1]\ncam1", "]\ncam1", "line 1: cam0"),
            ("294.182", "NaN", "line 1: cam0"),
            ("cam1=[999.421 0 326.96; 0 999.421", "cam1=[900 0 326.96; 0 900", "line 2: cam1"),
        ] {
            let error = parse(&MOTORCYCLE.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(error.contains(expected), "'{error}' should contain '{expected}'");
        }
    }
}
