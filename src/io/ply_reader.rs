//! Reading of point clouds: the vertices of PLY files of any byte order or in text, with or without colours.

use std::path::Path;

use super::{malformed, ply::Point, read_whole};
use crate::error::Result;

/// Longest file that is read, in bytes: the points of the largest picture, with a double or two more per point.
const MAX_BYTES: u64 = 1 << 32;

/// Reads the points of a PLY file; those without colours are white.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read, otherwise as [`decode`].
pub fn read(path: &Path) -> Result<Vec<Point>> {
    decode(&read_whole(path, MAX_BYTES)?, path)
}

/// Decodes the points of a PLY; `path` is named in errors. Colours are `red`, `green` and `blue`, of 8 bits; other properties of
/// vertices and other elements behind them are left out.
///
/// # Errors
/// [`crate::Error::Format`] for a header that is none, vertices without x, y and z or with lists, elements before them, and fewer
/// vertices than the header says.
pub fn decode(bytes: &[u8], path: &Path) -> Result<Vec<Point>> {
    let (header, body) = Header::split(bytes, path)?;
    let place = |name: &str| header.properties.iter().position(|property| property.name == name);
    let coordinates = ["x", "y", "z"].map(place);
    let [Some(x), Some(y), Some(z)] = coordinates else {
        return Err(malformed(path, "its vertices have no x, y and z"));
    };
    let colors = ["red", "green", "blue"].map(place);
    let mut values = vec![0.0; header.properties.len()];
    let mut rest = body;
    // The count is not trusted: memory is taken for vertices that are there.
    let mut points = Vec::new();
    for vertex in 0..header.count {
        rest = header.vertex(rest, &mut values).ok_or_else(|| {
            malformed(path, format!("it ends at vertex {vertex} of {}: copy or write it again", header.count))
        })?;
        let color = colors.map(|place| place.map_or(255, |place| values[place] as u8));
        points.push(Point { position: [x, y, z].map(|place| values[place] as f32), color });
    }
    Ok(points)
}

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// The first number of `bytes`, and the rest.
    fn take(self, bytes: &[u8], encoding: Encoding) -> Option<(f64, &[u8])> {
        fn first<const N: usize>(bytes: &[u8], encoding: Encoding) -> Option<([u8; N], &[u8])> {
            let (&(mut number), rest) = bytes.split_first_chunk()?;
            if encoding == Encoding::BigEndian {
                number.reverse();
            }
            Some((number, rest))
        }
        macro_rules! number {
            ($type:ty) => {{
                let (number, rest) = first(bytes, encoding)?;
                (<$type>::from_le_bytes(number) as f64, rest)
            }};
        }
        Some(match self {
            Self::I8 => number!(i8),
            Self::U8 => number!(u8),
            Self::I16 => number!(i16),
            Self::U16 => number!(u16),
            Self::I32 => number!(i32),
            Self::U32 => number!(u32),
            Self::F32 => number!(f32),
            Self::F64 => number!(f64),
        })
    }
}

struct Property {
    name: String,
    number: Number,
}

struct Header {
    encoding: Encoding,
    count: u64,
    properties: Vec<Property>,
}

