//! Checks of JPEG files that the decoder does not report: data that are cut off or damaged (it fills the rest with grey), and CMYK (it
//! converts the colours by guess). And what the decoder calls damage, though it is none: a height behind the pixels, which is not read, and
//! sampling factors of a grey picture, which mean nothing (A.2.2) and become 1.
//!
//! The markers are read, and the entropy-coded data as far as it takes to count their blocks (ITU-T T.81).

mod bits;
mod scan;

use std::borrow::Cow;

use self::{
    bits::Table,
    scan::{Frame, Scan},
};

const END_OF_IMAGE: u8 = 0xd9;
const HUFFMAN_TABLES: u8 = 0xc4;
const RESTART_INTERVAL: u8 = 0xdd;
const START_OF_SCAN: u8 = 0xda;
const NUMBER_OF_LINES: u8 = 0xdc;
const COMMENT: u8 = 0xfe;

const CUT_OFF: &str = "the JPEG is cut off: copy or export it again";

/// Why a JPEG is not read that tells its height behind the pixels.
pub(super) const HEIGHT_BEHIND: &str = "the JPEG tells its height behind its pixels (DNL), which is not read: open it in a viewer and save it as PNG or JPEG";

/// Why a JPEG is not read whose components lie in scans of their own, some with more rows than others: the decoder gives wrong pixels.
const ROWS_APART: &str = "the colours of the JPEG lie in scans of their own with other numbers of rows, which are not read right: open it in \
                          a viewer and save it as PNG or JPEG";

/// The bytes of a JPEG with all of its blocks, with an end marker if it has none, and what is odd about them.
///
/// # Errors
/// Why the file cannot be used for matching.
pub(super) fn whole(bytes: &[u8]) -> Result<(Cow<'_, [u8]>, Option<String>), String> {
    let mut tables: [[Option<Table>; 4]; 2] = Default::default();
    let (mut frame, mut interval, mut surplus) = (None, 0, 0);
    let mut height = None;
    let mut readable = Cow::Borrowed(bytes);
    // The first two bytes are the start-of-image marker, FF D8.
    let mut rest = bytes.get(2..).unwrap_or_default();
    loop {
        let Some((marker, behind)) = next_marker(rest) else {
            return match frame {
                Some(frame) if is_whole(&frame) => Ok((
                    [&*readable, &[0xff, END_OF_IMAGE]].concat().into(),
                    Some("the JPEG has no end marker, but all of its picture: copy or export it again".into()),
                )),
                _ => Err(CUT_OFF.into()),
            };
        };
        rest = behind;
        match marker {
            END_OF_IMAGE => break,
            // Markers without a segment: restarts and TEM.
            0xd0..=0xd7 | 0x01 => continue,
            _ => {}
        }
        let (segment, behind) = split_segment(rest).ok_or(CUT_OFF)?;
        let place = bytes.len() - behind.len() - segment.len();
        rest = behind;
        match marker {
            HUFFMAN_TABLES => read_tables(segment, &mut tables),
            RESTART_INTERVAL => interval = segment.first_chunk().map_or(0, |&number| u16::from_be_bytes(number).into()),
            // Frame headers: precision, height, width, then the number of components. DHT, JPG and DAC lie in the same
            // range of codes. The decoder refuses frames without Huffman codes.
            0xc0..=0xc3 | 0xc5..=0xc7 | 0xc9..=0xcb | 0xcd..=0xcf => {
                if segment.get(5) == Some(&4) {
                    return Err("a JPEG in CMYK: convert it to RGB, its colours depend on a printing profile".into());
                }
                frame = if marker <= 0xc2 { Frame::new(segment, marker == 0xc2) } else { None };
                if frame.as_ref().is_some_and(|frame| frame.components.len() == 1) && segment[7] != 0x11 {
                    readable.to_mut()[place + 7] = 0x11;
                }
                height = segment.get(1..3);
            }
            // The height once more says nothing, another one that there are other lines than the frame claims (B.2.5).
            NUMBER_OF_LINES if height == Some(segment) => readable.to_mut()[place - 3] = COMMENT,
            NUMBER_OF_LINES => return Err(HEIGHT_BEHIND.into()),
            START_OF_SCAN => {
                let data;
                (data, rest) = split_entropy_coded(rest);
                let scan = frame.as_ref().and_then(|frame| read_scan(segment, frame, &tables, interval));
                if let (Some(frame), Some(scan)) = (&mut frame, scan) {
                    if frame.has_rows_apart(&scan) {
                        return Err(ROWS_APART.into());
                    }
                    let held = frame.read(&scan, intervals(data));
                    if held.lost > 0 {
                        let share = 100.0 * held.lost as f64 / held.units as f64;
                        return Err(format!(
                            "the data of the JPEG lack {} of {} blocks ({share:.1} %), or its header claims another size: copy or export \
                             it again",
                            held.lost, held.units
                        ));
                    }
                    surplus += held.surplus;
                }
            }
            _ => {}
        }
    }
    let is_whole = frame.is_none_or(|frame| is_whole(&frame));
    let doubt = match surplus {
        _ if !is_whole => {
            Some("the JPEG lacks some of its scans, and with them detail: copy or export it again".into())
        }
        0 => None,
        _ => Some(format!("{surplus} bytes of the JPEG belong to no part of its picture: it may be damaged")),
    };
    Ok((readable, doubt))
}

