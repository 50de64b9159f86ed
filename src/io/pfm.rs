//! Portable float maps (PFM), the lossless format of disparities and depths.
//!
//! A header of text, `Pf`, width and height, and a scale; then 32-bit floats, the **bottom row first**. The sign of the
//! scale gives the byte order (negative: little endian); its magnitude is ignored, as in Middlebury's tools. +inf
//! stands for 'unknown'; NaN and -inf, which some programs write instead, are read as +inf. P. Debevec, 'PFM Portable
//! FloatMap Image Format', <https://www.pauldebevec.com/Research/HDR/PFM/>.

use std::{
    io::{self, Write},
    path::Path,
};

use super::{MAX_PIXELS, check_pixels, malformed, read_whole};
use crate::{
    disparity::{self, DisparityMap, DisparityRange},
    error::Result,
    image::{Plane, Size},
};

/// Longest word of a header, in bytes: no useful number is longer.
const MAX_WORD: usize = 32;

/// Longest header, with room for comments, in bytes.
const MAX_HEADER: u64 = 1 << 16;

/// Reads a single-channel PFM. Values that are not finite become +inf.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read, otherwise as [`decode`].
pub fn read(path: &Path) -> Result<Plane<f32>> {
    decode(&read_whole(path, 4 * MAX_PIXELS + MAX_HEADER)?, path)
}

/// Reads a single-channel PFM of disparities in pixels; +inf becomes [`disparity::NONE`], other values are rounded to
/// the nearest 1/256 px (halves away from 0).
///
/// # Errors
/// As [`read`]; also [`crate::Error::Format`] for a disparity beyond [`DisparityRange::LIMIT`].
pub fn read_disparities(path: &Path) -> Result<DisparityMap> {
    fixed_point(&read(path)?, path)
}

/// Decodes the values of a single-channel PFM; `path` is named in errors.
///
/// NaN and -inf become +inf. Comments (`#` to the end of the line) and CRLF in the header are accepted, although the
/// format has neither.
///
/// # Errors
/// [`crate::Error::Format`] for another magic word, an invalid size or scale, or fewer or more values than the size
/// needs.
pub fn decode(bytes: &[u8], path: &Path) -> Result<Plane<f32>> {
    let mut header = Header { bytes, path };
    match &*header.word("magic word")? {
        "Pf" => {}
        "PF" => return Err(malformed(path, "a PFM of three channels (PF): only PFM of one (Pf) are read")),
        _ => return Err(malformed(path, "not a PFM: it does not begin with 'Pf'")),
    }
    let width = header.size("width")?;
    let height = header.size("height")?;
    let scale = header.scale()?;
    check_pixels((width, height), path)?;

    let values = header.values(4 * width as usize * height as usize, Size::new(width, height))?;
    let decode = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let rows = values.chunks_exact(4 * width as usize).rev();
    let data = rows.flat_map(|row| row.as_chunks().0).map(|&value| decode(value));
    let known = |value: f32| if value.is_finite() { value } else { f32::INFINITY };
    Plane::new((width, height), data.map(known).collect())
}

/// Writes `plane` as a little-endian PFM.
///
/// # Errors
/// The errors of `out`.
pub fn write(out: &mut impl Write, plane: &Plane<f32>) -> io::Result<()> {
    write!(out, "Pf\n{} {}\n-1\n", plane.width(), plane.height())?;
    for y in (0..plane.height()).rev() {
        let row: Vec<u8> = plane.row(y).iter().flat_map(|value| value.to_le_bytes()).collect();
        out.write_all(&row)?;
    }
    Ok(())
}

/// Writes disparities in pixels as a little-endian PFM, [`disparity::NONE`] as +inf. Lossless below 65536 px, where a
/// float holds every 1/256.
///
/// # Errors
/// The errors of `out`.
pub fn write_disparities(out: &mut impl Write, map: &DisparityMap) -> io::Result<()> {
    write(out, &disparity::in_pixels(map))
}

