//! Recordings of robots: pairs of pictures of two topics of an MCAP file, as `ros2 bag record -s mcap` writes them.
//!
//! Read are `sensor_msgs/Image` and `CompressedImage` of ROS 2 (CDR) and of ROS 1 (as `mcap convert` takes them from a bag), in chunks that are
//! not compressed or compressed by lz4 or zstd. Files are streamed: in memory are one chunk, and the frames that wait for their partners.
//!
//! Lengths in the files are not trusted: memory is allocated for bytes that are really there.

mod chunk;
mod fields;
mod messages;
mod metadata;
mod pairing;
mod pairs;
mod records;
mod stream;
mod summary;
mod topics;

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{calibration::Loaded, malformed};
use crate::{
    error::{Error, Result, shown},
    image::Size,
};
use messages::Kind;
use metadata::METADATA;
use stream::Stream;

pub(crate) use messages::CameraInfo;
pub use pairs::{LeftOut, Pairs, Shot};
pub use topics::Topic;

/// A value, or what is wrong with the recording.
type Told<T> = std::result::Result<T, String>;

/// Topics that a message lists at most.
const LISTED: usize = 20;

/// A recording: an MCAP file, or a folder of several that rosbag2 writes one after the other; or of several recordings.
#[derive(Clone, Debug)]
pub struct Recording {
    path: PathBuf,
    files: Vec<PathBuf>,
    topics: Vec<Topic>,
}

/// The calibration of both cameras, as the recording has it.
#[derive(Clone, Debug)]
pub struct RecordedCalibration {
    /// The calibration.
    pub loaded: Loaded,
    /// Whether the topics have pictures that are rectified, by their names.
    pub is_rectified: bool,
    /// The topic of the right camera's calibration, behind the path of the recording.
    pub path: PathBuf,
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

/// Files in a folder with an extension and not hidden, recording by recording, those with numbers in their order.
fn files_in(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_hidden = |file: &PathBuf| file.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
    let mut files: Vec<PathBuf> = entries.filter(|file| has_extension(file, extension) && !is_hidden(file)).collect();
    files.sort_by_cached_key(|file| recording_of(file));
    files
}

/// The name of the recording that a file belongs to, and its number there: rosbag2 calls the files of `ride` `ride_0`, `ride_1` and so on.
fn recording_of(file: &Path) -> (String, Option<u64>) {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let parts = stem.rsplit_once('_').filter(|(name, _)| !name.is_empty());
    let numbered = parts.and_then(|(name, number)| Some((name.to_owned(), Some(number.parse().ok()?))));
    numbered.unwrap_or_else(|| (stem.into_owned(), None))
}

impl RecordedCalibration {
    /// Checks that the calibration is of pictures of these sizes, left and right, in pixels.
    ///
    /// # Errors
    /// [`Error::Format`] with the topic, if it is not.
    pub fn check_sizes(&self, sizes: [Size; 2]) -> Result<()> {
        let checked = match self.is_rectified {
            true => self.loaded.for_rectified(sizes[0]).map(|_| ()),
            false => self.loaded.stereo.check_sizes(sizes),
        };
        checked.map_err(|error| malformed(&self.path, error.to_string()))
    }
}

impl Recording {
    /// Whether a path is that of a recording, or of a bag that is to be converted to one: by its extension, or what lies in the folder.
    pub fn is_one(path: &Path) -> bool {
        let extensions = ["mcap", "bag", "db3"];
        let is_file = extensions.iter().any(|known| has_extension(path, known));
        // Compressed as a whole by rosbag2.
        let inner = Path::new(path.file_stem().unwrap_or_default());
        let is_compressed =
            has_extension(path, "zstd") && ["mcap", "db3"].iter().any(|known| has_extension(inner, known));
        let has_parts = || ["mcap", "db3"].iter().any(|known| !files_in(path, known).is_empty());
        is_file || is_compressed || path.join(METADATA).is_file() || has_parts()
    }