impl Header {
    /// The header, and what follows.
    fn split<'a>(bytes: &'a [u8], path: &Path) -> Result<(Self, &'a [u8])> {
        let mut rest = bytes;
        let mut line = || -> Option<Vec<String>> {
            let end = rest.iter().position(|&byte| byte == b'\n')?;
            let words = String::from_utf8_lossy(&rest[..end]).split_whitespace().map(String::from).collect();
            rest = &rest[end + 1..];
            Some(words)
        };
        if line().is_none_or(|words| words != ["ply"]) {
            return Err(malformed(path, "not a PLY: it does not begin with the line 'ply'"));
        }
        let (mut encoding, mut count, mut properties) = (None, None, Vec::new());
        // Whether the properties are those of an element behind the vertices.
        let mut is_behind = false;
        loop {
            let Some(words) = line() else {
                return Err(malformed(path, "its header has no end: copy or write it again"));
            };
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            match words[..] {
                ["end_header"] => break,
                ["format", name, "1.0"] => {
                    encoding = match name {
                        "ascii" => Some(Encoding::Text),
                        "binary_little_endian" => Some(Encoding::LittleEndian),
                        "binary_big_endian" => Some(Encoding::BigEndian),
                        _ => None,
                    }
                }
                ["element", "vertex", number] => count = number.parse().ok(),
                ["element", ..] if count.is_none() => {
                    return Err(malformed(path, "it has an element before its vertices: vertices must come first"));
                }
                ["element", ..] => is_behind = true,
                ["property", ..] if is_behind => {}
                ["property", kind, name] => match Number::named(kind) {
                    Some(number) => properties.push(Property { name: name.into(), number }),
                    None => return Err(malformed(path, format!("its vertices have a property of '{kind}'"))),
                },
                ["property", "list", ..] => return Err(malformed(path, "its vertices have a list")),
                _ => {}
            }
        }
        match (encoding, count) {
            (Some(encoding), Some(count)) => Ok((Self { encoding, count, properties }, rest)),
            (None, _) => {
                Err(malformed(path, "its format is none of ascii, binary_little_endian and binary_big_endian 1.0"))
            }
            (_, None) => Err(malformed(path, "it has no vertices, or no number of them")),
        }
    }

    /// Reads the values of a vertex, and returns what follows; `None` where the file ends.
    fn vertex<'a>(&self, bytes: &'a [u8], values: &mut [f64]) -> Option<&'a [u8]> {
        if self.encoding == Encoding::Text {
            let end = bytes.iter().position(|&byte| byte == b'\n').unwrap_or(bytes.len());
            let (line, rest) = bytes.split_at(end);
            let mut words = std::str::from_utf8(line).ok()?.split_ascii_whitespace();
            values.iter_mut().try_for_each(|value| {
                *value = words.next()?.parse().ok()?;
                Some(())
            })?;
            return Some(rest.get(1..).unwrap_or_default());
        }
        let mut rest = bytes;
        for (property, value) in self.properties.iter().zip(values) {
            (*value, rest) = property.number.take(rest, self.encoding)?;
        }
        Some(rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::ply::write;

    const POINTS: [Point; 2] = [
        Point { position: [1.0, -2.0, 0.5], color: [1, 2, 3] },
        Point { position: [0.25, 3.0, -4.5], color: [255, 0, 7] },
    ];

    fn decoded(bytes: &[u8]) -> Result<Vec<Point>> {
        decode(bytes, Path::new("cloud.ply"))
    }

    #[test]
    fn what_was_written_comes_back() {
        let mut bytes = Vec::new();
        write(&mut bytes, &POINTS).unwrap();
        assert_eq!(decoded(&bytes).unwrap(), POINTS);
    }

    #[test]
    fn other_programs_files_are_read() {
        let text = "ply\r\nformat ascii 1.0\ncomment by hand\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\n\
                    property float quality\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
                    property list uchar int vertex_indices\nend_header\n1 -2 0.5 9 1 2 3\n0.25 3 -4.5 9 255 0 7\n3 0 0 0\n";
        assert_eq!(decoded(text.as_bytes()).unwrap(), POINTS);
        let mut big = b"ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty double y\nproperty short z\nend_header\n".to_vec();
        big.extend(1.5_f32.to_be_bytes());
        big.extend((-2.5_f64).to_be_bytes());
        big.extend((-3_i16).to_be_bytes());
        assert_eq!(decoded(&big).unwrap(), [Point { position: [1.5, -2.5, -3.0], color: [255; 3] }]);
    }

    #[test]
    fn damage_is_named() {
        let mut cut = Vec::new();
        write(&mut cut, &POINTS).unwrap();
        cut.pop();
        let head = "ply\nformat ascii 1.0\n";
        for (bytes, expected) in [
            (cut, "it ends at vertex 1 of 2"),
            (b"PLY\n".to_vec(), "not a PLY"),
            (b"ply\nformat ascii 1.0\n".to_vec(), "no end"),
            (b"ply\nelement vertex 1\nend_header\n".to_vec(), "its format is none of"),
            (format!("{head}end_header\n").into(), "no vertices"),
            (format!("{head}element face 1\nelement vertex 1\nend_header\n").into(), "before its vertices"),
            (format!("{head}element vertex 1\nproperty float x\nend_header\n1\n").into(), "no x, y and z"),
            (format!("{head}element vertex 1\nproperty half x\nend_header\n1\n").into(), "a property of 'half'"),
            (format!("{head}element vertex 1\nproperty list uchar int x\nend_header\n1\n").into(), "a list"),
            (format!("{head}element vertex 99999999999\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 a\n").into(), "it ends at vertex 0"),
        ] {
            let error = decoded(&bytes).unwrap_err().to_string();
            assert!(error.starts_with("cloud.ply: ") && error.contains(expected), "{error}");
        }
    }
}
