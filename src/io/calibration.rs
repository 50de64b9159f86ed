//! Calibration of a rectified pair, depth from disparity, and Middlebury's file format.
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

use super::{malformed, read_whole};
use crate::{
    disparity::{self, DisparityMap},
    error::{Error, Result},
    image::{Plane, Size},
};

/// Longest calibration file that is read, in bytes: a few lines, with room for many comments.
const MAX_BYTES: u64 = 1 << 16;

/// The geometry of a rectified pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Focal length of both cameras, in pixels.
    pub focal: f64,
    /// Distance between the cameras, in metres.
    pub baseline: f64,
    /// Difference of the principal points' columns, right minus left (cx1 - cx0), in pixels: `disparity + doffs` is 0
    /// at infinity.
    pub doffs: f64,
    /// Column of the principal point, in pixels: of the left camera, as in files, or of the right camera after
    /// [`Self::seen_from_right`].
    pub cx: f64,
    /// Row of both principal points, in pixels.
    pub cy: f64,
    /// Width and height of the calibrated pictures, in pixels; `None` if unknown.
    pub size: Option<Size>,
}

impl Calibration {
    /// A calibration for pictures of `size` (width and height in pixels) with the principal point at their centre.
    /// `focal` and `doffs` are in pixels, `baseline` in metres.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn centred(focal: f64, baseline: f64, doffs: f64, size: impl Into<Size>) -> Result<Self> {
        let size = size.into();
        let middle = |side: u32| (f64::from(side) - 1.0) / 2.0;
        let calibration =
            Self { focal, baseline, doffs, cx: middle(size.width), cy: middle(size.height), size: Some(size) };
        calibration.validate()?;
        Ok(calibration)
    }

    /// Reads a Middlebury `calib.txt`, whose baseline is in millimetres.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read, otherwise as [`Self::parse`].
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(String::from_utf8_lossy(&read_whole(path, MAX_BYTES)?).trim_start_matches('\u{feff}'), path)
    }

    /// Parses the text of a `calib.txt`; `path` is named in errors. The keys `cam0`, `doffs` and `baseline` are
    /// required, `cam1`, `width` and `height` are optional, and other keys are ignored.
    ///
    /// # Errors
    /// [`Error::Format`] with the line that is wrong, or the key that is missing.
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let entries = Entries::new(text, path)?;
        let left = entries.required("cam0")?.camera()?;
        if let Some(right) = entries.get("cam1") {
            let focal = right.camera()?.focal;
            if (focal - left.focal).abs() > 1e-3 * left.focal {
                return Err(right.wrong(&format!("the focal length of cam0, {}: rectify the pair first", left.focal)));
            }
        }
        let size = match (entries.get("width"), entries.get("height")) {
            (Some(width), Some(height)) => Some(Size::new(width.side()?, height.side()?)),
            (None, None) => None,
            (Some(alone), None) | (None, Some(alone)) => return Err(alone.wrong("there with both width and height")),
        };
        let calibration = Self {
            focal: left.focal,
            baseline: 1e-3 * entries.required("baseline")?.positive("a distance in mm above 0")?,
            doffs: entries.required("doffs")?.number("a number of pixels")?,
            cx: left.cx,
            cy: left.cy,
            size,
        };
        calibration.validate().map_err(|error| malformed(path, error.to_string()))?;
        Ok(calibration)
    }

    /// Checks that all values are plausible for a pair of cameras.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the accepted range, for a value outside it.
    pub fn validate(&self) -> Result<()> {
        let check = |name, value: f64, ok: bool, rule: &str| {
            if ok { Ok(()) } else { Err(Error::Parameter { name, value: value.to_string(), expected: rule.into() }) }
        };
        // A value above a thousand kilometres or a million pixels is a mistake; its depths would all be 0 or infinite.
        let positive = |value: f64| (1e-6..=1e6).contains(&value);
        let within = |value: f64| value.abs() <= 1e6;
        check("the focal length", self.focal, positive(self.focal), "it must be 10^-6 to 10^6 pixels")?;
        check("the baseline", self.baseline, positive(self.baseline), "it must be 10^-6 to 10^6 metres")?;
        check("doffs", self.doffs, within(self.doffs), "it must be -10^6 to 10^6 pixels")?;
        check("cx", self.cx, within(self.cx), "it must be -10^6 to 10^6 pixels")?;
        check("cy", self.cy, within(self.cy), "it must be -10^6 to 10^6 pixels")
    }

    /// Checks that the calibration is for pictures of this size (width and height in pixels): scaled pictures have
    /// another focal length.
    ///
    /// # Errors
    /// [`Error::Parameter`] with both sizes, if they differ.
    pub fn check_size(&self, size: impl Into<Size>) -> Result<()> {
        let size = size.into();
        match self.size {
            Some(own) if own != size => Err(Error::Parameter {
                name: "the calibration",
                value: format!("for pictures of {own} pixels"),
                expected: format!("these are {size}: use the calibration that belongs to the pictures"),
            }),
            _ => Ok(()),
        }
    }

    /// The calibration in the coordinates of the right camera, whose principal point lies `doffs` pixels further to the
    /// right.
    pub fn seen_from_right(self) -> Self {
        Self { cx: self.cx + self.doffs, ..self }
    }

    /// Depth along the optical axis, in metres, for a disparity in pixels: `baseline * focal / (disparity + doffs)`;
    /// `None` at infinity and beyond.
    pub fn depth(&self, disparity: f64) -> Option<f64> {
        let denominator = disparity + self.doffs;
        (denominator > 0.0).then(|| self.baseline * self.focal / denominator)
    }
}

