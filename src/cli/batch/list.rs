//! Pairs from a list: CSV or JSON lines.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, anyhow, bail};
use hsad::io::read_whole;
use serde_json::Value;

use super::pair::Pair;

/// Longest list that is read, in bytes.
const MOST: u64 = 1 << 30;

/// Fields of a pair. `left` is needed; `right` is not where `left` has both views.
const FIELDS: [&str; 4] = ["name", "left", "right", "calib"];

/// Whether a file is a list, by its extension.
pub fn is_list(path: &Path) -> bool {
    ["csv", "jsonl", "ndjson"].iter().any(|known| has_extension(path, known))
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

/// Reads a list. Paths are relative to its folder; a pair without a name has that of its left view's file, without the extension.
///
/// # Errors
/// The file, or the line, and what is wrong with it.
pub fn read(path: &Path) -> Result<Vec<Pair>> {
    let bytes = read_whole(path, MOST)?;
    let text = String::from_utf8(bytes).map_err(|_| anyhow!("{}: the list is no text in UTF-8", hsad::shown(path)))?;
    let text = text.trim_start_matches('\u{feff}');
    let rows = if has_extension(path, "csv") { csv_rows(text) } else { json_rows(text) };
    let folder = path.parent().unwrap_or(Path::new(""));
    rows.and_then(|rows| {
        rows.into_iter().map(|(line, row)| pair(&row, folder).with_context(|| format!("line {line}"))).collect()
    })
    .map_err(|error| anyhow!("{}: {error:#}", hsad::shown(path)))
}

/// The texts of a line by their fields; an empty text is none.
type Row = HashMap<String, String>;

fn csv_rows(text: &str) -> Result<Vec<(u64, Row)>> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let head = reader.headers()?.clone();
    if let Some(unknown) = head.iter().find(|field| !FIELDS.contains(field)) {
        bail!("the first line names the columns, of {}: '{unknown}' is none of them", FIELDS.join(", "));
    }
    if let Some(twice) = FIELDS.iter().find(|&field| head.iter().filter(|named| named == field).count() > 1) {
        bail!("the first line names the column {twice} twice");
    }
    let row = |record: csv::StringRecord| {
        let line = record.position().map_or(0, csv::Position::line);
        (line, head.iter().zip(&record).map(|(field, text)| (field.to_owned(), text.to_owned())).collect())
    };
    reader.records().map(|record| Ok(row(record?))).collect()
}

fn json_rows(text: &str) -> Result<Vec<(u64, Row)>> {
    let lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let row = |(line, text): (u64, &str)| {
        let value: Value = serde_json::from_str(text).with_context(|| format!("line {line}"))?;
        let object = value.as_object().ok_or_else(|| anyhow!("line {line}: expected an object with left and right"))?;
        if let Some(unknown) = object.keys().find(|field| !FIELDS.contains(&field.as_str())) {
            bail!("line {line}: the fields are {}: '{unknown}' is none of them", FIELDS.join(", "));
        }
        let known = object.iter().filter(|(_, value)| !value.is_null());
        let text = |(field, value): (&String, &Value)| {
            let text = value.as_str().ok_or_else(|| anyhow!("line {line}: {field} must be a text"))?;
            Ok((field.clone(), text.to_owned()))
        };
        Ok((line, known.map(text).collect::<Result<_>>()?))
    };
    lines.map(row).collect()
}

fn pair(row: &Row, folder: &Path) -> Result<Pair> {
    let text = |field: &str| row.get(field).map(String::as_str).filter(|text| !text.is_empty());
    let path = |field: &str| text(field).map(|text| folder.join(text));
    let left: PathBuf = path("left").ok_or_else(|| anyhow!("there is no left view"))?;
    let stem = || left.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let name = text("name").map_or_else(stem, str::to_owned);
    Ok(Pair { name, right: path("right"), calibration: path("calib"), left })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn listed(name: &str, text: &str) -> Result<Vec<Pair>> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join(name);
        fs::write(&file, text).expect("a file");
        let mut pairs = read(&file)?;
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
            ("a.jsonl", "{\"left\": \"a\"}\n[]\n", "line 2: expected an object"),
            ("a.jsonl", "{\"left\": \"a\"\n", "line 1"),
            ("a.jsonl", "\u{feff}{\"left\": \"a\", \"calb\": \"b\"}\n", "'calb' is none of them"),
        ] {
            let error = listed(name, text).expect_err(told).to_string();
            assert!(error.contains(told), "{told}: {error}");
        }
    }
}
