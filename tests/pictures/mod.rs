//! Pictures that no encoder at hand makes.

/// A TIFF of one CMYK pixel: header, directory of ten entries, bits of each sample, the pixel.
pub fn cmyk_tiff() -> Vec<u8> {
    let bits_at = 8 + 2 + 9 * 12 + 4;
    let entries: [(u16, u16, u32, u32); 9] = [
        (256, 3, 1, 1),
        (257, 3, 1, 1),
        (258, 3, 4, bits_at),
        (259, 3, 1, 1),
        // Photometric interpretation: separated.
        (262, 3, 1, 5),
        (273, 4, 1, bits_at + 8),
        (277, 3, 1, 4),
        (278, 3, 1, 1),
        (279, 4, 1, 4),
    ];
    let mut bytes = b"II*\0\x08\0\0\0\x09\0".to_vec();
    for (tag, kind, count, value) in entries {
        bytes.extend(tag.to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(count.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend([0, 0, 0, 0, 8, 0, 8, 0, 8, 0, 8, 0, 10, 20, 30, 40]);
    bytes
}
