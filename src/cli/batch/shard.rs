//! A share of a batch, for arrays of jobs.

use std::{fmt, str::FromStr};

/// Every `of`-th pair, or group of frames, from number `index` on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    of: usize,
}

impl Shard {
    /// Whether the pair or group of this number, from 0, belongs to the share.
    pub fn has(self, number: usize) -> bool {
        number % self.of == self.index
    }

    /// The name of the share's journal.
    pub fn journal(self) -> String {
        format!("report-{}-of-{}.jsonl", self.index, self.of)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parsed = text.split_once('/').and_then(|(index, of)| Some((index.parse().ok()?, of.parse().ok()?)));
        match parsed {
            Some((index, of)) if index < of => Ok(Self { index, of }),
            _ => Err("expected I/N with I from 0 to N-1, as in 0/16"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_belongs_to_one_share() {
        let shares: Vec<Shard> = (0..3).map(|index| format!("{index}/3").parse().expect("a share")).collect();
        for number in 0..10 {
            assert_eq!(shares.iter().filter(|share| share.has(number)).count(), 1, "{number}");
        }
        assert_eq!(shares[2].journal(), "report-2-of-3.jsonl");
        for wrong in ["3/3", "-1/3", "1", "a/b", "0/0", ""] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
