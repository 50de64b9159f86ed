//! What a pair is made of: its pictures and its calibration as they are read, and how they are known again.

use std::{
    fs,
    path::{self, Path, PathBuf},
    time::UNIX_EPOCH,
};

use hsad::{
    Result,
    internals::fnv1a,
    io::{load, read_whole},
};
use serde_json::{Map, Value, json};

use super::{
    super::recipe::MOST_CALIBRATION,
    frame::{Files, Frame},
    pair::Pair,
};

/// What inputs are called in records, as in lists: left view, right view, calibration.
const NAMES: [&str; 3] = ["left", "right", "calib"];

/// Reads all of a file.
type ReadFile = fn(&Path) -> Result<Vec<u8>>;

/// The inputs of a pair, read.
pub struct Contents<'a> {
    pub pictures: Files<'a>,
    /// The text of the pair's own calibration.
    pub calibration: Option<String>,
    /// Which inputs these are, for the record: path, size, time and hash of a file, hash of a frame.
    pub inputs: Value,
}

impl<'a> Contents<'a> {
    /// Reads the inputs of a pair, whose pictures may be a frame that was read already.
    ///
    /// # Errors
    /// Those of a file that cannot be read, and of a damaged message of a recording.
    pub fn read(pair: &Pair, frame: Option<&'a Frame>) -> Result<Self> {
        let mut inputs = Map::new();
        let mut file = |name: &str, path: &Path, read: ReadFile| -> Result<Vec<u8>> {
            // What is written while the file is read has a later time.
            let file = File::of(path);
            let bytes = read(path)?;
            inputs.insert(name.into(), file.to_json(hash(&bytes)));
            Ok(bytes)
        };
        let calibration = pair.calibration.as_ref().map(|path| file(NAMES[2], path, read_calibration)).transpose()?;
        let pictures = match (frame, &pair.right) {
            (Some(frame), _) => frame.to_files()?,
            (None, None) => Files::Both(file(NAMES[0], &pair.left, load::read)?),
            (None, Some(right)) => {
                Files::Each([file(NAMES[0], &pair.left, load::read)?.into(), file(NAMES[1], right, load::read)?.into()])
            }
        };
        for (name, content) in NAMES.into_iter().zip(frame.into_iter().flat_map(Frame::contents)) {
            inputs.insert(name.into(), json!({ "hash": format!("{:016x}", hash(content)) }));
        }
        let calibration = calibration.map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        Ok(Self { pictures, calibration, inputs: Value::Object(inputs) })
    }
}

fn read_calibration(path: &Path) -> Result<Vec<u8>> {
    read_whole(path, MOST_CALIBRATION)
}

fn hash(bytes: &[u8]) -> u64 {
    fnv1a(bytes.iter().copied())
}

/// A file as its folder describes it.
struct File {
    /// Without links, and from the root on: one for all spellings.
    path: String,
    /// Size in bytes, and time of the last change in nanoseconds since 1970; `None` where the system does not tell.
    state: Option<[u64; 2]>,
}

impl File {
    fn of(path: &Path) -> Self {
        let in_folder = || Some(fs::canonicalize(path.parent()?).ok()?.join(path.file_name()?));
        let whole = fs::canonicalize(path).ok().or_else(in_folder).or_else(|| path::absolute(path).ok());
        let state = fs::metadata(path).ok().and_then(|found| {
            let time = found.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
            Some([found.len(), u64::try_from(time.as_nanos()).ok()?])
        });
        Self { path: whole.unwrap_or_else(|| path.into()).to_string_lossy().into_owned(), state }
    }

    fn to_json(&self, hash: u64) -> Value {
        let [bytes, modified] = [0, 1].map(|place| self.state.map(|state| state[place]));
        json!({ "path": self.path, "bytes": bytes, "modified_ns": modified, "hash": format!("{hash:016x}") })
    }
}

/// What is kept of an input: hashes of its path, its size and time, and its content. That of a frame has a content alone.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Mark {
    path: Option<u64>,
    state: Option<u64>,
    content: u64,
}

impl Mark {
    /// That of an input in a record.
    fn of(input: &Value) -> Option<Self> {
        let state = input["bytes"].as_u64().zip(input["modified_ns"].as_u64());
        Some(Self {
            path: input["path"].as_str().map(|path| hash(path.as_bytes())),
            state: state.map(|(bytes, modified)| Self::hash_of([bytes, modified])),
            content: u64::from_str_radix(input["hash"].as_str()?, 16).ok()?,
        })
    }

    fn hash_of(state: [u64; 2]) -> u64 {
        fnv1a(state.into_iter().flat_map(u64::to_le_bytes))
    }

