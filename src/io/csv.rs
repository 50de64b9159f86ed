//! Tables of numbers: comma-separated values with a header row.
//!
//! Columns are identified by name and may come in any order, with other columns among them. Blank lines are skipped;
//! quotes are not supported, since numbers need none.

use std::path::Path;

use super::{malformed, read_whole};
use crate::error::{Error, Result};

/// Longest table that is read, in bytes.
const MAX_BYTES: u64 = 1 << 30;

/// The requested columns of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// For each row its line in the file, counted from 1, and its values in the order of the requested columns.
    pub rows: Vec<(usize, Vec<f64>)>,
    /// For each optional column whether the table has it; the values of optional columns follow those of the needed
    /// ones.
    pub has: Vec<bool>,
}

/// Reads the columns `needed` of a table, and the columns of `optional` that it has.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, otherwise as [`decode`].
pub fn read(path: &Path, needed: &[&str], optional: &[&str]) -> Result<Table> {
    decode(&read_whole(path, MAX_BYTES)?, path, needed, optional)
}

/// Decodes the columns of a table from a file's bytes; `path` is named in errors.
///
/// # Errors
/// [`Error::Format`] if a needed column is missing, or with the line of a row that is too short or of a value that is
/// no finite number.
pub fn decode(bytes: &[u8], path: &Path, needed: &[&str], optional: &[&str]) -> Result<Table> {
    let text = std::str::from_utf8(bytes).map_err(|_| malformed(path, "not a table: it is no UTF-8 text"))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let header: Vec<&str> = lines.next().map_or(Vec::new(), |(_, line)| line.split(',').map(str::trim).collect());
    let place = |name: &str| header.iter().position(|&column| column == name);
    let mut columns = Vec::new();
    for &name in needed {
        let Some(place) = place(name) else {
            let reason = format!("the header has no column '{name}': it must have {}", needed.join(", "));
            return Err(malformed(path, reason));
        };
        columns.push((name, place));
    }
    let has: Vec<bool> = optional.iter().map(|name| place(name).is_some()).collect();
    columns.extend(optional.iter().filter_map(|&name| Some((name, place(name)?))));
    let rows = lines
        .map(|(line, text)| {
            let values: Vec<&str> = text.split(',').map(str::trim).collect();
            let value = |&(name, place): &(&str, usize)| {
                let text = values.get(place).ok_or_else(|| at(path, line, format!("it has no {name}")))?;
                let number = text.parse().ok().filter(|number: &f64| number.is_finite());
                number.ok_or_else(|| at(path, line, format!("{name} is '{text}', but it must be a number")))
            };
            Ok((line, columns.iter().map(value).collect::<Result<_>>()?))
        })
        .collect::<Result<_>>()?;
    Ok(Table { rows, has })
}

/// An error at a line of a table.
pub fn at(path: &Path, line: usize, reason: impl AsRef<str>) -> Error {
    malformed(path, format!("line {line}: {}", reason.as_ref()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<Table> {
        decode(text.as_bytes(), Path::new("t.csv"), &["x", "y"], &["c", "d"])
    }

    #[test]
    fn columns_come_in_any_order() {
        let read = table("\u{feff}y, note,x,d\r\n1,a b,-2.5,7\r\n\r\n3e2,,4,8\r\n").unwrap();
        assert_eq!(read.has, [false, true]);
        assert_eq!(read.rows, [(2, vec![-2.5, 1.0, 7.0]), (4, vec![4.0, 300.0, 8.0])]);
        assert_eq!(table("x,y\n").unwrap().rows, []);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, expected) in [
            ("", "no column 'x': it must have x, y"),
            ("x,z\n1,2\n", "no column 'y'"),
            ("x,y\n1,2\n\n3,b\n", "line 4: y is 'b', but it must be a number"),
            ("x,y\n1,inf\n", "line 2: y is 'inf'"),
            ("x,y\n1\n", "line 2: it has no y"),
        ] {
            let error = table(text).unwrap_err().to_string();
            assert!(error.starts_with("t.csv: ") && error.contains(expected), "{error}");
        }
        assert!(decode(&[0xff, 0xfe, b'x'], Path::new("t"), &["x"], &[]).unwrap_err().to_string().contains("UTF-8"));
    }
}
