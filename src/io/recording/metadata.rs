//! What rosbag2 writes beside the files of a recording: their names.

use std::{
    collections::HashSet,
    ffi::OsStr,
    path::{Path, PathBuf},
};

use saphyr_parser::{Event, Parser};

use super::{LISTED, Told, has_extension};
use crate::{
    error::{Result, shown},
    io::{malformed, read_whole},
};

/// The file of the names.
pub(super) const METADATA: &str = "metadata.yaml";
/// Its entry that has them.
const PARTS: &str = "relative_file_paths";
/// Longest such file that is read, in bytes.
const MOST: u64 = 1 << 26;

/// Checks that `files` are all files of the recording in a folder, as far as rosbag2 tells.
///
/// # Errors
/// [`crate::Error::Format`] with the files that the folder lacks, and for names that cannot be read; [`crate::Error::Io`].
pub(super) fn check(folder: &Path, files: &[PathBuf]) -> Result<()> {
    let path = folder.join(METADATA);
    if !path.is_file() {
        return Ok(());
    }
    let bytes = read_whole(&path, MOST)?;
    let named = parts(&String::from_utf8_lossy(&bytes)).map_err(|reason| {
        let way_out = "which files the recording has is not known: remove this one, or ros2 bag reindex writes it anew";
        malformed(&path, format!("{reason}: {way_out}"))
    })?;
    let there: HashSet<&OsStr> = files.iter().filter_map(|file| file.file_name()).collect();
    let lacking: Vec<&str> =
        named.iter().map(String::as_str).filter(|&name| !there.contains(OsStr::new(name))).collect();
    if lacking.is_empty() {
        return Ok(());
    }
    let listed: Vec<String> = lacking.iter().take(LISTED).map(|name| shown(Path::new(name))).collect();
    let more = if lacking.len() > LISTED { ", ..." } else { "" };
    let reason = format!(
        "the folder lacks {} of the files that are named there ({}{more}): bring them back, or ros2 bag reindex names those that are there",
        lacking.len(),
        listed.join(", ")
    );
    Err(malformed(&path, reason))
}

/// The names of the MCAP files, without their folders, and as they are called once they are decompressed.
fn parts(text: &str) -> Told<Vec<String>> {
    let (mut names, mut entry, mut is_list) = (Vec::new(), String::new(), false);
    for event in Parser::new_from_str(text) {
        match event.map_err(|error| error.to_string())?.0 {
            Event::Scalar(name, ..) if is_list => names.push(name.into_owned()),
            Event::Scalar(name, ..) => entry = name.into_owned(),
            Event::SequenceStart(..) => is_list = entry == PARTS,
            Event::SequenceEnd if is_list => break,
            _ => entry.clear(),
        }
    }
    let name = |path: &String| {
        let name = path.rsplit('/').next()?;
        Some(name.strip_suffix(".zstd").unwrap_or(name).to_owned())
    };
    Ok(names.iter().filter_map(name).filter(|name| has_extension(Path::new(name), "mcap")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_found_in_every_version_of_the_format() {
        let found = |text: &str| parts(text).unwrap();
        let text = "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  relative_file_paths:\n    - ride_0.mcap\n    - \
                    ride/ride_1.mcap.zstd\n  duration:\n    nanoseconds: 1\n  files:\n    - path: ride_0.mcap\n  broken: *nothing\n";
        assert_eq!(found(text), ["ride_0.mcap", "ride_1.mcap"]);
        assert_eq!(found("{a: [b.mcap], relative_file_paths: [c.mcap, d.db3], e: [f.mcap]}"), ["c.mcap"]);
        assert_eq!(found("relative_file_paths: []\nfiles: [a.mcap]\n"), [""; 0]);
        assert_eq!(found("of: another program\n"), [""; 0]);
        assert!(parts("relative_file_paths: [ride_0.mcap, 'ri").is_err(), "cut off");
    }
}
