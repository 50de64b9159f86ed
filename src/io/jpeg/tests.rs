use ::image::{ColorType, GrayImage, codecs::jpeg::JpegEncoder};

use super::*;

/// A JPEG of random grey values, of 5x3 blocks.
fn jpeg() -> Vec<u8> {
    let mut state = 7_u32;
    let picture = GrayImage::from_fn(37, 20, |_, _| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ::image::Luma([(state >> 24) as u8])
    });
    let mut bytes = Vec::new();
    JpegEncoder::new(&mut bytes).encode(&picture, 37, 20, ColorType::L8.into()).unwrap();
    bytes
}

fn place_of(bytes: &[u8], marker: u8) -> usize {
    bytes.windows(2).position(|pair| pair == [0xff, marker]).unwrap()
}

fn doubt(bytes: &[u8]) -> Option<String> {
    whole(bytes).unwrap().1
}

#[test]
fn a_whole_file_is_accepted_with_anything_behind_it() {
    let bytes = jpeg();
    assert!(matches!(whole(&bytes), Ok((Cow::Borrowed(same), None)) if same == bytes));
    assert_eq!(doubt(&[&bytes, &[1, 2, 3][..]].concat()), None);
}

#[test]
fn a_file_without_its_end_is_mended_and_any_shorter_one_refused() {
    let bytes = jpeg();
    for length in [bytes.len() - 2, bytes.len() - 1] {
        let (mended, doubt) = whole(&bytes[..length]).unwrap();
        assert!(mended.starts_with(&bytes[..length]) && mended.ends_with(&[0xff, END_OF_IMAGE]));
        assert!(doubt.unwrap().contains("no end marker"));
    }
    for length in 0..bytes.len() - 3 {
        let reason = whole(&bytes[..length]).unwrap_err();
        assert!(reason.contains("cut off") || reason.contains("lack"), "{length} bytes: {reason}");
    }
}

#[test]
fn the_decoder_sees_all_of_a_file_without_its_end() {
    let (bytes, path) = (jpeg(), std::path::Path::new("a.jpg"));
    let decode = |bytes: &[u8]| crate::io::load::decode_with_doubt(bytes, path).unwrap();
    let (whole, none) = decode(&bytes);
    let (mended, doubt) = decode(&bytes[..bytes.len() - 2]);
    assert!(whole == mended && none.is_none());
    assert!(doubt.unwrap().starts_with("a.jpg: the JPEG has no end marker"));
}

#[test]
fn lost_blocks_are_counted() {
    let bytes = jpeg();
    let data = place_of(&bytes, START_OF_SCAN) + 2 + 8;
    // The first half of the data, and a proper end.
    let half = [&bytes[..(data + bytes.len()) / 2], &[0xff, END_OF_IMAGE]].concat();
    let reason = whole(&half).unwrap_err();
    assert!(reason.contains("of 15 blocks") && reason.contains("copy or export it again"), "{reason}");
    // A header that claims 400x400 pixels.
    let mut large = bytes.clone();
    let size = place_of(&bytes, 0xc0) + 5;
    large[size..size + 4].copy_from_slice(&[1, 0x90, 1, 0x90]);
    assert!(
        whole(&large).unwrap_err().contains("lack 2485 of 2500 blocks (99.4 %), or its header claims another size")
    );
    // One that claims fewer rows.
    let mut small = bytes;
    small[size + 1] = 8;
    assert!(doubt(&small).unwrap().contains("belong to no part of its picture"));
}

#[test]
fn cmyk_is_refused() {
    let mut bytes = jpeg();
    let count = place_of(&bytes, 0xc0) + 9;
    bytes[count] = 4;
    assert!(whole(&bytes).unwrap_err().contains("CMYK"));
}

