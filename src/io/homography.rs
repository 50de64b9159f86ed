//! Homographies in the format of data sets of planar scenes (Oxford, HPatches): nine numbers in text, row by row.

use std::path::Path;

use glam::DMat3;

use super::{malformed, read_whole};
use crate::error::Result;

/// Longest file that is read, in bytes: nine numbers in any notation, with plenty of white space.
const MAX_BYTES: u64 = 1 << 12;

/// Reads a homography, which maps `(x, y, 1)` of one view to another, in pixels.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) if the file cannot be read, otherwise as [`decode`].
pub fn read(path: &Path) -> Result<DMat3> {
    decode(&read_whole(path, MAX_BYTES)?, path)
}

/// Decodes the homography in a file's bytes; `path` is named in errors.
///
/// # Errors
/// [`Error::Format`](crate::Error::Format) if the bytes are not exactly nine finite numbers.
pub fn decode(bytes: &[u8], path: &Path) -> Result<DMat3> {
    let wrong = |what: String| malformed(path, format!("{what}: a homography is nine numbers, row by row"));
    let text = std::str::from_utf8(bytes).map_err(|_| wrong("it is no UTF-8 text".into()))?;
    let mut rows = [0.0; 9];
    let mut count = 0;
    for word in text.split_ascii_whitespace() {
        let number = word.parse().ok().filter(|number: &f64| number.is_finite());
        let number = number.ok_or_else(|| wrong(format!("'{word}' is no number")))?;
        if let Some(place) = rows.get_mut(count) {
            *place = number;
        }
        count += 1;
    }
    if count != rows.len() {
        return Err(wrong(format!("there are {count} numbers")));
    }
    Ok(DMat3::from_cols_array(&rows).transpose())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn rows_are_rows() {
        let matrix = decode(b"1 0 5\n0 2.0 -1e1\r\n\t0 0 1\n\n", Path::new("H1to2p")).unwrap();
        assert_eq!(matrix * DVec3::new(3.0, 4.0, 1.0), DVec3::new(8.0, -2.0, 1.0));
    }

    #[test]
    fn what_is_wrong_is_told() {
        for (text, expected) in [
            (&b"1 0 0 0 1 0 0 0"[..], "there are 8 numbers"),
            (b"1 0 0 0 1 0 0 0 1 7", "there are 10 numbers"),
            (b"1 0 0 0 1 0 0 0 nan", "'nan' is no number"),
            (b"1 0 0 0 1 0 0 0 1e999", "'1e999' is no number"),
            (b"1,0,0", "'1,0,0' is no number"),
            (b"\xff\xfe1", "UTF-8"),
        ] {
            let error = decode(text, Path::new("H1to2p")).unwrap_err().to_string();
            let is_framed = error.starts_with("H1to2p: ") && error.ends_with("nine numbers, row by row");
            assert!(is_framed && error.contains(expected), "{error}");
        }
    }
}
