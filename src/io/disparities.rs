//! Disparity maps from PNG or PFM files.

use std::path::Path;

use ::image::DynamicImage;

use super::{codec, disparity_png, malformed, pfm};
use crate::{disparity, error::Result, image::Plane};

/// Disparities as a file has them, +inf for none.
#[derive(Clone, Debug, PartialEq)]
pub enum Stored {
    /// Disparities in pixels.
    Pixels(Plane<f32>),
    /// Grey of 8 bits in a unit that the file does not tell, 0 for no disparity, as the data sets of Middlebury have up to 2006.
    Grey8(Plane<f32>),
}

/// Reads a disparity map from a 16-bit PNG ([`disparity_png`]) or a PFM ([`pfm`]): in pixels, not rounded, +inf for no
/// disparity. The format is recognised by the content.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read, [`crate::Error::Format`] if it is neither a PNG nor a PFM.
pub fn read(path: &Path) -> Result<Plane<f32>> {
    match read_stored(path)? {
        Stored::Pixels(disparities) => Ok(disparities),
        Stored::Grey8(_) => {
            let reason = "a picture of 8-bit grey: disparities are 16-bit grey, 256 times the pixels, 0 for none";
            Err(malformed(path, reason))
        }
    }
}

/// Reads disparities as [`read`], and also from PNG and PGM of 8 bits.
///
/// # Errors
/// As [`read`].
pub fn read_stored(path: &Path) -> Result<Stored> {
    let bytes = codec::read_bytes(path)?;
    if bytes.starts_with(b"PF") || bytes.starts_with(b"Pf") {
        return pfm::decode(&bytes, path).map(Stored::Pixels);
    }
    let is_png = bytes.starts_with(disparity_png::SIGNATURE);
    if !is_png && !bytes.starts_with(b"P5") && !bytes.starts_with(b"P2") {
        return Err(malformed(path, "neither a PNG nor a PFM: disparities are read from 16-bit grey PNG and from PFM"));
    }
    match codec::decode(&bytes, path)?.image {
        DynamicImage::ImageLuma8(grey) => {
            let (size, known) = (grey.dimensions(), |value: u8| if value == 0 { f32::INFINITY } else { value.into() });
            Ok(Stored::Grey8(Plane::new(size, grey.into_raw().into_iter().map(known).collect())?))
        }
        _ => Ok(Stored::Pixels(disparity::in_pixels(&disparity_png::decode(&bytes, path)?))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disparity::{DisparityMap, NONE};

    #[test]
    fn the_content_tells_the_kind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.any");
        let map = DisparityMap::new((2, 1), vec![384, NONE]).unwrap();
        let expected = [1.5, f32::INFINITY];
        let mut bytes = Vec::new();
        disparity_png::write(&mut bytes, &map).unwrap();
        std::fs::write(&path, bytes).unwrap();
        assert_eq!(read(&path).unwrap().data(), expected);
        let mut bytes = Vec::new();
        pfm::write_disparities(&mut bytes, &map).unwrap();
        std::fs::write(&path, bytes).unwrap();
        assert_eq!(read(&path).unwrap().data(), expected);
        std::fs::write(&path, "neither").unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("neither a PNG nor a PFM"));
    }
}
