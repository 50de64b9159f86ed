//! Pairs that are worked on one after the other: a pair, or frames of a sequence.

use super::{pair::Pair, record::Record, shard::Shard};

/// Pairs in their order, with what an earlier run recorded of those that it has finished.
pub struct Group(pub Vec<(Pair, Option<Record>)>);

impl Group {
    /// Whether an earlier run has finished all pairs.
    pub fn is_finished(&self) -> bool {
        self.0.iter().all(|(_, record)| record.is_some())
    }
}

/// The pairs in groups of `length`, as far as they belong to the `shard`.
pub fn grouped(pairs: Vec<Pair>, length: usize, shard: Option<Shard>) -> Vec<Vec<Pair>> {
    let groups = pairs.chunks(length).enumerate();
    groups.filter(|&(number, _)| shard.is_none_or(|shard| shard.has(number))).map(|(_, group)| group.to_vec()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_have_whole_groups() {
        let pair =
            |number: u32| Pair { name: number.to_string(), left: "left.png".into(), right: None, calibration: None };
        let names = |length, shard: Option<&str>| {
            let groups = grouped((0..7).map(pair).collect(), length, shard.map(|shard| shard.parse().unwrap()));
            groups.iter().map(|group| group.iter().map(|pair| &*pair.name).collect::<String>()).collect::<Vec<_>>()
        };
        assert_eq!(names(3, None), ["012", "345", "6"]);
        assert_eq!(names(3, Some("0/2")), ["012", "6"]);
        assert_eq!(names(3, Some("1/2")), ["345"]);
        assert_eq!(names(1, Some("1/3")), ["1", "4"]);
    }
}
