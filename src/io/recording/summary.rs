//! The topics of a file: from its summary at the end, or from all of it.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{Read, Seek, SeekFrom},
    path::Path,
};

use mcap::{
    MAGIC,
    read::ChannelAccumulator,
    records::{Record, op},
};

use super::{Told, io_error, records::Records, stream::known, topics::Topic};
use crate::{error::Result, io::malformed};

/// Bytes of the footer: its code, its length, the places of the summary and of its offsets, a checksum.
const FOOTER: usize = 1 + 8 + 8 + 8 + 4;
/// Bytes of the footer and what ends a file.
const END: usize = FOOTER + 8;

/// The topics of a file, each once.
///
/// # Errors
/// [`crate::Error::Io`]; [`crate::Error::Format`] for a file that breaks off before any topic.
pub(super) fn topics(path: &Path) -> Result<Vec<Topic>> {
    let mut file = File::open(path).map_err(io_error(path))?;
    let mut topics = match summary_start(&mut file) {
        Some(start) => {
            file.seek(SeekFrom::Start(start)).map_err(io_error(path))?;
            let found = Found::in_all(Records::of_summary(&file));
            if found.error.is_none() { found.topics() } else { Vec::new() }
        }
        None => Vec::new(),
    };
    if topics.is_empty() {
        file.rewind().map_err(io_error(path))?;
        let found = Found::in_all(Records::of_file(&file));
        topics = found.topics();
        if let (true, Some(reason)) = (topics.is_empty(), found.error) {
            return Err(malformed(path, reason));
        }
    }
    Ok(topics)
}

/// Where the summary begins; `None` in a file that is cut off or has none.
fn summary_start(file: &mut File) -> Option<u64> {
    let end = file.seek(SeekFrom::End(-(END as i64))).ok()?;
    let mut bytes = [0; END];
    file.read_exact(&mut bytes).ok()?;
    let start = u64::from_le_bytes(*bytes[9..].first_chunk()?);
    (bytes.ends_with(MAGIC) && bytes[0] == op::FOOTER && (1..end).contains(&start)).then_some(start)
}

/// What records say of topics.
#[derive(Default)]
struct Found {
    channels: ChannelAccumulator<'static>,
    /// Names and types of the topics by the number of their channel.
    named: BTreeMap<u16, Topic>,
    /// Numbers of messages by channel, if all are known.
    counts: Option<BTreeMap<u16, u64>>,
    /// What ended the reading before the end.
    error: Option<String>,
}

impl Found {
    fn in_all(mut records: Records<impl Read>) -> Self {
        let mut found = Self::default();
        found.error = found.read(&mut records).err();
        found
    }

    fn read(&mut self, records: &mut Records<impl Read>) -> Told<()> {
        while let Some((code, data)) = records.next()? {
            match code {
                op::STATISTICS => {
                    if let Ok(Record::Statistics(statistics)) = mcap::parse_record(code, data) {
                        self.counts = Some(statistics.channel_message_counts);
                    }
                }
                op::CHANNEL => {
                    known(code, data, &mut self.channels)?;
                    let number = data.first_chunk().map_or(0, |number| u16::from_le_bytes(*number));
                    if let Some(channel) = self.channels.get(number) {
                        let message_type =
                            channel.schema.as_ref().map_or_else(String::new, |schema| schema.name.clone());
                        self.named.insert(number, Topic { name: channel.topic.clone(), message_type, messages: None });
                    }
                }
                op::SCHEMA => _ = known(code, data, &mut self.channels)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// The topics. One that several nodes send has several channels.
    fn topics(&self) -> Vec<Topic> {
        let mut topics: Vec<Topic> = Vec::new();
        for (number, topic) in &self.named {
            let messages = self.counts.as_ref().map(|counts| counts.get(number).copied().unwrap_or(0));
            match topics.iter_mut().find(|known| known.name == topic.name) {
                Some(known) => {
                    known.messages = known.messages.zip(messages).map(|(more, few)| more.saturating_add(few))
                }
                None => topics.push(Topic { messages, ..topic.clone() }),
            }
        }
        topics
    }
}
