//! The blocks of a scan, counted without computing them: what its data hold of what its frame claims (ITU-T T.81, annexes F and G).

use super::bits::{Bits, Broken, Table};

/// Bytes behind the last block of an interval that are no sign of damage: encoders pad.
const PADDING: usize = 2;

/// Coefficients of a block.
const COEFFICIENTS: u32 = 64;

/// A component of a frame.
pub(super) struct Component {
    pub id: u8,
    /// Blocks across and down per unit of an interleaved scan.
    pub sampling: [u32; 2],
    /// Blocks across and down, with those that pad the last unit.
    blocks: [u32; 2],
    /// Blocks across and down that show the picture.
    shown: [u32; 2],
    /// Which coefficients are not 0, a bit each, block by block; of progressive frames only.
    nonzero: Vec<u64>,
    /// Lowest bit that was sent of each coefficient; `None` before the first.
    lowest: [Option<u8>; COEFFICIENTS as usize],
}

impl Component {
    /// Whether all bits of all coefficients were sent.
    pub fn is_whole(&self) -> bool {
        self.lowest.iter().all(|&bit| bit == Some(0))
    }
}

/// The frame: its components, and units of an interleaved scan across and down.
pub(super) struct Frame {
    pub components: Vec<Component>,
    is_progressive: bool,
    units: [u32; 2],
}

/// What a scan sends of its components.
pub(super) struct Scan<'t> {
    /// Index of each component, and its tables of DC and AC codes.
    pub components: Vec<(usize, [Option<&'t Table>; 2])>,
    /// First and last coefficient.
    pub band: [u32; 2],
    /// Bits below those that were sent before, or 0, and lowest bit of this scan.
    pub bits: [u8; 2],
    /// Units per restart interval, 0 for all.
    pub interval: u32,
}

/// What the data of a scan hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Held {
    /// Units of the scan, and how many of them could not be read.
    pub units: u64,
    pub lost: u64,
    /// Bytes behind the last block of an interval, but for [`PADDING`].
    pub surplus: usize,
}

impl Frame {
    /// The frame of a segment; `None` if the segment is damaged, or names no height, or another sampling than 1 to 4.
    pub fn new(segment: &[u8], is_progressive: bool) -> Option<Self> {
        let (&[_, height_high, height_low, width_high, width_low, count], rest) = segment.split_first_chunk()?;
        let size = [[width_high, width_low], [height_high, height_low]].map(|side| u32::from(u16::from_be_bytes(side)));
        let (listed, _) = rest.as_chunks::<3>();
        let listed = listed.get(..count.into()).filter(|listed| !listed.is_empty())?;
        let sampling = |packed: u8| [u32::from(packed >> 4), u32::from(packed & 15)];
        let all = || listed.iter().map(|&[_, packed, _]| sampling(packed));
        if size.contains(&0) || all().flatten().any(|factor| !(1..=4).contains(&factor)) {
            return None;
        }
        let most = [0, 1].map(|axis| all().map(|factors| factors[axis]).max().unwrap_or(1));
        let units = [0, 1].map(|axis| size[axis].div_ceil(8 * most[axis]));
        let component = |&[id, packed, _]: &[u8; 3]| {
            let sampling = sampling(packed);
            let blocks = [0, 1].map(|axis| units[axis] * sampling[axis]);
            let shown = [0, 1].map(|axis| (size[axis] * sampling[axis]).div_ceil(most[axis]).div_ceil(8));
            let nonzero = if is_progressive { vec![0; blocks[0] as usize * blocks[1] as usize] } else { Vec::new() };
            Component { id, sampling, blocks, shown, nonzero, lowest: [None; COEFFICIENTS as usize] }
        };
        Some(Self { components: listed.iter().map(component).collect(), is_progressive, units })
    }

    /// Whether a scan of a sequential frame has some components only, of a frame with several rows of blocks per unit.
    pub fn has_rows_apart(&self, scan: &Scan) -> bool {
        let is_part = !self.is_progressive && scan.components.len() < self.components.len();
        is_part && self.components.iter().any(|component| component.sampling[1] > 1)
    }

