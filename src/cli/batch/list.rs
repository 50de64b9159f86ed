//! Pairs from a list: CSV or JSON lines.

use std::{
    fmt,
    io::{BufRead, Cursor, Read},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, anyhow, bail};
use hsad::io::read_whole;
use serde_core::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;

use super::pair::Pair;

/// Longest list that is read, in bytes.
const MOST: u64 = 1 << 30;

/// Fields of a pair. `left` is needed; `right` is not where `left` has both views.
const FIELDS: [&str; 4] = ["name", "left", "right", "calib"];

/// The texts of a row, by the places of [`FIELDS`].
type Texts<T> = [Option<T>; FIELDS.len()];

/// Whether a file is a list, by its extension.
pub fn is_list(path: &Path) -> bool {
    ["csv", "jsonl", "ndjson"].iter().any(|known| has_extension(path, known))
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

/// The text of a list. Its pairs, of which there may be millions, are made one by one.
pub struct List {
    path: PathBuf,
    text: String,
}

impl List {
    /// Reads a list.
    ///
    /// # Errors
    /// A file that cannot be read or is no text.
    pub fn read(path: &Path) -> Result<Self> {
        let text = String::from_utf8(read_whole(path, MOST)?);
        let text = text.map_err(|_| anyhow!("{}: the list is no text in UTF-8", hsad::shown(path)))?;
        Ok(Self { path: path.into(), text })
    }

    /// Where the rows begin, behind a byte order mark.
    fn beginning(&self) -> usize {
        self.text.len() - self.text.trim_start_matches('\u{feff}').len()
    }

    /// The pairs. Paths are relative to the list's folder; a pair without a name has that of its left view's file, without the extension.
    ///
    /// An error has the file, the line, and what is wrong with it.
    pub fn pairs(&self) -> Pairs<&[u8]> {
        Pairs::new(&self.text.as_bytes()[self.beginning()..], self.path.clone())
    }

    /// As [`Self::pairs`].
    pub fn into_pairs(self) -> Pairs<Cursor<String>> {
        let beginning = self.beginning() as u64;
        let mut text = Cursor::new(self.text);
        text.set_position(beginning);
        Pairs::new(text, self.path)
    }
}

/// The pairs of a list as they are read.
pub struct Pairs<R> {
    path: PathBuf,
    rows: Rows<R>,
}

enum Rows<R> {
    Csv(Box<Table<R>>),
    Json { from: R, number: u64, line: String },
}

impl<R: BufRead> Pairs<R> {
    fn new(from: R, path: PathBuf) -> Self {
        let rows = match has_extension(&path, "csv") {
            true => Rows::Csv(Table::new(from).into()),
            false => Rows::Json { from, number: 0, line: String::new() },
        };
        Self { path, rows }
    }

    fn pair(&mut self) -> Result<Option<Pair>> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        match &mut self.rows {
            Rows::Csv(table) => {
                let Some(line) = table.next()? else { return Ok(None) };
                pair(table.texts(), folder).map(Some).with_context(|| format!("line {line}"))
            }
            Rows::Json { from, number, line } => loop {
                line.clear();
                if from.read_line(line)? == 0 {
                    return Ok(None);
                }
                *number += 1;
                if !line.trim().is_empty() {
                    let texts = object(line).with_context(|| format!("line {number}"))?;
                    let texts = texts.each_ref().map(|text| text.as_deref());
                    return pair(texts, folder).map(Some).with_context(|| format!("line {number}"));
                }
            },
        }
    }
}

impl<R: BufRead> Iterator for Pairs<R> {
    type Item = Result<Pair>;

    fn next(&mut self) -> Option<Self::Item> {
        self.pair().map_err(|error| anyhow!("{}: {error:#}", hsad::shown(&self.path))).transpose()
    }
}

/// The rows of a CSV, one at a time.
struct Table<R> {
    reader: csv::Reader<R>,
    /// The columns of [`FIELDS`], once the first line was read.
    columns: Option<Texts<usize>>,
    row: csv::StringRecord,
}

impl<R: Read> Table<R> {
    fn new(from: R) -> Self {
        let reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(from);
        Self { reader, columns: None, row: csv::StringRecord::new() }
    }

    /// Reads the next row; the number of its line.
    fn next(&mut self) -> Result<Option<u64>> {
        if self.columns.is_none() {
            self.columns = Some(columns(self.reader.headers()?)?);
        }
        let is_there = self.reader.read_record(&mut self.row)?;
        Ok(is_there.then(|| self.row.position().map_or(0, csv::Position::line)))
    }

    fn texts(&self) -> Texts<&str> {
        self.columns.unwrap_or_default().map(|column| self.row.get(column?))
    }
}

fn columns(head: &csv::StringRecord) -> Result<Texts<usize>> {
    if let Some(unknown) = head.iter().find(|field| !FIELDS.contains(field)) {
        bail!("the first line names the columns, of {}: '{unknown}' is none of them", FIELDS.join(", "));
    }
    if let Some(twice) = FIELDS.iter().find(|&field| head.iter().filter(|named| named == field).count() > 1) {
        bail!("the first line names the column {twice} twice");
    }
    Ok(FIELDS.map(|field| head.iter().position(|named| named == field)))
}

