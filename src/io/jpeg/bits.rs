//! Huffman codes of JPEG: the bits of a scan and the tables of their codes (ITU-T T.81, annexes C and F.2.2).

/// Bits that a table looks up at once.
const AHEAD: u32 = 8;

/// The codes of a table.
#[derive(Clone)]
pub(super) struct Table {
    /// By the next eight bits: length of the code that they begin with and its symbol; length 0 for longer codes.
    short: [(u8, u8); 1 << AHEAD],
    /// By length: the first code that is too large for it, and what a code exceeds the index of its symbol by.
    long: [(i32, i32); 17],
    symbols: Vec<u8>,
}

impl Table {
    /// The table of a list of numbers of codes per length, 1 to 16, and of symbols; `None` if they do not fit each other.
    pub fn new(counts: &[u8; 16], symbols: &[u8]) -> Option<Self> {
        let mut table = Self { short: [(0, 0); 1 << AHEAD], long: [(0, 0); 17], symbols: symbols.into() };
        let (mut code, mut index) = (0, 0);
        for (length, &count) in (1_u32..).zip(counts) {
            table.long[length as usize] = (code + i32::from(count), code - index);
            for _ in 0..count {
                let symbol = *symbols.get(index as usize)?;
                if code >= 1 << length {
                    return None;
                }
                if length <= AHEAD {
                    let first = (code as usize) << (AHEAD - length);
                    table.short[first..first + (1 << (AHEAD - length))].fill((length as u8, symbol));
                }
                (code, index) = (code + 1, index + 1);
            }
            code <<= 1;
        }
        Some(table)
    }
}

/// Why a symbol could not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Broken;

/// The bits between two markers.
pub(super) struct Bits<'a> {
    bytes: &'a [u8],
    /// Bits that were taken from `bytes`, the next one the highest of the lowest `count`.
    ahead: u64,
    count: u32,
}

impl<'a> Bits<'a> {
    /// The bits of entropy-coded bytes without a marker; an FF is followed by a stuffed 0.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, ahead: 0, count: 0 }
    }

    fn fill(&mut self) {
        while self.count <= 56 {
            let Some((&byte, rest)) = self.bytes.split_first() else { return };
            self.bytes = if byte == 0xff { rest.get(1..).unwrap_or_default() } else { rest };
            self.ahead = self.ahead << 8 | u64::from(byte);
            self.count += 8;
        }
    }

    /// The next bits, up to 16.
    pub fn take(&mut self, count: u32) -> Result<u32, Broken> {
        if self.count < count {
            self.fill();
        }
        self.count = self.count.checked_sub(count).ok_or(Broken)?;
        Ok((self.ahead >> self.count) as u32 & ((1 << count) - 1))
    }

    /// The symbol of the next code.
    pub fn symbol(&mut self, table: &Table) -> Result<u8, Broken> {
        if self.count < 16 {
            self.fill();
        }
        if self.count >= AHEAD {
            let (length, symbol) = table.short[(self.ahead >> (self.count - AHEAD)) as usize & ((1 << AHEAD) - 1)];
            if length > 0 {
                self.count -= u32::from(length);
                return Ok(symbol);
            }
        }
        let mut code = 0;
        for length in 1..=16 {
            code = code << 1 | self.take(1)? as i32;
            let (end, offset) = table.long[length];
            if code < end {
                return table.symbols.get((code - offset) as usize).copied().ok_or(Broken);
            }
        }
        Err(Broken)
    }

    /// Number of whole bytes that were not read.
    pub fn left(&self) -> usize {
        self.bytes.len() + self.count as usize / 8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_by_hand() {
        // Codes 0, 10, 110 and one of ten bits, 1110000000.
        let mut counts = [0; 16];
        (counts[0], counts[1], counts[2], counts[9]) = (1, 1, 1, 1);
        let table = Table::new(&counts, b"abcd").unwrap();
        // 0 10 110 1110000000, then 24 bits; an FF has a stuffed 0 behind it.
        let bytes = [0b0101_1011, 0b1000_0000, 0b0101_1111, 0xff, 0, 0b1000_0000];
        let mut bits = Bits::new(&bytes);
        let symbols: Vec<_> = (0..4).map(|_| bits.symbol(&table).unwrap()).collect();
        assert_eq!(symbols, b"abcd");
        assert_eq!((bits.take(3), bits.take(12), bits.left()), (Ok(0b010), Ok(0b1111_1111_1111), 1));
        assert_eq!((bits.take(2), bits.take(6), bits.take(2), bits.take(1)), (Ok(0b11), Ok(0), Err(Broken), Ok(0)));
        // A code that stands for nothing.
        assert_eq!(Bits::new(&[0xff, 0, 0xff, 0]).symbol(&table), Err(Broken));
        assert_eq!(Bits::new(&[]).symbol(&table), Err(Broken));
    }

    #[test]
    fn tables_that_overflow_are_none() {
        let mut counts = [0; 16];
        counts[0] = 3;
        assert!(Table::new(&counts, b"abc").is_none(), "two codes have one bit");
        counts[0] = 2;
        assert!(Table::new(&counts, b"a").is_none(), "a symbol is missing");
    }
}