    /// Reads the blocks of a scan from its restart intervals, without their markers.
    pub fn read<'a>(&mut self, scan: &Scan, intervals: impl Iterator<Item = &'a [u8]>) -> Held {
        let alone = match scan.components[..] {
            [(index, _)] => Some(self.components[index].shown),
            _ => None,
        };
        let [across, down] = alone.unwrap_or(self.units);
        let units = u64::from(across) * u64::from(down);
        let mut held = Held { units, ..Held::default() };
        let length = if scan.interval == 0 { units } else { u64::from(scan.interval) };
        let mut first = 0;
        for interval in intervals {
            let end = units.min(first + length);
            let (mut bits, mut run) = (Bits::new(interval), 0);
            let read = (first..end).take_while(|&unit| {
                let at = [(unit % u64::from(across)) as u32, (unit / u64::from(across)) as u32];
                self.unit(scan, at, alone.is_some(), &mut bits, &mut run).is_ok()
            });
            let read = read.count() as u64;
            held.lost += end - first - read;
            // What follows a broken block belongs to the blocks that are lost.
            held.surplus += if read == end - first { bits.left().saturating_sub(PADDING) } else { 0 };
            first = end;
        }
        held.lost += units - first;
        self.note(scan);
        held
    }

    /// Notes which bits of the coefficients were sent.
    fn note(&mut self, scan: &Scan) {
        let [start, end] = if self.is_progressive { scan.band } else { [0, COEFFICIENTS - 1] };
        for &(index, _) in &scan.components {
            let lowest = if self.is_progressive { scan.bits[1] } else { 0 };
            self.components[index].lowest[start as usize..=end as usize].fill(Some(lowest));
        }
    }

    fn unit(
        &mut self,
        scan: &Scan,
        at: [u32; 2],
        is_alone: bool,
        bits: &mut Bits,
        run: &mut u32,
    ) -> Result<(), Broken> {
        for &(index, tables) in &scan.components {
            let component = &mut self.components[index];
            let [across, down] = if is_alone { [1, 1] } else { component.sampling };
            for y in 0..down {
                for x in 0..across {
                    let block =
                        (at[1] * down + y) as usize * component.blocks[0] as usize + (at[0] * across + x) as usize;
                    if self.is_progressive {
                        progressive(scan, tables, bits, run, &mut component.nonzero[block])?;
                    } else {
                        sequential(tables, bits)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// A DC difference, or nothing but its bits.
fn difference(table: Option<&Table>, bits: &mut Bits) -> Result<(), Broken> {
    let size = bits.symbol(table.ok_or(Broken)?)?;
    if size > 16 {
        return Err(Broken);
    }
    bits.take(size.into()).map(drop)
}

/// A block of a sequential frame (F.2.2).
fn sequential([dc, ac]: [Option<&Table>; 2], bits: &mut Bits) -> Result<(), Broken> {
    difference(dc, bits)?;
    let ac = ac.ok_or(Broken)?;
    let mut at = 1;
    while at < COEFFICIENTS {
        let symbol = bits.symbol(ac)?;
        let (zeros, size) = (u32::from(symbol >> 4), u32::from(symbol & 15));
        match (zeros, size) {
            (15, 0) => at += 16,
            (_, 0) => break,
            _ => {
                at += zeros + 1;
                bits.take(size)?;
            }
        }
    }
    if at > COEFFICIENTS { Err(Broken) } else { Ok(()) }
}

/// A block of a scan of a progressive frame (G.1.2), whose coefficients other than 0 are noted.
fn progressive(
    scan: &Scan,
    [dc, ac]: [Option<&Table>; 2],
    bits: &mut Bits,
    run: &mut u32,
    nonzero: &mut u64,
) -> Result<(), Broken> {
    match (scan.band[0], scan.bits[0]) {
        (0, 0) => difference(dc, bits),
        (0, _) => bits.take(1).map(drop),
        (_, 0) => first_of_band(scan.band, ac.ok_or(Broken)?, bits, run, nonzero),
        (..) => refined_band(scan.band, ac.ok_or(Broken)?, bits, run, nonzero),
    }
}

/// The first bits of a band of a block; `run` is the number of blocks without any that follow.
fn first_of_band(
    [start, end]: [u32; 2],
    table: &Table,
    bits: &mut Bits,
    run: &mut u32,
    nonzero: &mut u64,
) -> Result<(), Broken> {
    if *run > 0 {
        *run -= 1;
        return Ok(());
    }
    let mut at = start;
    while at <= end {
        let symbol = bits.symbol(table)?;
        let (zeros, size) = (u32::from(symbol >> 4), u32::from(symbol & 15));
        match (zeros, size) {
            (15, 0) => at += 16,
            (_, 0) => {
                *run = (1 << zeros) - 1 + bits.take(zeros)?;
                return Ok(());
            }
            _ => {
                at += zeros;
                bits.take(size)?;
                if at > end {
                    return Err(Broken);
                }
                *nonzero |= 1 << at;
                at += 1;
            }
        }
    }
    if at > end + 1 { Err(Broken) } else { Ok(()) }
}

/// One more bit of a band of a block: a bit for each coefficient that is not 0, and those that become 1 or -1.
fn refined_band(
    [start, end]: [u32; 2],
    table: &Table,
    bits: &mut Bits,
    run: &mut u32,
    nonzero: &mut u64,
) -> Result<(), Broken> {
    let mut at = start;
    while *run == 0 && at <= end {
        let symbol = bits.symbol(table)?;
        let (mut zeros, size) = (u32::from(symbol >> 4), symbol & 15);
        match size {
            0 if zeros < 15 => {
                *run = (1 << zeros) + bits.take(zeros)?;
                break;
            }
            0 => {}
            1 => {
                bits.take(1)?;
            }
            _ => return Err(Broken),
        }
        // To the coefficient behind as many zeros; those that are not 0 on the way have a bit each.
        while at <= end {
            if *nonzero >> at & 1 == 1 {
                bits.take(1)?;
            } else if zeros == 0 {
                break;
            } else {
                zeros -= 1;
            }
            at += 1;
        }
        if size == 1 {
            if at > end {
                return Err(Broken);
            }
            *nonzero |= 1 << at;
        }
        at += 1;
    }
    if *run > 0 {
        let rest = (at..=end).filter(|at| *nonzero >> at & 1 == 1).count();
        for _ in 0..rest {
            bits.take(1)?;
        }
        *run -= 1;
    }
    Ok(())
}
