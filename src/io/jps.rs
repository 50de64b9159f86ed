//! Stereo JPEGs (JPS): a JPEG with both views, whose APP3 segment may tell where they lie.
//!
//! The segment has '_JPSJPS_', the length of the descriptor, and four bytes: separation, flags, layout, type ('Stereoscopic Data
//! Descriptor' of VRex' JPS format, 1997).

use super::{halves::Halves, jpeg};

const APP3: u8 = 0xe3;
const NAME: &[u8] = b"_JPSJPS_";

/// Flags.
const HALF_HEIGHT: u8 = 1;
const HALF_WIDTH: u8 = 2;
const LEFT_FIRST: u8 = 4;

/// What a JPS tells of its views.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Descriptor {
    pub halves: Halves,
    /// How the views were squeezed, if they were.
    pub squeezed: Option<&'static str>,
}

/// The descriptor of a JPEG; `None` if it has none.
///
/// # Errors
/// Why its views cannot be taken apart.
pub(super) fn descriptor(bytes: &[u8]) -> Result<Option<Descriptor>, &'static str> {
    let found = jpeg::app_segment(bytes, APP3, NAME).and_then(|start| bytes.get(start..start + 6));
    let Some(&[_, _, _, flags, layout, kind]) = found else { return Ok(None) };
    let is_left_first = flags & LEFT_FIRST != 0;
    let halves = match (kind, layout) {
        (1, 2) if is_left_first => Halves::LeftRight,
        (1, 2) => Halves::RightLeft,
        (1, 3) if is_left_first => Halves::LeftOnTop,
        (1, 3) => Halves::RightOnTop,
        (1, 1) => return Err("it is a JPS with interleaved rows, which a JPEG blurs: export both views side by side"),
        (1, 4) => {
            return Err(
                "it is a JPS with an anaglyph, which has lost each view's colours: export both views side by side",
            );
        }
        (0, _) => return Err("it is a JPS with one view: name the file of the other one, too"),
        _ => return Ok(None),
    };
    let squeezed = match flags & (HALF_WIDTH | HALF_HEIGHT) {
        0 => None,
        HALF_WIDTH => Some("width"),
        HALF_HEIGHT => Some("height"),
        _ => Some("width and height"),
    };
    Ok(Some(Descriptor { halves, squeezed }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(flags: u8, layout: u8, kind: u8) -> Result<Option<Descriptor>, &'static str> {
        let mut bytes = vec![0xff, 0xd8, 0xff, 0xe3, 0, 16];
        bytes.extend(NAME);
        bytes.extend([0, 4, 0, flags, layout, kind, 0xff, 0xd9]);
        descriptor(&bytes)
    }

    #[test]
    fn descriptors_by_hand() {
        let of = |halves, squeezed| Ok(Some(Descriptor { halves, squeezed }));
        assert_eq!(found(0, 2, 1), of(Halves::RightLeft, None));
        assert_eq!(found(4, 2, 1), of(Halves::LeftRight, None));
        assert_eq!(found(6, 2, 1), of(Halves::LeftRight, Some("width")));
        assert_eq!(found(1, 3, 1), of(Halves::RightOnTop, Some("height")));
        assert_eq!(found(7, 3, 1), of(Halves::LeftOnTop, Some("width and height")));
        assert!(found(4, 1, 1).unwrap_err().contains("interleaved"));
        assert!(found(4, 4, 1).unwrap_err().contains("anaglyph"));
        assert!(found(0, 1, 0).unwrap_err().contains("one view"));
        assert_eq!(found(0, 9, 1), Ok(None));
        assert_eq!(descriptor(b"\xff\xd8\xff\xe3\0\x0b_JPSJPS_\0"), Ok(None));
    }
}
