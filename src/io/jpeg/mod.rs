//! Checks of JPEG files that the decoder does not report: truncation (it fills the rest with grey) and CMYK (it
//! converts the colours by guess).
//!
//! Only the markers are read (ITU-T T.81, annex B). A scan that ends early, before a proper end marker, goes unnoticed:
//! only its entropy codes tell its length, and the decoder, which reads them, does not report it.

const START_OF_SCAN: u8 = 0xda;
const END_OF_IMAGE: u8 = 0xd9;

/// The reason why a JPEG file cannot be used for matching; `None` for a usable file.
pub(super) fn objection(bytes: &[u8]) -> Option<&'static str> {
    const CUT_OFF: &str = "the JPEG is cut off: copy or export it again";
    // The first two bytes are the start-of-image marker, FF D8.
    let mut rest = bytes.get(2..).unwrap_or_default();
    loop {
        let Some((marker, behind)) = next_marker(rest) else { return Some(CUT_OFF) };
        rest = behind;
        match marker {
            END_OF_IMAGE => return None,
            // Markers without a segment: restarts and TEM.
            0xd0..=0xd7 | 0x01 => continue,
            _ => {}
        }
        let Some((segment, behind)) = split_segment(rest) else { return Some(CUT_OFF) };
        rest = behind;
        match (marker, segment) {
            // Frame header: precision, height, width, then the number of components. DHT, JPG and DAC lie in the same
            // range of codes.
            (0xc0..=0xc3 | 0xc5..=0xc7 | 0xc9..=0xcb | 0xcd..=0xcf, [_, _, _, _, _, 4, ..]) => {
                return Some("a JPEG in CMYK: convert it to RGB, its colours depend on a printing profile");
            }
            (START_OF_SCAN, _) => rest = skip_entropy_coded(rest),
            _ => {}
        }
    }
}

/// Position behind `name` in the first application segment of this marker that begins with it; `None` if a file has none before its
/// pixels.
pub(super) fn app_segment(bytes: &[u8], marker: u8, name: &[u8]) -> Option<usize> {
    if !bytes.starts_with(&[0xff, 0xd8]) {
        return None;
    }
    let mut position = 2;
    loop {
        let &[0xff, found, high, low] = bytes.get(position..position + 4)? else { return None };
        if found == START_OF_SCAN {
            return None;
        }
        let segment = bytes.get(position + 4..position + 2 + usize::from(u16::from_be_bytes([high, low])))?;
        if found == marker && segment.starts_with(name) {
            return Some(position + 4 + name.len());
        }
        position += 4 + segment.len();
    }
}

/// The code of the next marker and the bytes behind it; fill bytes and stray bytes before the marker are skipped.
fn next_marker(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let start = bytes.iter().position(|&byte| byte == 0xff)?;
    let code = start + bytes[start..].iter().position(|&byte| byte != 0xff)?;
    Some((bytes[code], &bytes[code + 1..]))
}

/// A segment without its two length bytes, and the bytes behind it.
fn split_segment(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    rest.split_at_checked(usize::from(u16::from_be_bytes(*length)).checked_sub(2)?)
}

/// Skips entropy-coded data: returns the bytes from the first marker on that is neither a stuffed FF nor a restart.
fn skip_entropy_coded(bytes: &[u8]) -> &[u8] {
    let is_marker = |pair: &[u8]| pair[0] == 0xff && !matches!(pair[1], 0x00 | 0xd0..=0xd7 | 0xff);
    let length = bytes.windows(2).position(is_marker).unwrap_or(bytes.len());
    &bytes[length..]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A JPEG of a start marker, a comment that contains an end marker, a frame of `components`, a scan with a stuffed
    /// FF and a restart, and an end marker.
    fn jpeg(components: u8) -> Vec<u8> {
        let mut bytes = vec![0xff, 0xd8, 0xff, 0xfe, 0, 4, 0xff, 0xd9];
        bytes.extend([0xff, 0xff, 0xc0, 0, 8, 8, 0, 1, 0, 1, components]);
        bytes.extend([0xff, 0xda, 0, 2, 0x12, 0xff, 0x00, 0xff, 0xd3, 0x34, 0xff, 0xd9]);
        bytes
    }

    #[test]
    fn a_whole_file_is_accepted_with_anything_behind_it() {
        assert_eq!(objection(&jpeg(3)), None);
        assert_eq!(objection(&[jpeg(1), vec![1, 2, 3]].concat()), None);
    }

    #[test]
    fn every_shorter_file_is_cut_off() {
        let bytes = jpeg(3);
        for length in 0..bytes.len() {
            assert!(objection(&bytes[..length]).unwrap().contains("cut off"), "{length} bytes");
        }
    }

    #[test]
    fn cmyk_is_refused() {
        assert!(objection(&jpeg(4)).unwrap().contains("CMYK"));
    }
}