/// Whether all bits of all coefficients were sent.
fn is_whole(frame: &Frame) -> bool {
    frame.components.iter().all(scan::Component::is_whole)
}

/// Takes over the Huffman tables of a segment: class and place, numbers of codes, symbols (B.2.4.2). What is damaged becomes no table.
fn read_tables(mut segment: &[u8], tables: &mut [[Option<Table>; 4]; 2]) {
    while let Some((&[place, ref counts @ ..], rest)) = segment.split_first_chunk::<17>() {
        let count = counts.iter().map(|&count| usize::from(count)).sum();
        let Some((symbols, behind)) = rest.split_at_checked(count) else { return };
        segment = behind;
        let (class, place) = (usize::from(place >> 4), usize::from(place & 15));
        if let Some(table) = tables.get_mut(class).and_then(|of_class| of_class.get_mut(place)) {
            *table = Table::new(counts, symbols);
        }
    }
}

/// The header of a scan (B.2.3); `None` if it is damaged.
fn read_scan<'t>(
    segment: &[u8],
    frame: &Frame,
    tables: &'t [[Option<Table>; 4]; 2],
    interval: u32,
) -> Option<Scan<'t>> {
    let (&count, rest) = segment.split_first()?;
    let (listed, rest) = rest.split_at_checked(2 * usize::from(count))?;
    let &[start, end, bits] = rest.first_chunk()?;
    let component = |&[id, places]: &[u8; 2]| {
        let index = frame.components.iter().position(|component| component.id == id)?;
        let table = |class: usize, place: u8| tables[class].get(usize::from(place))?.as_ref();
        Some((index, [table(0, places >> 4), table(1, places & 15)]))
    };
    let components: Vec<_> = listed.as_chunks().0.iter().map(component).collect::<Option<_>>()?;
    let is_usable = start <= end && end < 64 && !components.is_empty() && (start == 0 || components.len() == 1);
    is_usable.then_some(Scan { components, band: [start.into(), end.into()], bits: [bits >> 4, bits & 15], interval })
}

/// The restart intervals of a scan, without their markers and without fill bytes before them.
fn intervals(data: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = Some(data);
    std::iter::from_fn(move || {
        let data = rest.take()?;
        let is_restart = |pair: &[u8]| pair[0] == 0xff && matches!(pair[1], 0xd0..=0xd7);
        let (interval, behind) = match data.windows(2).position(is_restart) {
            Some(place) => (&data[..place], Some(&data[place + 2..])),
            None => (data, None),
        };
        rest = behind;
        let end = interval.iter().rposition(|&byte| byte != 0xff).map_or(0, |last| last + 1);
        Some(&interval[..end])
    })
}

/// Position behind `name` in the first application segment of this marker that begins with it; `None` if a file has none before its
/// pixels.
pub(super) fn app_segment(bytes: &[u8], marker: u8, name: &[u8]) -> Option<usize> {
    if !bytes.starts_with(&[0xff, 0xd8]) {
        return None;
    }
    let mut position = 2;
    loop {
        let &[0xff, found, high, low] = bytes.get(position..position + 4)? else { return None };
        if found == START_OF_SCAN {
            return None;
        }
        let segment = bytes.get(position + 4..position + 2 + usize::from(u16::from_be_bytes([high, low])))?;
        if found == marker && segment.starts_with(name) {
            return Some(position + 4 + name.len());
        }
        position += 4 + segment.len();
    }
}

/// The code of the next marker and the bytes behind it; fill bytes and stray bytes before the marker are skipped.
fn next_marker(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let start = bytes.iter().position(|&byte| byte == 0xff)?;
    let code = start + bytes[start..].iter().position(|&byte| byte != 0xff)?;
    Some((bytes[code], &bytes[code + 1..]))
}

/// A segment without its two length bytes, and the bytes behind it.
fn split_segment(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    rest.split_at_checked(usize::from(u16::from_be_bytes(*length)).checked_sub(2)?)
}

/// Entropy-coded data, and the bytes from the first marker on that is neither a stuffed FF nor a restart.
fn split_entropy_coded(bytes: &[u8]) -> (&[u8], &[u8]) {
    let is_marker = |pair: &[u8]| pair[0] == 0xff && !matches!(pair[1], 0x00 | 0xd0..=0xd7 | 0xff);
    bytes.split_at(bytes.windows(2).position(is_marker).unwrap_or(bytes.len()))
}

#[cfg(test)]
mod tests;