    /// Opens a recording, and looks for its topics: in its summary, or, without one, in all of it. A file among several may be broken or lacking,
    /// which the pairs end with.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Format`] for bags of other formats, with the command that converts them, and where no file is an MCAP with
    /// messages.
    pub fn open(path: &Path) -> Result<Self> {
        let files = if path.is_dir() { files_in(path, "mcap") } else { vec![path.to_path_buf()] };
        let bags = if path.is_dir() { files_in(path, "db3") } else { Vec::new() };
        let compressed = files_in(path, "zstd");
        for file in bags.iter().chain(&compressed).chain(&files) {
            if let Some(way_out) = way_out(file) {
                return Err(malformed(file, way_out));
            }
        }
        if files.is_empty() {
            return Err(malformed(path, "there is no recording (.mcap) in the folder"));
        }
        let (mut topics, mut broken): (Vec<Topic>, _) = (Vec::new(), None);
        for file in &files {
            let found = summary::topics(file).unwrap_or_else(|error| {
                broken.get_or_insert(error);
                Vec::new()
            });
            for topic in found {
                match topics.iter_mut().find(|known| known.name == topic.name) {
                    Some(known) => known.messages = known.messages.zip(topic.messages).map(|(more, few)| more + few),
                    None => topics.push(topic),
                }
            }
        }
        if topics.is_empty() {
            return Err(broken.unwrap_or_else(|| malformed(path, "the recording has no messages")));
        }
        topics.sort_by(|one, other| one.name.cmp(&other.name));
        Ok(Self { path: path.into(), files, topics })
    }

    /// All topics, by their names.
    pub fn topics(&self) -> &[Topic] {
        &self.topics
    }

    /// The topics of the left and of the right view: those that are named, or those whose names differ in the names of two sides, such as
    /// `left` and `right`, `cam0` and `cam1`, `infra1` and `infra2`.
    ///
    /// # Errors
    /// [`Error::Format`] with the topics that there are, if a named one is not there or has no pictures that are read, or names do not tell.
    pub fn both_views(&self, named: Option<[&str; 2]>) -> Result<[&Topic; 2]> {
        let refused = |why: &str| malformed(&self.path, format!("{why}; {}", self.listed()));
        let Some(names) = named else {
            return topics::of_both_views(&self.topics).ok_or_else(|| {
                refused("names of topics do not tell which are those of the left and of the right view")
            });
        };
        let find = |name: &str| {
            let topic = self.topics.iter().find(|topic| topic.name == name);
            let topic = topic.ok_or_else(|| refused(&format!("there is no topic {name}")))?;
            let why = || {
                let found = &topic.message_type;
                refused(&format!("the topic {name} has {found}: sensor_msgs Image and CompressedImage are read"))
            };
            Some(topic).filter(|topic| topic.has_pictures()).ok_or_else(why)
        };
        let [left, right] = names.map(find);
        let both = [left?, right?];
        if names[0] == names[1] {
            return Err(refused("the left and the right topic are the same"));
        }
        Ok(both)
    }

    /// The topics of pictures, for a message.
    fn listed(&self) -> String {
        let pictures: Vec<&Topic> = self.topics.iter().filter(|topic| topic.has_pictures()).collect();
        if pictures.is_empty() {
            let types: Vec<&str> = self.topics.iter().take(LISTED).map(|topic| topic.message_type.as_str()).collect();
            return format!("no topic has sensor_msgs Image or CompressedImage, but {}", types.join(", "));
        }
        let listed: Vec<String> = pictures
            .iter()
            .take(LISTED)
            .map(|topic| match topic.messages {
                Some(messages) => format!("{} ({messages} messages)", topic.name),
                None => topic.name.clone(),
            })
            .collect();
        let more = if pictures.len() > LISTED { ", ..." } else { "" };
        format!("topics of pictures are {}{more}", shown(Path::new(&listed.join(", "))))
    }

    /// The pairs of frames of two topics, in the order of their times, with a name each.
    pub fn pairs(&self, topics: [&Topic; 2]) -> Pairs {
        let names = topics.map(|topic| topic.name.as_str());
        let lacking = metadata::check(&self.path, &self.files).err();
        Pairs::new(self.path.clone(), Stream::new(self.files.clone(), lacking), names)
    }

