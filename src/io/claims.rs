//! What the header of a picture claims, against what its file can hold: memory is allocated for no more.

use super::jpeg::HEIGHT_BEHIND;

/// Largest ratio of DEFLATE: a match of 258 bytes in two bits (RFC 1951).
const DEFLATE: u64 = 1032;

/// The size that a picture claims; `None` where the header is of another format than PNG and JPEG, or cut off.
///
/// # Errors
/// Why the file cannot hold so many pixels.
pub(super) fn size(bytes: &[u8]) -> Result<Option<(u32, u32)>, String> {
    let Some(Claim { size: (width, height), least }) = png(bytes).or_else(|| jpeg(bytes)) else { return Ok(None) };
    if height == 0 && bytes.starts_with(&[0xff, 0xd8]) {
        return Err(HEIGHT_BEHIND.into());
    }
    if least > bytes.len() as u64 {
        return Err(format!(
            "its header claims {width}x{height} pixels, which take {least} bytes or more, and the file has {}: it is damaged or cut off, \
             copy or export it again",
            bytes.len()
        ));
    }
    Ok(Some((width, height)))
}

struct Claim {
    size: (u32, u32),
    /// The least number of bytes of a file of this size.
    least: u64,
}

/// The header chunk of a PNG, which is the first.
fn png(bytes: &[u8]) -> Option<Claim> {
    const HEADER: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    let header = bytes.strip_prefix(HEADER)?.get(..10)?;
    let number = |at: usize| u32::from_be_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
    let (width, height) = (number(0), number(4));
    let channels = match header[9] {
        2 => 3,
        4 => 2,
        6 => 4,
        _ => 1,
    };
    let row = (u64::from(width) * channels * u64::from(header[8])).div_ceil(8) + 1;
    Some(Claim { size: (width, height), least: row.saturating_mul(height.into()) / DEFLATE })
}

/// The first frame header of a JPEG: each block of 8x8 pixels takes a bit or more (ITU-T T.81, annexes F and G).
fn jpeg(bytes: &[u8]) -> Option<Claim> {
    let mut rest = bytes.strip_prefix(&[0xff, 0xd8])?;
    loop {
        let &[0xff, marker, high, low, ..] = rest else { return None };
        if marker == 0xff {
            rest = &rest[1..];
            continue;
        }
        if matches!(marker, 0xc0..=0xc3 | 0xc5..=0xc7 | 0xc9..=0xcb | 0xcd..=0xcf) {
            let &[_, height_high, height_low, width_high, width_low] = rest.get(4..9)?.first_chunk()?;
            let [width, height] = [[width_high, width_low], [height_high, height_low]].map(u16::from_be_bytes);
            let blocks = u64::from(width.div_ceil(8)) * u64::from(height.div_ceil(8));
            return Some(Claim { size: (width.into(), height.into()), least: blocks / 8 });
        }
        rest = rest.get(2 + usize::from(u16::from_be_bytes([high, low]))..)?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png_header(width: u32, height: u32, depth: u8, kind: u8, length: usize) -> Vec<u8> {
        let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
        bytes.extend(width.to_be_bytes().into_iter().chain(height.to_be_bytes()).chain([depth, kind]));
        bytes.resize(length, 0);
        bytes
    }

    fn jpeg_header(width: u16, height: u16, length: usize) -> Vec<u8> {
        // Fill bytes, an application's segment of 5 bytes, and a frame.
        let mut bytes = vec![0xff, 0xd8, 0xff, 0xff, 0xe0, 0, 5, 1, 2, 3, 0xff, 0xc2, 0, 17, 8];
        bytes.extend(height.to_be_bytes().into_iter().chain(width.to_be_bytes()));
        bytes.resize(length, 0);
        bytes
    }

    #[test]
    fn what_a_file_can_hold_is_its_claim() {
        // 1031 bytes per row, and one of the filter.
        assert_eq!(size(&png_header(1031, 100, 8, 0, 100)), Ok(Some((1031, 100))));
        assert!(size(&png_header(1031, 101, 8, 0, 100)).unwrap_err().contains("1031x101 pixels, which take 101 bytes"));
        assert_eq!(size(&png_header(1031 * 8, 100, 1, 3, 100)), Ok(Some((8248, 100))));
        assert!(size(&png_header(1031, 100, 16, 6, 700)).is_err());
        assert!(size(&png_header(u32::MAX, u32::MAX, 16, 6, 700)).is_err());
        // 64 blocks per 8 bytes.
        assert_eq!(size(&jpeg_header(8 * 64, 8 * 32, 256)), Ok(Some((512, 256))));
        assert!(size(&jpeg_header(8 * 64, 8 * 33, 256)).unwrap_err().contains("512x264 pixels, which take 264 bytes"));
        assert_eq!(size(&jpeg_header(9, 0, 90)), Err(HEIGHT_BEHIND.into()));
        for other in [
            &b""[..],
            b"\xff\xd8",
            b"\xff\xd8\xff",
            b"\xff\xd8\xff\xc2\0\x11",
            b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0",
            b"P5 9 9",
        ] {
            assert_eq!(size(other), Ok(None));
        }
    }
}
