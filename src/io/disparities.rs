//! Disparity maps from PNG or PFM files.

use std::path::Path;

use super::{codec, disparity_png, malformed, pfm};
use crate::{disparity, error::Result, image::Plane};

/// Reads a disparity map from a 16-bit PNG ([`disparity_png`]) or a PFM ([`pfm`]): in pixels, not rounded, +inf for no
/// disparity. The format is recognised by the content.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read, [`crate::Error::Format`] if it is neither a PNG nor a PFM.
pub fn read(path: &Path) -> Result<Plane<f32>> {
    let bytes = codec::read_bytes(path)?;
    if bytes.starts_with(disparity_png::SIGNATURE) {
        Ok(disparity::in_pixels(&disparity_png::decode(&bytes, path)?))
    } else if bytes.starts_with(b"PF") || bytes.starts_with(b"Pf") {
        pfm::decode(&bytes, path)
    } else {
        Err(malformed(path, "neither a PNG nor a PFM: disparities are read from 16-bit grey PNG and from PFM"))
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
