//! Chunks of records, compressed or not.

use std::io::Read;

use mcap::records::ChunkHeader;

use super::{
    Told,
    records::{MOST, RECOVER},
};

/// Appends the records of a chunk to `records`.
///
/// # Errors
/// What is wrong with the chunk, or which compression it has that is not read.
pub(super) fn decompress(header: &ChunkHeader, data: &[u8], records: &mut Vec<u8>) -> Told<()> {
    let length = header.uncompressed_size;
    if length > MOST as u64 {
        return Err(format!("a chunk has {length} bytes: at most {MOST} are read. mcap recover writes smaller ones"));
    }
    let damaged = |error: &dyn std::fmt::Display| format!("a chunk is damaged ({error}): {RECOVER}");
    match header.compression.as_str() {
        "" => records.extend(data),
        "lz4" => {
            let decoder = lz4_flex::frame::FrameDecoder::new(data);
            decoder.take(length + 1).read_to_end(records).map_err(|error| damaged(&error))?;
        }
        "zstd" => {
            let decoder = ruzstd::decoding::StreamingDecoder::new(data).map_err(|error| damaged(&error))?;
            decoder.take(length + 1).read_to_end(records).map_err(|error| damaged(&error))?;
        }
        other => {
            let other: String = other.chars().take(20).collect();
            return Err(format!(
                "chunks are compressed by {other:?}, which is not read: mcap compress -o OUT.mcap writes zstd"
            ));
        }
    }
    if records.len() as u64 != length {
        return Err(damaged(&format_args!("of {length} bytes there are {}", records.len())));
    }
    let sum = crc32fast::hash(records);
    // No sum is 0.
    if ![0, sum].contains(&header.uncompressed_crc) {
        return Err(damaged(&"its checksum is another one"));
    }
    Ok(())
}
