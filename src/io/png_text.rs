//! Text chunks (`tEXt`) of PNG files: a keyword and a text.
//!
//! 'Portable Network Graphics (PNG) Specification', W3C, 2003, section 11.3.4.3.

use super::png_chunks::{SIGNATURE, chunks};

/// Bytes of signature and header chunk, behind which other chunks may stand.
const HEADER: usize = SIGNATURE.len() + 25;

/// `png` with a chunk of this keyword (1 to 79 bytes) and text, both ASCII, behind its header.
pub(super) fn with_text(png: &[u8], keyword: &str, text: &str) -> Vec<u8> {
    let (header, rest) = png.split_at(HEADER);
    let body = [b"tEXt", keyword.as_bytes(), b"\0", text.as_bytes()].concat();
    let length = (body.len() - 4) as u32;
    [header, &length.to_be_bytes(), &body, &checksum(&body).to_be_bytes(), rest].concat()
}

/// The text of the first chunk of this keyword before the pixels; `None` without one.
///
/// # Errors
/// What is wrong with the chunk.
pub(super) fn find<'a>(png: &'a [u8], keyword: &str) -> Result<Option<&'a str>, String> {
    for chunk in chunks(png).take_while(|chunk| chunk.data_of(b"IDAT").is_none()) {
        let text = chunk.data_of(b"tEXt").and_then(|data| data.strip_prefix(keyword.as_bytes())?.strip_prefix(b"\0"));
        if let Some(text) = text {
            let is_whole = chunk.checksum == checksum(chunk.body);
            let text = std::str::from_utf8(text).ok().filter(|_| is_whole);
            return text
                .map(Some)
                .ok_or_else(|| format!("the text '{keyword}' is damaged: copy or export the file again"));
        }
    }
    Ok(None)
}

/// The cyclic redundancy check of ISO 3309, as the PNG specification has it in annex D.
fn checksum(bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0xedb8_8320;
    !bytes.iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| if sum & 1 == 1 { sum >> 1 ^ POLYNOMIAL } else { sum >> 1 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{image::Plane, io::png::write_grey16};

    fn png() -> Vec<u8> {
        let mut bytes = Vec::new();
        write_grey16(&mut bytes, &Plane::filled((3, 2), 9)).unwrap();
        bytes
    }

    #[test]
    fn other_readers_read_the_text() {
        // The check value of this code in lists of such codes.
        assert_eq!(checksum(b"123456789"), 0xcbf4_3926);
        let bytes = with_text(&with_text(&png(), "second", "2"), "first", "one and 1");
        assert_eq!((find(&bytes, "first"), find(&bytes, "second")), (Ok(Some("one and 1")), Ok(Some("2"))));
        assert_eq!((find(&bytes, "firs"), find(&png(), "first"), find(b"", "first")), (Ok(None), Ok(None), Ok(None)));
        let mut decoder = ::png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_ignore_text_chunk(false);
        let reader = decoder.read_info().unwrap();
        let texts = &reader.info().uncompressed_latin1_text;
        let texts: Vec<_> = texts.iter().map(|chunk| (&*chunk.keyword, &*chunk.text)).collect();
        assert_eq!(texts, [("first", "one and 1"), ("second", "2")]);
    }

    #[test]
    fn damage_is_told() {
        let bytes = with_text(&png(), "key", "12");
        let text = bytes.windows(2).position(|window| window == b"12").unwrap();
        let mut damaged = bytes.clone();
        damaged[text] = b'7';
        assert!(find(&damaged, "key").unwrap_err().contains("is damaged"));
        // A file that is cut off is the decoder's to refuse.
        for length in 0..bytes.len() {
            let found = find(&bytes[..length], "key");
            assert_eq!(found, Ok((length >= text + 6).then_some("12")), "{length}");
        }
    }
}