/// Depth of each pixel of the map's view, in metres; +inf where there is no disparity or the depth is infinite.
pub fn depth_map(map: &DisparityMap, calibration: &Calibration) -> Plane<f32> {
    let depth = |&d: &i32| calibration.depth(f64::from(disparity::pixels(d)?));
    map.map(|d| depth(d).map_or(f32::INFINITY, |z| z as f32))
}

/// Camera matrix `[f 0 cx; 0 f cy; 0 0 1]`, in pixels.
struct Camera {
    focal: f64,
    cx: f64,
    cy: f64,
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
            let (key, value) = (key.trim(), value.trim());
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
            let reason = format!("there is no line {key}=...: a Middlebury calibration has cam0, doffs and baseline");
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
        const RULE: &str = "[f 0 cx; 0 f cy; 0 0 1] with one focal length f above 0: rectify the pair first";
        let inner = self.value.strip_prefix('[').and_then(|value| value.strip_suffix(']'));
        let rows = inner.ok_or_else(|| self.wrong(RULE))?.split(';').map(|row| row.split_whitespace().collect());
        let rows: Vec<Vec<&str>> = rows.collect();
        let numbers: Option<Vec<f64>> = rows.iter().flatten().map(|text| finite(text)).collect();
        let is_3x3 = rows.len() == 3 && rows.iter().all(|row| row.len() == 3);
        match numbers.as_deref() {
            Some(&[focal, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0])
                if is_3x3 && focal > 0.0 && (fy - focal).abs() <= 1e-3 * focal =>
            {
                Ok(Camera { focal, cx, cy })
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
    use crate::disparity::NONE;

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
    fn depth_by_hand() {
        let calibration = Calibration::centred(1000.0, 0.2, 30.0, (3, 2)).unwrap();
        assert_eq!((calibration.cx, calibration.cy), (1.0, 0.5));
        // 0.2 m * 1000 px / (10 px + 30 px)
        assert_eq!(calibration.depth(10.0), Some(5.0));
        assert_eq!(calibration.depth(-30.0), None);
        assert_eq!(calibration.depth(-31.0), None);
        let map = DisparityMap::new((3, 1), vec![10 * 256, -30 * 256, NONE]).unwrap();
        assert_eq!(depth_map(&map, &calibration).data(), [5.0, f32::INFINITY, f32::INFINITY]);
    }

    #[test]
    fn a_wrong_line_is_named() {
        for (from, to, expected) in [
            ("doffs=32.778", "doffs=NaN", "line 3: doffs is 'NaN'"),
            ("doffs=32.778", "doffs", "line 3: 'doffs' is not of the form key=value"),
            ("doffs=32.778\n", "", "no line doffs=..."),
            ("baseline=193.001\n", "", "no line baseline=..."),
            ("cam0", "cam2", "no line cam0=..."),
            ("baseline=193.001", "baseline=-1", "line 4: baseline is '-1', but it must be a distance in mm above 0"),
            ("baseline=193.001", "baseline=0", "line 4"),
            ("baseline=193.001", "baseline=inf", "line 4"),
            ("baseline=193.001", "baseline=5e-324", "line 4"),
            ("height=497", "height=0", "line 6: height is '0'"),
            ("height=497\n", "", "line 5: width is '741', but it must be there with both width and height"),
            ("doffs=32.778", "doffs=-1e300", "doffs"),
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

    #[test]
    fn numbers_are_validated() {
        let error =
            |focal, baseline, doffs| Calibration::centred(focal, baseline, doffs, (9, 9)).unwrap_err().to_string();
        assert_eq!(error(0.0, 1.0, 0.0), "the focal length is 0, but it must be 10^-6 to 10^6 pixels");
        assert_eq!(error(1.0, f64::NAN, 0.0), "the baseline is NaN, but it must be 10^-6 to 10^6 metres");
        assert_eq!(error(1.0, 1.0, f64::INFINITY), "doffs is inf, but it must be -10^6 to 10^6 pixels");
    }

    #[test]
    fn pictures_of_another_size_are_refused() {
        let calibration = parse(MOTORCYCLE).unwrap();
        assert!(calibration.check_size((741, 497)).is_ok());
        let error = calibration.check_size((370, 248)).unwrap_err().to_string();
        assert!(error.contains("741x497") && error.contains("370x248"), "{error}");
    }
}