fn fixed_point(pixels: &Plane<f32>, path: &Path) -> Result<DisparityMap> {
    let limit = DisparityRange::LIMIT;
    let too_large = |value: &f32| value.is_finite() && value.abs() > limit as f32;
    if let Some(index) = pixels.data().iter().position(too_large) {
        let (x, y) = (index % pixels.width() as usize, index / pixels.width() as usize);
        let value = pixels.data()[index];
        return Err(malformed(
            path,
            format!("the value at column {x}, row {y} is {value}: a disparity lies within -{limit} and {limit} px"),
        ));
    }
    Ok(pixels.map(|&d| disparity::fixed_point(d)))
}

/// The unread rest of a file while its header is parsed.
struct Header<'a> {
    bytes: &'a [u8],
    path: &'a Path,
}

impl Header<'_> {
    /// Reads the next word, after white space and comments.
    fn word(&mut self, what: &str) -> Result<String> {
        loop {
            self.bytes = self.bytes.trim_ascii_start();
            if self.bytes.first() != Some(&b'#') {
                break;
            }
            let comment = self.bytes.iter().position(|&byte| byte == b'\n').unwrap_or(self.bytes.len());
            self.bytes = &self.bytes[comment..];
        }
        let length = self.bytes.iter().position(u8::is_ascii_whitespace).unwrap_or(self.bytes.len());
        if length == 0 {
            return Err(malformed(self.path, format!("the PFM ends before its {what}: copy or write it again")));
        }
        let (word, rest) = self.bytes.split_at(length);
        self.bytes = rest;
        Ok(String::from_utf8_lossy(&word[..length.min(MAX_WORD)]).into_owned())
    }

    fn size(&mut self, what: &str) -> Result<u32> {
        let word = self.word(what)?;
        word.parse()
            .map_err(|_| malformed(self.path, format!("the {what} is '{word}', but it is a whole number from 1 on")))
    }

    fn scale(&mut self) -> Result<f32> {
        let word = self.word("scale")?;
        match word.parse() {
            Ok(scale) if f32::is_finite(scale) && scale != 0.0 => Ok(scale),
            _ => {
                let rule = "but it is -1 for little endian or 1 for big endian";
                Err(malformed(self.path, format!("the scale is '{word}', {rule}")))
            }
        }
    }

    /// The `needed` bytes of values, after the single white-space character that ends the header.
    fn values(&self, needed: usize, Size { width, height }: Size) -> Result<&[u8]> {
        let values = match self.bytes {
            // A header with CRLF ends in two characters; the length decides whether a line feed belongs to the first
            // value.
            [b'\r', b'\n', values @ ..] if values.len() == needed => values,
            [_, values @ ..] => values,
            [] => &[],
        };
        let found = values.len();
        if found < needed {
            let reason = format!("{width}x{height} values need {needed} bytes and only {found} are there");
            return Err(malformed(self.path, format!("{reason}: the file is cut off, copy or write it again")));
        }
        if found > needed {
            let reason = format!("{width}x{height} values need {needed} bytes and {found} are there");
            return Err(malformed(self.path, format!("{reason}: the size in the header is wrong")));
        }
        Ok(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    /// A map of 2x2 pixels: top row 1 2, bottom row 3 +inf.
    const LITTLE: &[u8] = b"Pf\n2 2\n-1\n\0\0\x40\x40\0\0\x80\x7f\0\0\x80\x3f\0\0\0\x40";
    const BIG: &[u8] = b"Pf\n2 2\n1.0\n\x40\x40\0\0\x7f\x80\0\0\x3f\x80\0\0\x40\0\0\0";

    fn path() -> &'static Path {
        Path::new("map.pfm")
    }

    fn reason(bytes: &[u8]) -> String {
        match decode(bytes, path()) {
            Err(Error::Format { reason, .. }) => reason,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn reads_either_byte_order_and_turns_the_rows() {
        let expected = [1.0, 2.0, 3.0, f32::INFINITY];
        assert_eq!(decode(LITTLE, path()).unwrap().data(), expected);
        assert_eq!(decode(BIG, path()).unwrap().data(), expected);
    }

    #[test]
    fn writes_exactly_these_bytes() {
        let mut out = Vec::new();
        write(&mut out, &Plane::new((2, 2), vec![1.0, 2.0, 3.0, f32::INFINITY]).unwrap()).unwrap();
        assert_eq!(out, LITTLE);
    }

    #[test]
    fn disparities_are_pixels_and_none_is_infinite() {
        let map = DisparityMap::new((2, 2), vec![256, 512, 768, disparity::NONE]).unwrap();
        let mut out = Vec::new();
        write_disparities(&mut out, &map).unwrap();
        assert_eq!(out, LITTLE);
        assert_eq!(fixed_point(&decode(LITTLE, path()).unwrap(), path()).unwrap(), map);
    }

    #[test]
    fn disparities_are_rounded_to_the_nearest_step() {
        let pixels = Plane::new((4, 1), vec![0.5 / 256.0, -0.5 / 256.0, 0.49 / 256.0, -3.0]).unwrap();
        assert_eq!(fixed_point(&pixels, path()).unwrap().data(), [1, -1, 0, -768]);
    }

    #[test]
    fn a_disparity_beyond_the_limit_is_refused() {
        let pixels = Plane::new((2, 1), vec![1_048_576.0, -1_048_577.0]).unwrap();
        let error = fixed_point(&pixels, path()).unwrap_err().to_string();
        assert!(error.contains("column 1, row 0 is -1048577"), "{error}");
    }

    #[test]
    fn understands_comments_and_crlf() {
        let one = decode(b"Pf\r\n# a comment\r\n1 1\r\n-1\r\n\0\0\x80\x3f", path()).unwrap();
        assert_eq!(one.data(), [1.0]);
    }

    #[test]
    fn a_line_feed_may_be_the_first_byte_of_a_value() {
        let value = f32::from_le_bytes([b'\n', 0, 0x80, 0x3f]);
        assert_eq!(decode(b"Pf 1 1 -1\r\n\0\x80\x3f", path()).unwrap().data(), [value]);
    }

    #[test]
    fn what_is_no_number_is_unknown() {
        for value in [b"\0\0\x80\x7f", b"\0\0\x80\xff", b"\0\0\xc0\x7f"] {
            let map = decode(&[&b"Pf\n1 1\n-1\n"[..], value].concat(), path()).unwrap();
            assert_eq!(map.data(), [f32::INFINITY]);
        }
    }

    #[test]
    fn refusals_name_value_and_way_out() {
        for (bytes, expected) in [
            (&b"P5\n2 2\n255\n"[..], "does not begin with 'Pf'"),
            (b"PF\n1 1\n-1\n", "three channels"),
            (b"Pf", "ends before its width"),
            (b"Pf\n# 2 2", "ends before its width"),
            (b"Pf\n-2 2\n-1\n", "the width is '-2'"),
            (b"Pf\n2 NaN\n-1\n", "the height is 'NaN'"),
            (b"Pf\n0 2\n-1\n", "0x2"),
            (b"Pf\n99999999999999999999 1\n-1\n", "the width is '99999999999999999999'"),
            (b"Pf\n4000000000 4000000000\n-1\n", "scale it down"),
            (b"Pf\n2 2\nNaN\n", "the scale is 'NaN'"),
            (b"Pf\n2 2\n0\n", "-1 for little endian"),
            (b"Pf\n1 1\n-1", "only 0 are there"),
            (&LITTLE[..LITTLE.len() - 1], "16 bytes and only 15 are there: the file is cut off"),
            (&[LITTLE, b"\n"].concat(), "the size in the header is wrong"),
        ] {
            let reason = reason(bytes);
            assert!(reason.contains(expected), "'{reason}' should contain '{expected}'");
        }
    }
}
