//! Multi-picture files (MPO) of cameras with two lenses: a JPEG per view, one behind the other.
//!
//! The first JPEG has an index of all of them in an APP2 segment: 'MPF', then a directory as in TIFF, whose tag B002 has 16 bytes per
//! picture ('Multi-Picture Format', CIPA DC-007, 2009, sections 5.1 and 5.2). Pictures of different views are numbered from left to
//! right.

use super::jpeg;

const APP2: u8 = 0xe2;
const NAME: &[u8] = b"MPF\0";
/// The tag of the list of pictures.
const ENTRIES: u32 = 0xb002;
/// Bytes of an entry: attributes, size and offset of 32 bits each, and two numbers of dependent pictures.
const ENTRY: usize = 16;
/// Class of the large thumbnails in an entry's attributes, 8 bits from bit 16 on.
const THUMBNAIL: u32 = 1;

/// The JPEGs of the left and the right view; `None` unless `bytes` are a multi-picture file of at least two views.
///
/// # Errors
/// Why a multi-picture file cannot be read.
pub(super) fn views(bytes: &[u8]) -> Result<Option<[&[u8]; 2]>, &'static str> {
    const DAMAGED: &str = "the index of the multi-picture file is damaged, or the file is cut off: copy it again";
    let Some(start) = jpeg::app_segment(bytes, APP2, NAME) else { return Ok(None) };
    let entries = Index::new(&bytes[start..]).and_then(|index| index.entries()).ok_or(DAMAGED)?;
    let views: Option<Vec<&[u8]>> = entries
        .iter()
        .filter(|entry| entry.attributes >> 16 & 0xff != THUMBNAIL)
        .take(2)
        .map(|entry| {
            // The first picture begins with the file, the others are counted from the index on.
            let begin = if entry.offset == 0 { 0 } else { start.checked_add(entry.offset as usize)? };
            bytes.get(begin..begin.checked_add(entry.size as usize)?)
        })
        .collect();
    let views = views.ok_or(DAMAGED)?;
    Ok(views.try_into().ok())
}

/// A picture of the list.
struct Entry {
    attributes: u32,
    /// Bytes of the JPEG.
    size: u32,
    /// Its position from the index on; 0 for the first picture.
    offset: u32,
}

/// The index and what follows it.
struct Index<'a> {
    bytes: &'a [u8],
    is_big_endian: bool,
}

impl<'a> Index<'a> {
    fn new(bytes: &'a [u8]) -> Option<Self> {
        match bytes.get(..4)? {
            b"II*\0" => Some(Self { bytes, is_big_endian: false }),
            b"MM\0*" => Some(Self { bytes, is_big_endian: true }),
            _ => None,
        }
    }

    fn entries(&self) -> Option<Vec<Entry>> {
        let directory = self.u32(4)? as usize;
        let fields = (0..self.u16(directory)?).map(|i| directory.checked_add(2 + 12 * i as usize));
        let field = fields.flatten().find(|&field| self.u16(field) == Some(ENTRIES))?;
        let (count, list) = (self.u32(field + 4)? as usize / ENTRY, self.u32(field + 8)? as usize);
        let entry = |i: usize| {
            let at = list.checked_add(ENTRY.checked_mul(i)?)?;
            Some(Entry { attributes: self.u32(at)?, size: self.u32(at + 4)?, offset: self.u32(at + 8)? })
        };
        // A list that claims more entries than there are bytes ends with them.
        (0..count.min(self.bytes.len() / ENTRY)).map(entry).collect()
    }

    fn u16(&self, at: usize) -> Option<u32> {
        let bytes = self.bytes.get(at..at.checked_add(2)?)?.try_into().ok()?;
        Some(if self.is_big_endian { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) }.into())
    }

    fn u32(&self, at: usize) -> Option<u32> {
        let bytes = self.bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(if self.is_big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three pictures of 8, 6 and 5 bytes behind a start-of-image marker, a comment and the index, of these attributes.
    fn file(attributes: [u32; 3], is_big_endian: bool) -> Vec<u8> {
        let u16 = |value: u16| if is_big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
        let u32 = |value: u32| if is_big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
        let mut index = if is_big_endian { b"MM\0*".to_vec() } else { b"II*\0".to_vec() };
        index.extend([u32(8)].concat());
        index.extend([u16(2), u16(0xb000), u16(7)].concat());
        index.extend([u32(4), *b"0100"].concat());
        index.extend([u16(0xb002), u16(7)].concat());
        index.extend([u32(48), u32(38), u32(0)].concat());
        // The index is followed by an end-of-image marker and the other pictures.
        let end = index.len() as u32 + 48 + 2;
        for (i, (size, offset)) in [(20 + end, 0), (6, end), (5, end + 6)].into_iter().enumerate() {
            index.extend([u32(attributes[i]), u32(size), u32(offset), u32(0)].concat());
        }
        let mut bytes = vec![0xff, 0xd8, 0xff, 0xfe, 0, 8, 1, 2, 3, 4, 5, 6, 0xff, 0xe2];
        bytes.extend((index.len() as u16 + 6).to_be_bytes());
        bytes.extend(b"MPF\0");
        bytes.extend(&index);
        bytes.extend([0xff, 0xd9]);
        bytes.extend(b"secondthird");
        bytes
    }

    #[test]
    fn the_first_two_views_are_found() {
        for is_big_endian in [false, true] {
            let bytes = file([0x2002_0002, 0x0002_0002, 0], is_big_endian);
            let [left, right] = views(&bytes).unwrap().unwrap();
            assert!(left.starts_with(&[0xff, 0xd8]) && left.ends_with(&[0xff, 0xd9]) && right == b"second");
            let bytes = file([0x2003_0000, 0x0001_0002, 0x0002_0002], is_big_endian);
            assert_eq!(views(&bytes).unwrap().unwrap()[1], b"third", "a thumbnail is no view");
            assert_eq!(views(&file([0x2003_0000, 0x0001_0002, 0x0001_0001], is_big_endian)), Ok(None));
        }
        for other in
            [&b""[..], b"\xff\xd8", b"\xff\xd8\xff\xda\0\x02MPF\0", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff\xe2\0\0MPF"]
        {
            assert_eq!(views(other), Ok(None));
        }
    }

    #[test]
    fn damage_is_told() {
        let bytes = file([0; 3], false);
        for length in 0..bytes.len() {
            let found = views(&bytes[..length]);
            let second_is_there = length >= bytes.len() - 5;
            assert!(
                found.is_err() || found == Ok(None) && length < 20 + 86 || found.is_ok() && second_is_there,
                "{length}"
            );
        }
        for at in 14..bytes.len() {
            for value in [0, 1, 0x7f, 0xff] {
                let mut bytes = bytes.clone();
                bytes[at] = value;
                let _ = views(&bytes);
            }
        }
        let mut bytes = bytes;
        let index = bytes.windows(4).position(|window| window == b"II*\0").unwrap();
        bytes[index] = b'J';
        assert!(views(&bytes).unwrap_err().contains("is damaged"));
    }
}
