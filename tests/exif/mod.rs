//! JPEG with an EXIF orientation.

use image::{GrayImage, Luma, codecs::jpeg::JpegEncoder};

/// A grey JPEG whose EXIF, a TIFF directory with one entry (0x112, a short), has `orientation`, 1 to 8.
pub fn turned_jpeg(width: u32, height: u32, orientation: u8) -> Vec<u8> {
    let mut exif = b"Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\0\0\0\0\0\0\0\0".to_vec();
    exif[24] = orientation;
    let mut bytes = Vec::new();
    let picture = GrayImage::from_fn(width, height, |x, y| Luma([(x * y) as u8]));
    JpegEncoder::new(&mut bytes).encode_image(&picture).expect("a JPEG in memory");
    let length = (exif.len() as u16 + 2).to_be_bytes();
    bytes.splice(2..2, [&[0xff, 0xe1], &length[..], &exif].concat());
    bytes
}
