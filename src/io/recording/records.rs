//! The records of an MCAP file, out of their chunks.

use std::io::{ErrorKind, Read};

use mcap::{
    McapError,
    records::{Record, op},
    sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

use super::{Told, chunk};

/// Longest record, and longest chunk before and after its decompression, in bytes.
pub(super) const MOST: usize = 1 << 30;
/// The way out of damage.
pub(super) const RECOVER: &str = "mcap recover IN.mcap -o OUT.mcap writes what is whole";
/// Bytes that are read at once, at least and at most: lengths in a file are not believed.
const AT_ONCE: [usize; 2] = [1 << 16, 1 << 20];
/// Bytes of the operation code and the length in front of a record.
const HEAD: usize = 9;

/// The records of a part of a file.
pub(super) struct Records<R> {
    from: R,
    reader: LinearReader,
    /// Records that are read, of a chunk or a single one, and where the next one begins.
    records: Vec<u8>,
    place: usize,
    is_whole: bool,
}

impl<R: Read> Records<R> {
    /// The records from the beginning of a file.
    pub fn of_file(from: R) -> Self {
        Self::new(from, false)
    }

    /// The records of the summary, at whose beginning `from` stands.
    pub fn of_summary(from: R) -> Self {
        Self::new(from, true)
    }

    fn new(from: R, is_summary: bool) -> Self {
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(is_summary)
            .with_emit_chunks(true)
            .with_record_length_limit(MOST);
        let reader = LinearReader::new_with_options(options);
        Self { from, reader, records: Vec::new(), place: 0, is_whole: false }
    }

    /// The operation code and the bytes of the next schema, channel, message or statistics; `None` at the end of the data, or of the summary.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn next(&mut self) -> Told<Option<(u8, &[u8])>> {
        while self.place == self.records.len() {
            if self.is_whole {
                return Ok(None);
            }
            self.read_on()?;
        }
        let rest = &self.records[self.place..];
        let found = rest.split_first_chunk::<HEAD>().and_then(|([code, length @ ..], body)| {
            let body = body.get(..usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
            Some((*code, body))
        });
        let Some((code, body)) = found else { return Err("a chunk ends in the middle of a record".into()) };
        self.place += HEAD + body.len();
        Ok(Some((code, body)))
    }

    /// Reads the next chunk or record into `records`, or comes to the end.
    fn read_on(&mut self) -> Told<()> {
        self.records.clear();
        self.place = 0;
        loop {
            let event = self.reader.next_event().ok_or_else(cut_off)?;
            let (code, data) = match event.map_err(|error| told(&error))? {
                LinearReadEvent::Record { opcode, data } => (opcode, data),
                LinearReadEvent::ReadRequest(needed) => {
                    let space = self.reader.insert(needed.clamp(AT_ONCE[0], AT_ONCE[1]));
                    match self.from.read(space) {
                        Ok(length) => self.reader.notify_read(length),
                        Err(error) if error.kind() == ErrorKind::Interrupted => {}
                        Err(error) => return Err(error.to_string()),
                    }
                    continue;
                }
            };
            match code {
                op::DATA_END | op::FOOTER => self.is_whole = true,
                op::CHUNK => {
                    let Record::Chunk { header, data } =
                        mcap::parse_record(code, data).map_err(|error| told(&error))?
                    else {
                        continue;
                    };
                    chunk::decompress(&header, &data, &mut self.records)?;
                }
                op::SCHEMA | op::CHANNEL | op::MESSAGE | op::STATISTICS => {
                    self.records.push(code);
                    self.records.extend((data.len() as u64).to_le_bytes());
                    self.records.extend(data);
                }
                _ => continue,
            }
            return Ok(());
        }
    }
}

fn cut_off() -> String {
    told(&McapError::UnexpectedEof)
}

/// What is wrong with a file, in words.
pub(super) fn told(error: &McapError) -> String {
    match error {
        McapError::UnexpectedEof => format!("the recording is cut off: {RECOVER}"),
        McapError::BadMagic => "no MCAP recording begins there".into(),
        McapError::RecordTooLarge { len, .. } => {
            format!(
                "a record of {len} bytes: at most {MOST} are read. mcap recover writes smaller chunks; else the file is damaged"
            )
        }
        error => format!("the recording is damaged ({error}): {RECOVER}"),
    }
}
