//! The messages of a recording, file by file.

use std::{
    borrow::Cow,
    fs::File,
    io::Read,
    path::{Path, PathBuf},
    vec::IntoIter,
};

use mcap::{
    read::ChannelAccumulator,
    records::{MessageHeader, Record, op},
};

use super::{
    LISTED, Told,
    fields::Encoding,
    io_error,
    messages::Kind,
    records::{Records, told},
};
use crate::{error::Error, io::malformed};

/// A message.
pub(super) struct Message {
    /// The file that has it.
    pub file: PathBuf,
    pub topic: String,
    pub kind: Kind,
    /// When it was recorded, in nanoseconds.
    pub recorded: u64,
    pub encoding: Encoding,
    pub data: Vec<u8>,
}

/// The messages of several files, one file after the other.
pub(super) struct Stream {
    files: IntoIter<PathBuf>,
    /// The file that is read.
    open: Option<Messages<File>>,
    /// What is wrong with files so far; of each what came before was read.
    broken: Vec<Error>,
}

impl Stream {
    /// Those of `files`; `lacking` tells of files beside them that are not there.
    pub fn new(files: Vec<PathBuf>, lacking: Option<Error>) -> Self {
        Self { files: files.into_iter(), open: None, broken: lacking.into_iter().collect() }
    }

    /// The next message of a topic that is `wanted`. After a file that breaks off comes the next one.
    pub fn next(&mut self, wanted: impl Fn(&str) -> bool) -> Option<Message> {
        loop {
            let Some(messages) = &mut self.open else {
                let path = self.files.next()?;
                match File::open(&path) {
                    Ok(file) => self.open = Some(Messages::new(file, path)),
                    Err(error) => self.broken.push(io_error(&path)(error)),
                }
                continue;
            };
            match messages.next(&wanted) {
                Ok(Some(message)) => return Some(message),
                Ok(None) => {}
                Err(reason) => self.broken.push(malformed(&messages.file, reason)),
            }
            self.open = None;
        }
    }

    /// What is wrong with the files of the `recording`.
    pub fn into_error(mut self, recording: &Path) -> Option<Error> {
        if self.broken.len() < 2 {
            return self.broken.pop();
        }
        let all: Vec<String> = self.broken.iter().take(LISTED).map(Error::to_string).collect();
        Some(malformed(
            recording,
            format!("{} of its files are broken or lacking: {}", self.broken.len(), all.join("; ")),
        ))
    }
}

/// The messages of a file.
struct Messages<R> {
    file: PathBuf,
    records: Records<R>,
    channels: ChannelAccumulator<'static>,
}

impl<R: Read> Messages<R> {
    fn new(from: R, file: PathBuf) -> Self {
        Self { file, records: Records::of_file(from), channels: ChannelAccumulator::default() }
    }

    fn next(&mut self, wanted: impl Fn(&str) -> bool) -> Told<Option<Message>> {
        while let Some((code, data)) = self.records.next()? {
            if let Some((header, data)) = known(code, data, &mut self.channels)? {
                let channel =
                    self.channels.get(header.channel_id).ok_or("the recording is damaged: a message of no topic")?;
                let encoding = match channel.message_encoding.as_str() {
                    "cdr" => Encoding::Cdr,
                    "ros1" => Encoding::Ros1,
                    _ => continue,
                };
                let kind = channel.schema.as_ref().and_then(|schema| Kind::of(&schema.name));
                if let Some(kind) = kind.filter(|_| wanted(&channel.topic)) {
                    let (topic, data) = (channel.topic.clone(), data.into_owned());
                    let (file, recorded) = (self.file.clone(), header.log_time);
                    return Ok(Some(Message { file, topic, kind, recorded, encoding, data }));
                }
            }
        }
        Ok(None)
    }
}

/// Notes a schema or a channel, and returns a message.
pub(super) fn known<'a>(
    code: u8,
    data: &'a [u8],
    channels: &mut ChannelAccumulator<'static>,
) -> Told<Option<(MessageHeader, Cow<'a, [u8]>)>> {
    if ![op::SCHEMA, op::CHANNEL, op::MESSAGE].contains(&code) {
        return Ok(None);
    }
    let noted = match mcap::parse_record(code, data).map_err(|error| told(&error))? {
        Record::Schema { header, data } => channels.add_schema_from_slice(header, &data),
        Record::Channel(channel) => channels.add_channel(channel),
        Record::Message { header, data } => return Ok(Some((header, data))),
        _ => Ok(()),
    };
    noted.map(|()| None).map_err(|error| told(&error))
}
