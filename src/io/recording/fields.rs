//! The fields of a ROS message, one after the other: CDR of ROS 2 (OMG's Common Data Representation, version 1), and ROS 1.

use super::Told;

/// How the messages of a topic are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Cdr,
    Ros1,
}

/// What is left of a message.
pub(super) struct Fields<'a> {
    /// The message, without the four bytes of CDR that tell the order of bytes.
    bytes: &'a [u8],
    place: usize,
    encoding: Encoding,
    is_big_endian: bool,
}

/// First bytes of what rosbag2 has compressed message by message.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

impl<'a> Fields<'a> {
    pub fn of(message: &'a [u8], encoding: Encoding) -> Told<Self> {
        let (bytes, is_big_endian) = match (encoding, message.split_first_chunk::<4>()) {
            (Encoding::Ros1, _) => (message, false),
            (Encoding::Cdr, Some(([0, order @ (0 | 1), ..], bytes))) => (bytes, *order == 0),
            (Encoding::Cdr, Some((&ZSTD, _))) => {
                return Err(
                    "rosbag2 has compressed the messages one by one (--compression-mode message): ros2 bag convert \
                            writes them without"
                        .into(),
                );
            }
            (Encoding::Cdr, _) => return Err("the message is not in CDR".into()),
        };
        Ok(Self { bytes, place: 0, encoding, is_big_endian })
    }

    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The next `length` bytes.
    fn take(&mut self, length: usize) -> Told<&'a [u8]> {
        let rest = self.bytes.get(self.place..).unwrap_or_default();
        let Some(taken) = rest.get(..length) else {
            return Err(format!("the message is cut off: {length} bytes should follow, and {} do", rest.len()));
        };
        self.place += length;
        Ok(taken)
    }

    /// A number of `N` bytes, the lowest first. CDR places it at a multiple of its length.
    fn number<const N: usize>(&mut self) -> Told<[u8; N]> {
        if self.encoding == Encoding::Cdr {
            self.place = self.place.next_multiple_of(N);
        }
        let mut number = [0; N];
        number.copy_from_slice(self.take(N)?);
        if self.is_big_endian {
            number.reverse();
        }
        Ok(number)
    }

    pub fn u8(&mut self) -> Told<u8> {
        self.number().map(u8::from_le_bytes)
    }

    pub fn u32(&mut self) -> Told<u32> {
        self.number().map(u32::from_le_bytes)
    }

    /// Bytes behind their number.
    pub fn bytes(&mut self) -> Told<&'a [u8]> {
        let length = self.u32()?;
        self.take(length as usize)
    }

    /// A text; CDR ends it with a zero.
    pub fn text(&mut self) -> Told<String> {
        let bytes = self.bytes()?;
        let bytes = if self.encoding == Encoding::Cdr { bytes.strip_suffix(&[0]).unwrap_or(bytes) } else { bytes };
        Ok(String::from_utf8_lossy(bytes).into_owned())
    }

    pub fn floats<const N: usize>(&mut self) -> Told<[f64; N]> {
        let mut floats = [0.0; N];
        for float in &mut floats {
            *float = self.number().map(f64::from_le_bytes)?;
        }
        Ok(floats)
    }

    /// Floats behind their number, of which there are at most `most`.
    pub fn list_of_floats(&mut self, most: u32) -> Told<Vec<f64>> {
        let count = self.u32()?;
        if count > most {
            return Err(format!("a list has {count} numbers, of at most {most}"));
        }
        (0..count).map(|_| self.floats().map(|[float]| float)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_cdr_stand_at_multiples_of_their_length() {
        let little = [0, 1, 0, 0, 7, 0xff, 0xff, 0xff, 1, 2, 0, 0, 3, 0, 0, 0, b'a', b'b', 0];
        let mut fields = Fields::of(&little, Encoding::Cdr).unwrap();
        assert_eq!((fields.u8().unwrap(), fields.u32().unwrap(), fields.text().unwrap()), (7, 0x201, "ab".into()));
        assert_eq!(fields.u8().unwrap_err(), "the message is cut off: 1 bytes should follow, and 0 do");
        let big = [0, 0, 0, 0, 0, 0, 2, 1, 9, 9, 9, 9, 0x3f, 0xf0, 0, 0, 0, 0, 0, 0];
        let mut fields = Fields::of(&big, Encoding::Cdr).unwrap();
        assert_eq!((fields.u32().unwrap(), fields.floats().unwrap()), (0x201, [1.0]));
        let unaligned = [7, 1, 2, 0, 0, 2, 0, 0, 0, b'a', b'b'];
        let mut fields = Fields::of(&unaligned, Encoding::Ros1).unwrap();
        assert_eq!((fields.u8().unwrap(), fields.u32().unwrap(), fields.text().unwrap()), (7, 0x201, "ab".into()));
    }

    #[test]
    fn lengths_are_not_believed() {
        for message in [&[0, 1, 0, 0, 255, 255, 255, 255][..], &[0, 1, 0, 0, 3, 0, 0, 0, 0, 0], &[0, 1, 0, 0, 1]] {
            assert!(Fields::of(message, Encoding::Cdr).unwrap().bytes().is_err(), "{message:?}");
            assert!(Fields::of(message, Encoding::Cdr).unwrap().list_of_floats(9).is_err(), "{message:?}");
        }
        for (message, told) in [(&[0, 7, 0, 0][..], "not in CDR"), (&[0, 1], "not in CDR"), (&ZSTD, "ros2 bag convert")]
        {
            let error = Fields::of(message, Encoding::Cdr).err().unwrap();
            assert!(error.contains(told), "{error}");
        }
    }
}