    /// Whether the file at `path` is the input: the same file with the same size and time, or else one of the same content. A file that is
    /// gone is the input that it was.
    fn is_of_file(&self, path: &Path, read: ReadFile) -> bool {
        let file = File::of(path);
        let is_there = self.path == Some(hash(file.path.as_bytes()));
        match file.state.map(Self::hash_of) {
            None if !path.exists() => is_there,
            state if is_there && state.is_some() && state == self.state => true,
            _ => read(path).is_ok_and(|bytes| hash(&bytes) == self.content),
        }
    }
}

/// The inputs that an earlier run has recorded for a pair.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded([Option<Mark>; NAMES.len()]);

/// An input that is not the one that was recorded.
#[derive(Debug, PartialEq, Eq)]
pub struct Other {
    pub path: PathBuf,
    /// Whether there is no such file, as behind a link whose target was removed.
    pub is_gone: bool,
}

impl Recorded {
    /// Those of a record or a report; `None` if it has none.
    pub fn of(record: &Value) -> Option<Self> {
        let marks = NAMES.map(|name| Mark::of(&record["inputs"][name]));
        marks[0].is_some().then_some(Self(marks))
    }

    /// The first input of `pair` that is not the one that was recorded; `None` if all are.
    pub fn other_input(&self, pair: &Pair, frame: Option<&Frame>) -> Option<Other> {
        let Self([left, right, calibration]) = self;
        let is_file = |mark: &Option<Mark>, path: Option<&PathBuf>, read: ReadFile| match (mark, path) {
            (Some(mark), Some(path)) => mark.is_of_file(path, read),
            (mark, path) => mark.is_none() && path.is_none(),
        };
        let contents: Vec<&[u8]> = frame.into_iter().flat_map(Frame::contents).collect();
        let is_frame = |mark: &Option<Mark>, place: usize| {
            mark.as_ref().map(|mark| mark.content) == contents.get(place).map(|content| hash(content))
        };
        let [left_path, right_path] = pair.files();
        let other = |path: &Path, is_file: bool| Some(Other { path: path.into(), is_gone: is_file && !path.exists() });
        let are_the_same = match frame {
            Some(_) => [is_frame(left, 0), is_frame(right, 1)],
            None => [is_file(left, Some(&pair.left), load::read), is_file(right, pair.right.as_ref(), load::read)],
        };
        match are_the_same {
            [false, _] => other(left_path, frame.is_none()),
            [_, false] => other(right_path, frame.is_none()),
            _ if is_file(calibration, pair.calibration.as_ref(), read_calibration) => None,
            _ => match &pair.calibration {
                Some(path) => other(path, true),
                None => other(Path::new("the calibration"), false),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{fs::OpenOptions, time::Duration};

    use super::*;

    fn write(path: &Path, text: &str, seconds: u64) {
        fs::write(path, text).unwrap();
        let time = UNIX_EPOCH + Duration::from_secs(seconds);
        OpenOptions::new().write(true).open(path).unwrap().set_modified(time).unwrap();
    }

    #[test]
    fn inputs_are_known_again_by_their_time_or_their_content() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["left", "right", "calib"] {
            write(&path(name), "P5 once", 9);
        }
        let pair = |folder: &Path| Pair {
            name: "a".into(),
            left: folder.join("left"),
            right: Some(folder.join("right")),
            calibration: Some(folder.join("calib")),
        };
        let given = pair(folder.path());
        let recorded = json!({ "inputs": Contents::read(&given, None).unwrap().inputs });
        let recorded = Recorded::of(&serde_json::from_str(&recorded.to_string()).unwrap()).unwrap();
        let other = |pair: &Pair| {
            recorded.other_input(pair, None).map(|Other { path, is_gone }| {
                let name = path.file_name().unwrap().to_str().unwrap();
                format!("{name}{}", if is_gone { " is gone" } else { "" })
            })
        };
        assert_eq!(other(&given), None);
        fs::create_dir(path("below")).unwrap();
        assert_eq!(other(&pair(&path("below/..").join("."))), None, "another spelling");

        write(&path("left"), "P5 once", 10);
        assert_eq!(other(&given), None, "another time");
        for name in ["left", "right", "calib"] {
            write(&path(name), "P5 then", 10);
            assert_eq!(other(&given).unwrap(), name, "another content");
            write(&path(name), "P5 once", 10);
            write(&path("below").join(name), if name == "left" { "P5 then" } else { "P5 once" }, 9);
        }
        assert_eq!(other(&pair(&path("below"))).unwrap(), "left", "another file of the same size and time");
        write(&path("below/left"), "P5 once", 9);
        assert_eq!(other(&pair(&path("below"))), None, "copies");
        assert_eq!(other(&Pair { calibration: None, ..given.clone() }).unwrap(), "the calibration");
        assert_eq!(other(&Pair { right: None, ..given.clone() }).unwrap(), "left", "both views in one");
        fs::remove_file(path("left")).unwrap();
        assert_eq!(other(&given), None, "gone");
        fs::remove_file(path("below/left")).unwrap();
        assert_eq!(other(&pair(&path("below"))).unwrap(), "left is gone", "never seen");
    }
}
