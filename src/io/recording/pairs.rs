//! Pairs of frames of two topics.

use std::{
    borrow::Cow,
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};

use super::{
    fields::Encoding,
    messages::{Kind, compressed_picture, raw_picture, stamp_of},
    pairing::Pairing,
    place_in, recording_of,
    stream::{Message, Stream},
};
use crate::{
    error::{Error, Result},
    io::malformed,
};

/// The way out where one topic was recorded before the other one.
const IN_ORDER: &str =
    "one topic was recorded more than 256 MiB ahead of the other: mcap sort IN.mcap -o OUT.mcap brings both in order";

/// A frame as it was recorded.
#[derive(Clone, Debug)]
pub struct Shot {
    /// The file of the recording, the topic and the time, as reports and messages name the frame.
    pub path: PathBuf,
    /// The name of the recording.
    recording: String,
    kind: Kind,
    encoding: Encoding,
    message: Vec<u8>,
}

impl Shot {
    /// The picture, as the bytes of a file that [`crate::io::load::decode`] reads: PGM or PPM, or what `CompressedImage` has.
    ///
    /// # Errors
    /// [`Error::Format`] for a damaged message, and for an encoding that is not read.
    pub fn to_file(&self) -> Result<Cow<'_, [u8]>> {
        let picture = match self.kind {
            Kind::CompressedImage => compressed_picture(&self.message, self.encoding),
            _ => raw_picture(&self.message, self.encoding),
        };
        picture.map_err(|reason| malformed(&self.path, reason))
    }

    /// The message, as it was recorded.
    pub fn message(&self) -> &[u8] {
        &self.message
    }
}

/// Frames that are in no pair.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Of the left and of the right topic, those without a partner of the same time, or near it.
    pub alone: [u64; 2],
    /// Those of them that were given up since too many waited: their topic was recorded more than 256 MiB ahead of the other one.
    pub given_up: [u64; 2],
    /// Of the left and of the right topic, those whose time cannot be read.
    pub damaged: [u64; 2],
    /// What is wrong with the first of these.
    pub reason: Option<String>,
}

/// The pairs of a recording, in the order of their times: frames of the same time, or else, of those whose times differ by at most half of the
/// time to the next frame of the same topic, the nearest ones.
///
/// A frame without a time (0) has that at which it was recorded. A recording that breaks off, or a part of it, gives its pairs, and then the error.
pub struct Pairs {
    path: PathBuf,
    /// `None` after the end.
    stream: Option<Stream>,
    topics: [String; 2],
    pairing: Pairing<Shot>,
    /// The name of the recording that is read.
    recording: Option<String>,
    /// The first frame of the next recording, while pairs of this one are left: its side, its time, and the frame.
    held: Option<(usize, u64, Shot)>,
    /// The error that comes after all pairs.
    error: Option<Error>,
    has_pairs: bool,
    left_out: Arc<Mutex<LeftOut>>,
}

impl Pairs {
    pub(super) fn new(path: PathBuf, stream: Stream, topics: [&str; 2]) -> Self {
        Self {
            path,
            stream: Some(stream),
            topics: topics.map(str::to_owned),
            pairing: Pairing::new(),
            recording: None,
            held: None,
            error: None,
            has_pairs: false,
            left_out: Arc::default(),
        }
    }

    /// What is left out so far, or, after the end, of all.
    pub fn left_out(&self) -> Arc<Mutex<LeftOut>> {
        Arc::clone(&self.left_out)
    }

    fn note(&self, note: impl FnOnce(&mut LeftOut)) {
        note(&mut self.left_out.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// Takes a message of one of the topics.
    fn add(&mut self, message: Message) {
        let side = self.topics.iter().position(|topic| *topic == message.topic);
        let Some(side) = side.filter(|_| message.kind != Kind::CameraInfo) else { return };
        let stamp = match stamp_of(&message.data, message.encoding) {
            Ok(0) => message.recorded,
            Ok(stamp) => stamp,
            Err(reason) => {
                return self.note(|left_out| {
                    left_out.damaged[side] += 1;
                    left_out.reason.get_or_insert(reason);
                });
            }
        };
        let path = place_in(&message.file, &format!("{}@{stamp}", message.topic));
        let (recording, _) = recording_of(&message.file);
        let is_another = self.recording.as_ref().is_some_and(|before| *before != recording);
        self.recording = Some(recording.clone());
        let shot = Shot { path, recording, kind: message.kind, encoding: message.encoding, message: message.data };
        if is_another && self.pairing.goes_back(side, stamp) {
            self.pairing.end();
            self.held = Some((side, stamp, shot));
        } else {
            self.pair(side, stamp, shot);
        }
    }

    fn pair(&mut self, side: usize, stamp: u64, shot: Shot) {
        let bytes = shot.message.len();
        self.pairing.add(side, stamp, shot, bytes);
    }

    /// Reads the next message, or comes to the end.
    fn read_on(&mut self) {
        let Some(stream) = &mut self.stream else { return };
        let topics = &self.topics;
        if let Some(message) = stream.next(|topic| topics.iter().any(|name| name == topic)) {
            return self.add(message);
        }
        self.error = self.stream.take().and_then(|stream| stream.into_error(&self.path));
        self.pairing.end();
    }

    /// The error of a recording without any pair.
    fn nothing(&self) -> Error {
        let [left, right] = self.pairing.alone;
        let LeftOut { reason, given_up, .. } = self.left_out.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let reason = if given_up == [0, 0] { reason } else { Some(IN_ORDER.into()) };
        let reason = format!(
            "no frame of {} has a partner of {} at the same time, or near it: there are {left} and {right} that can be read{}",
            self.topics[0],
            self.topics[1],
            reason.map_or_else(String::new, |reason| format!(" ({reason})"))
        );
        malformed(&self.path, reason)
    }
}

impl Iterator for Pairs {
    /// The name of the pair, and both frames. The name is the time of the left frame in nanoseconds, behind the name of its recording where an
    /// earlier one has a pair of this time.
    type Item = Result<(String, [Shot; 2])>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let pair = self.pairing.next();
            let Pairing { alone, given_up, .. } = self.pairing;
            self.note(|left_out| (left_out.alone, left_out.given_up) = (alone, given_up));
            if let Some((stamp, is_again, shots)) = pair {
                self.has_pairs = true;
                let name = if is_again { format!("{}/{stamp}", shots[0].recording) } else { stamp.to_string() };
                return Some(Ok((name, shots)));
            }
            if let Some((side, stamp, shot)) = self.held.take() {
                self.pairing.begin();
                self.pair(side, stamp, shot);
                continue;
            }
            if self.stream.is_none() {
                let error = self.error.take().or_else(|| (!self.has_pairs).then(|| self.nothing()));
                self.has_pairs = true;
                return error.map(Err);
            }
            self.read_on();
        }
    }
}
