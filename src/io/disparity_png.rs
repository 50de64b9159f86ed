//! Disparities as 16-bit grey PNG, the format of the KITTI benchmarks.
//!
//! A value is 256 times the disparity in pixels, and 0 stands for no disparity (Menze and Geiger, 'Object Scene Flow
//! for Autonomous Vehicles', CVPR 2015, development kit). The scale is this crate's fixed point, so nothing is rounded,
//! but the format is limited to 1/256 to 65535/256 px. A disparity of exactly 0 becomes 1/256 px; disparities below 0
//! or from 256 px on become 'no disparity' and are counted. A PFM ([`super::pfm`]) holds all disparities.

use std::{
    io::{self, Write},
    path::Path,
};

use ::image::DynamicImage;

use super::{codec, malformed, png};
use crate::{
    disparity::{DisparityMap, NONE},
    error::Result,
    image::Plane,
};

pub(super) const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Number of disparities that a 16-bit PNG cannot hold and stores as 'no disparity'.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lost {
    /// Number of disparities below 0.
    pub negative: usize,
    /// Number of disparities of 256 px or more.
    pub too_large: usize,
}

impl Lost {
    /// Number of all lost disparities.
    pub fn total(&self) -> usize {
        self.negative + self.too_large
    }
}

/// Writes `map`, in 1/256 px, and returns the number of lost disparities.
///
/// # Errors
/// The errors of `out`.
pub fn write(out: &mut impl Write, map: &DisparityMap) -> io::Result<Lost> {
    let (values, lost) = to_values(map);
    png::write_grey16(out, &values)?;
    Ok(lost)
}

/// Reads a disparity map, in 1/256 px.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read, otherwise as [`decode`].
pub fn read(path: &Path) -> Result<DisparityMap> {
    decode(&codec::read_bytes(path)?, path)
}

/// Decodes the disparity map in a PNG's bytes, in 1/256 px; `path` is named in errors.
///
/// # Errors
/// [`crate::Error::Format`] if the bytes are no valid PNG of 16-bit grey.
pub fn decode(bytes: &[u8], path: &Path) -> Result<DisparityMap> {
    if !bytes.starts_with(SIGNATURE) {
        return Err(malformed(path, "not a PNG: disparities are read from 16-bit grey PNG and from PFM"));
    }
    match codec::decode(bytes, path)?.image {
        DynamicImage::ImageLuma16(image) => {
            let (width, height) = image.dimensions();
            Ok(Plane::new((width, height), image.into_raw())?.map(|&value| from_value(value)))
        }
        other => {
            let found = codec::describe(other.color());
            let reason = format!("a PNG of {found}: disparities are 16-bit grey, 256 times the pixels, 0 for none");
            Err(malformed(path, reason))
        }
    }
}

fn from_value(value: u16) -> i32 {
    if value == 0 { NONE } else { i32::from(value) }
}

fn to_values(map: &DisparityMap) -> (Plane<u16>, Lost) {
    let mut lost = Lost::default();
    let values = map.map(|&d| match u16::try_from(d) {
        Ok(value) => value.max(1),
        Err(_) => {
            lost.negative += usize::from(d < 0 && d != NONE);
            lost.too_large += usize::from(d > 0);
            0
        }
    });
    (values, lost)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_by_hand() {
        let map = DisparityMap::new((8, 1), vec![NONE, 0, 1, 256, 65535, 65536, -1, i32::MAX]).unwrap();
        let (values, lost) = to_values(&map);
        assert_eq!(values.data(), [0, 1, 1, 256, 65535, 0, 0, 0]);
        assert_eq!(lost, Lost { negative: 1, too_large: 2 });
        assert_eq!(lost.total(), 3);
        assert_eq!([0, 1, 256, 65535].map(from_value), [NONE, 1, 256, 65535]);
    }

    #[test]
    fn other_pictures_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("grey.png");
        let mut grey = Vec::new();
        png::write_grey8(&mut grey, &Plane::filled((3, 2), 9)).unwrap();
        std::fs::write(&path, grey).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("a PNG of 8-bit grey: disparities are 16-bit grey"), "{error}");
        std::fs::write(&path, "Pf\n1 1\n-1\n0000").unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("not a PNG"));
    }
}