/// Three blocks in two restart intervals, of codes that are a byte each: a difference of 0 and no other coefficient.
#[test]
fn restart_intervals_by_hand() {
    let mut counts = [0; 16];
    counts[3] = 1;
    let tables =
        [0x00_u8, 0x10].map(|place| [&[0xff, HUFFMAN_TABLES, 0, 20, place][..], &counts, &[0]].concat()).concat();
    let head: &[u8] =
        &[0xff, 0xd8, 0xff, 0xc0, 0, 11, 8, 0, 8, 0, 24, 1, 1, 0x11, 0, 0xff, RESTART_INTERVAL, 0, 4, 0, 2];
    let scan: &[u8] = &[0xff, START_OF_SCAN, 0, 8, 1, 1, 0, 0, 63, 0];
    let with = |data: &[u8]| [head, &tables, scan, data, &[0xff, END_OF_IMAGE]].concat();
    assert_eq!(doubt(&with(&[0, 0, 0xff, 0xd0, 0])), None);
    // Fill bytes stand before markers.
    assert_eq!(doubt(&with(&[0, 0, 0xff, 0xff, 0xd0, 0, 0xff])), None);
    assert!(whole(&with(&[0, 0xff, 0xd0, 0])).unwrap_err().contains("lack 1 of 3 blocks"));
    assert!(whole(&with(&[0, 0])).unwrap_err().contains("lack 1 of 3 blocks"));
    assert!(whole(&with(&[0, 0, 0xff, 0xd0, 0xfe])).unwrap_err().contains("lack 1 of 3 blocks"));
    assert!(doubt(&with(&[0, 0, 0xff, 0xd0, 0, 0, 0, 0, 0])).unwrap().starts_with("2 bytes"));
}

#[test]
fn sampling_factors_of_a_grey_picture_mean_nothing() {
    let (bytes, path) = (jpeg(), std::path::Path::new("a.jpg"));
    let decode = |bytes: &[u8]| crate::io::load::decode_with_doubt(bytes, path).unwrap();
    let expected = decode(&bytes);
    let factors = place_of(&bytes, 0xc0) + 11;
    assert_eq!((bytes[factors], &expected.1), (0x11, &None));
    for other in [0x22, 0x21, 0x12, 0x33, 0x13, 0x31, 0x44, 0x23] {
        let mut bytes = bytes.clone();
        bytes[factors] = other;
        assert!(decode(&bytes) == expected, "{other:x}");
    }
}

#[test]
fn a_height_behind_the_pixels_is_named() {
    let (bytes, path) = (jpeg(), std::path::Path::new("a.jpg"));
    let size = place_of(&bytes, 0xc0) + 5;
    let height = [bytes[size], bytes[size + 1]];
    let (pixels, end) = bytes.split_at(bytes.len() - 2);
    let with_lines = |lines: [u8; 2]| [pixels, &[0xff, NUMBER_OF_LINES, 0, 4], &lines, end].concat();
    // The same height once more.
    let decode = |bytes: &[u8]| crate::io::load::decode_with_doubt(bytes, path);
    assert!(decode(&with_lines(height)).unwrap() == decode(&bytes).unwrap());
    assert_eq!(whole(&with_lines([0, 16])).unwrap_err(), HEIGHT_BEHIND);
    let mut behind = with_lines(height);
    behind[size..size + 2].fill(0);
    assert!(decode(&behind).unwrap_err().to_string().contains("behind its pixels (DNL), which is not read"));
}

#[test]
fn scans_of_single_components_with_other_rows_are_refused() {
    let refused = |factors: u8, kind: u8| {
        let frame = [0xff, 0xd8, 0xff, kind, 0, 17, 8, 0, 16, 0, 16, 3, 1, factors, 0, 2, 0x11, 0, 3, 0x11, 0];
        let scan = [0xff, START_OF_SCAN, 0, 8, 1, 1, 0, 0, 63, 0, 0xff, END_OF_IMAGE];
        whole(&[&frame[..], &scan].concat()).is_err_and(|error| error == ROWS_APART)
    };
    assert!(refused(0x22, 0xc0) && refused(0x12, 0xc1));
    // The decoder reads these.
    assert!(!refused(0x21, 0xc0) && !refused(0x11, 0xc0) && !refused(0x22, 0xc2));
}