/// The texts of an object in JSON.
fn object(line: &str) -> Result<Texts<String>> {
    let Object(texts) = serde_json::from_str(line).map_err(|error| {
        // Of the line itself, whose number is another one.
        anyhow!(error.to_string().replace(" at line 1 column ", " at column "))
    })?;
    texts.map_err(|reason| anyhow!(reason))
}

/// The fields of an object, or what is wrong with the first one that is wrong.
struct Object(Result<Texts<String>, String>);

impl<'a> Deserialize<'a> for Object {
    fn deserialize<D: Deserializer<'a>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_map(Fields)
    }
}

struct Fields;

impl<'a> Visitor<'a> for Fields {
    type Value = Object;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("an object with left and right")
    }

    fn visit_map<A: MapAccess<'a>>(self, mut map: A) -> Result<Object, A::Error> {
        let (mut texts, mut named) = (Texts::default(), [false; FIELDS.len()]);
        let mut wrong = None;
        while let Some(key) = map.next_key::<String>()? {
            let Some(place) = FIELDS.iter().position(|field| *field == key).filter(|_| wrong.is_none()) else {
                map.next_value::<IgnoredAny>()?;
                wrong.get_or_insert_with(|| format!("the fields are {}: '{key}' is none of them", FIELDS.join(", ")));
                continue;
            };
            match map.next_value()? {
                _ if named[place] => wrong = Some(format!("the field {key} is there twice")),
                Value::String(text) => texts[place] = Some(text),
                Value::Null => {}
                _ => wrong = Some(format!("{key} must be a text")),
            }
            named[place] = true;
        }
        Ok(Object(wrong.map_or(Ok(texts), Err)))
    }
}

/// The pair of a row, in which an empty text is none.
fn pair(texts: Texts<&str>, folder: &Path) -> Result<Pair> {
    let [name, left, right, calibration] = texts.map(|text| text.filter(|text| !text.is_empty()));
    let [left, right, calibration] = [left, right, calibration].map(|path| path.map(|path| folder.join(path)));
    let left = left.ok_or_else(|| anyhow!("there is no left view"))?;
    let stem = || left.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Pair { name: name.map_or_else(stem, str::to_owned), left, right, calibration })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn listed(name: &str, text: &str) -> Result<Vec<Pair>> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join(name);
        fs::write(&file, text).expect("a file");
        let mut pairs = List::read(&file)?.pairs().collect::<Result<Vec<_>>>()?;
        assert_eq!(List::read(&file)?.into_pairs().collect::<Result<Vec<_>>>()?, pairs);
        // Paths without the folder.
        let bare = |path: &mut PathBuf| *path = path.strip_prefix(folder.path()).unwrap_or(path).to_path_buf();
        for pair in &mut pairs {
            bare(&mut pair.left);
            [&mut pair.right, &mut pair.calibration].into_iter().flatten().for_each(bare);
        }
        Ok(pairs)
    }

    fn pair(name: &str, left: &str, right: Option<&str>, calibration: Option<&str>) -> Pair {
        let path = |text: &str| PathBuf::from(text);
        Pair { name: name.into(), left: left.into(), right: right.map(path), calibration: calibration.map(path) }
    }

    #[test]
    fn both_kinds_of_list_say_the_same() {
        let expected = [
            pair("l1", "a/l1.png", Some("a/r1.png"), None),
            pair("second, and last", "/b/l2.mpo", None, Some("calib.txt")),
        ];
        let csv =
            "name,left,right,calib\n,a/l1.png,a/r1.png,\n# a remark\n\"second, and last\", /b/l2.mpo ,,calib.txt\n";
        assert_eq!(listed("pairs.csv", csv).expect("a list"), expected);
        let json = "{\"left\": \"a/l1.png\", \"right\": \"a/r1.png\"}\n\n\
                    {\"name\": \"second, and last\", \"left\": \"/b/l2.mpo\", \"right\": null, \"calib\": \"calib.txt\"}\n";
        assert_eq!(listed("pairs.jsonl", json).expect("a list"), expected);
    }

    #[test]
    fn mistakes_are_told_with_their_line() {
        for (name, text, told) in [
            ("a.csv", "left,rigth\na,b\n", "'rigth' is none of them"),
            ("a.csv", "left,right,left\na,b,c\n", "the column left twice"),
            ("a.csv", "left,right\na,b\n,c\n", "line 3: there is no left view"),
            ("a.csv", "left,right\na,b\na\n", "line: 3"),
            ("a.jsonl", "{\"left\": 3}\n", "line 1: left must be a text"),
            (
                "a.jsonl",
                "{\"left\": \"a\"}\n[]\n",
                "line 2: invalid type: sequence, expected an object with left and right",
            ),
            ("a.jsonl", "\n{\"left\": \"a\"\n", "line 2: EOF while parsing an object at"),
            ("a.jsonl", "{\"left\": \"a\"} 7\n", "line 1: trailing characters at column 15"),
            ("a.jsonl", "{}\n", "line 1: there is no left view"),
            ("a.jsonl", "{\"left\": \"a\", \"left\": \"b\"}\n", "line 1: the field left is there twice"),
            ("a.jsonl", "{\"left\": \"a\", \"right\": null, \"right\": 3}\n", "line 1: the field right is there twice"),
            ("a.jsonl", "\u{feff}{\"left\": \"a\", \"calb\": \"b\"}\n", "'calb' is none of them"),
        ] {
            let error = listed(name, text).expect_err(told).to_string();
            assert!(error.contains(told), "{told}: {error}");
        }
    }
}