    /// The calibration of the cameras of two topics: the first `sensor_msgs/CameraInfo` of each, of the topics `camera_info` beside them.
    /// `None` if there are none, or they say that the cameras are not calibrated.
    ///
    /// # Errors
    /// [`Error::Format`] for a calibration that is not one of a pair, is of one camera alone, or cannot be read.
    pub fn calibration(&self, views: [&Topic; 2]) -> Result<Option<RecordedCalibration>> {
        let names = views.map(topics::camera_info_of);
        let is_there = |name: &String| {
            let is_it = |topic: &Topic| topic.name == *name && topic.kind() == Some(Kind::CameraInfo);
            self.topics.iter().any(|topic| is_it(topic) && topic.messages != Some(0))
        };
        let of_one = |side: usize| {
            let [has, lacks] = [&names[side], &shown(Path::new(&names[1 - side]))];
            malformed(&place_in(&self.path, has), format!("the calibration is of one camera alone: {lacks} has none"))
        };
        let are_there = names.each_ref().map(is_there);
        if names[0] == names[1] || are_there == [false, false] {
            return Ok(None);
        }
        if let Some(lacking) = are_there.iter().position(|is_there| !is_there) {
            return Err(of_one(1 - lacking));
        }
        let Some(infos) = self.first_infos(&names)? else { return Ok(None) };
        match infos.each_ref().map(CameraInfo::is_calibrated) {
            [true, true] => {}
            [false, false] => return Ok(None),
            [is_left, _] => return Err(of_one(usize::from(!is_left))),
        }
        let is_rectified = views.iter().all(|topic| topics::is_rectified(&topic.name));
        let paths = names.map(|name| place_in(&self.path, &name));
        let loaded = super::calibration::of_infos(&infos, paths.each_ref().map(PathBuf::as_path))?;
        let [_, path] = paths;
        Ok(Some(RecordedCalibration { loaded, is_rectified, path }))
    }

    /// The first message of each of both topics that can be read; `None` if neither has a message.
    fn first_infos(&self, names: &[String; 2]) -> Result<Option<[CameraInfo; 2]>> {
        let mut stream = Stream::new(self.files.clone(), None);
        let mut found: [Option<Told<CameraInfo>>; 2] = [None, None];
        loop {
            if let [Some(Ok(left)), Some(Ok(right))] = &found {
                return Ok(Some([left.clone(), right.clone()]));
            }
            let Some(message) = stream.next(|topic| names.iter().any(|name| name == topic)) else { break };
            let Some(side) = names.iter().position(|name| *name == message.topic) else { continue };
            if !matches!(found[side], Some(Ok(_))) {
                found[side] = Some(CameraInfo::of(&message.data, message.encoding));
            }
        }
        if found.iter().all(Option::is_none) {
            return Ok(None);
        }
        let failed = names.iter().zip(found).find_map(|(name, found)| match found {
            Some(Ok(_)) => None,
            Some(Err(reason)) => Some((name, reason)),
            None => Some((name, "there is no calibration in the topic".into())),
        });
        failed.map_or(Ok(None), |(name, reason)| Err(malformed(&place_in(&self.path, name), reason)))
    }
}

/// A part of a recording, as it is named in reports and messages.
fn place_in(recording: &Path, part: &str) -> PathBuf {
    format!("{}#{part}", recording.display()).into()
}

/// How a file of another format becomes one that is read.
fn way_out(file: &Path) -> Option<&'static str> {
    if has_extension(file, "bag") {
        Some(
            "bags of ROS 1 are not read: mcap convert IN.bag OUT.mcap, or rosbags-convert --src IN.bag --dst OUT --dst-storage mcap",
        )
    } else if has_extension(file, "db3") {
        Some("SQLite bags are not read: mcap convert IN.db3 OUT.mcap, or ros2 bag convert with storage_id: mcap")
    } else if has_extension(file, "zstd") {
        Some("rosbag2 has compressed the file as a whole: zstd -d FILE.mcap.zstd -o FILE.mcap")
    } else {
        None
    }
}

/// The error of an operation on a file.
fn io_error(path: &Path) -> impl Fn(std::io::Error) -> Error {
    |source| Error::Io { path: path.into(), source }
}

#[cfg(test)]
mod tests;
