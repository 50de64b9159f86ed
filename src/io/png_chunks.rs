//! Chunks of PNG files.
//!
//! A chunk is its data's length, a type of four letters, the data, and a checksum of type and data, numbers in big-endian order
//! ('Portable Network Graphics (PNG) Specification', W3C, 2003, section 5.3).

use std::borrow::Cow;

/// Bytes before the first chunk.
pub(super) const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
/// The last chunk, whole.
const END: &[u8] = b"\0\0\0\0IEND\xae\x42\x60\x82";
/// Longest EXIF data that are read, for the orientation: what a JPEG can hold.
const MAX_EXIF: usize = 1 << 16;

/// A chunk.
#[derive(Clone, Copy)]
pub(super) struct Chunk<'a> {
    /// All bytes, length and checksum included.
    pub all: &'a [u8],
    /// Type and data.
    pub body: &'a [u8],
    pub checksum: u32,
}

impl<'a> Chunk<'a> {
    /// The data, if the chunk is of this type.
    pub fn data_of(&self, kind: &[u8; 4]) -> Option<&'a [u8]> {
        self.body.strip_prefix(kind)
    }

    /// Whether pixels or their orientation depend on the chunk: it is critical, transparency, or EXIF of a usual length.
    fn is_needed(&self) -> bool {
        let exif = || self.data_of(b"eXIf").is_some_and(|data| data.len() <= MAX_EXIF);
        self.body[0].is_ascii_uppercase() || self.body.starts_with(b"tRNS") || exif()
    }
}

/// The whole chunks of a PNG.
pub(super) fn chunks(png: &[u8]) -> impl Iterator<Item = Chunk<'_>> {
    let mut rest = png.get(SIGNATURE.len()..).unwrap_or_default();
    std::iter::from_fn(move || {
        let (length, behind) = rest.split_first_chunk()?;
        let (body, behind) = behind.split_at_checked((u32::from_be_bytes(*length) as usize).checked_add(4)?)?;
        let (told, behind) = behind.split_first_chunk()?;
        let all = &rest[..rest.len() - behind.len()];
        rest = behind;
        Some(Chunk { all, body, checksum: u32::from_be_bytes(*told) })
    })
}

/// The bytes of a PNG without the chunks that its pixels do not need, such as texts and colour profiles, and with an end chunk if it has
/// none; and what is odd about them. Whether the pixels are whole is the decoder's to tell.
pub(super) fn essential(png: &[u8]) -> (Cow<'_, [u8]>, Option<String>) {
    let needed: usize = chunks(png).filter(Chunk::is_needed).map(|chunk| chunk.all.len()).sum();
    let end = chunks(png).find(|chunk| chunk.body == b"IEND");
    let ends_well = end.is_some_and(|chunk| chunk.all == END);
    let whole: usize = SIGNATURE.len() + chunks(png).map(|chunk| chunk.all.len()).sum::<usize>();
    // A chunk that is cut off, which may be of pixels, is left for the decoder to judge.
    let cut_off = if end.is_none() { png.get(whole..).unwrap_or_default() } else { &[] };
    let cut_off = if END.starts_with(cut_off) { &[] } else { cut_off };
    if ends_well && SIGNATURE.len() + needed == png.len() {
        return (png.into(), None);
    }
    let mut bytes = Vec::with_capacity(SIGNATURE.len() + needed + cut_off.len() + END.len());
    bytes.extend_from_slice(SIGNATURE);
    let kept = chunks(png).take_while(|chunk| chunk.body != b"IEND").filter(Chunk::is_needed);
    kept.for_each(|chunk| bytes.extend_from_slice(chunk.all));
    bytes.extend_from_slice(cut_off);
    if cut_off.is_empty() {
        bytes.extend_from_slice(END);
    }
    let doubt =
        (!ends_well).then(|| "the PNG has no end chunk, but all of its picture: copy or export it again".into());
    (bytes.into(), doubt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        image::Plane,
        io::{png::write_grey16, png_text::with_text},
    };

    fn png() -> Vec<u8> {
        let mut bytes = Vec::new();
        write_grey16(&mut bytes, &Plane::filled((3, 2), 9)).unwrap();
        bytes
    }

    #[test]
    fn what_pixels_do_not_need_is_left_out() {
        let bytes = png();
        assert!(matches!(essential(&bytes), (Cow::Borrowed(whole), None) if whole == bytes));
        assert_eq!(essential(&with_text(&bytes, "key", "text")), (bytes.clone().into(), None));
        let behind_the_end = [&bytes, &b"more"[..]].concat();
        assert_eq!(essential(&behind_the_end), (bytes.into(), None));
    }

    #[test]
    fn a_missing_end_is_told_and_mended() {
        let bytes = png();
        let (without, _) = bytes.split_at(bytes.len() - END.len());
        let (mended, doubt) = essential(without);
        assert_eq!((&*mended, doubt.is_some()), (&bytes[..], true));
        let damaged = [without, b"\0\0\0\0IEND1234"].concat();
        assert_eq!(essential(&damaged), (mended.clone(), doubt.clone()));
        for missing in 1..END.len() {
            assert_eq!(essential(&bytes[..bytes.len() - missing]), (mended.clone(), doubt.clone()), "{missing}");
        }
        // A chunk of pixels that is cut off stays so.
        let cut_off = &bytes[..bytes.len() - END.len() - 1];
        assert_eq!(&*essential(cut_off).0, cut_off);
    }
}
