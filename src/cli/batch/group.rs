//! Pairs that are worked on one after the other: a pair, or frames of a sequence.

use anyhow::Result;

use super::{pair::Pair, record::Record, shard::Shard, video::Frame};

/// A pair of a group.
pub struct Member {
    pub pair: Pair,
    /// The picture of both views, if it was read already.
    pub frame: Option<Frame>,
    /// What an earlier run recorded that has finished the pair.
    pub finished: Option<Record>,
}

/// Pairs in their order.
pub struct Group(pub Vec<Member>);

impl Group {
    /// Whether earlier runs have finished all pairs.
    pub fn is_finished(&self) -> bool {
        self.0.iter().all(|member| member.finished.is_some())
    }
}

/// How pairs are grouped.
#[derive(Clone, Copy)]
pub struct Grouping {
    /// Pairs of a group, at least 1.
    pub length: usize,
    pub shard: Option<Shard>,
}

impl Grouping {
    /// How many of `count` pairs belong to the shard.
    pub fn count(self, count: usize) -> usize {
        (0..count).filter(|number| self.has(number / self.length)).count()
    }

    fn has(self, group: usize) -> bool {
        self.shard.is_none_or(|shard| shard.has(group))
    }

    /// The groups of the shard in which there is something to do, without reading further than a group. `finished` looks for what an earlier
    /// run has recorded. An error comes after the pairs that were read before it.
    pub fn of(
        self,
        mut pairs: impl Iterator<Item = Result<(Pair, Option<Frame>)>>,
        mut finished: impl FnMut(&Pair) -> Result<Option<Record>>,
    ) -> impl Iterator<Item = Result<Group>> {
        let (mut groups, mut ended) = (0.., None);
        let mut group = move || -> Result<Option<Group>> {
            if let Some(error) = ended.take() {
                return Err(error);
            }
            let is_here = self.has(groups.next().unwrap_or_default());
            let mut group = Vec::new();
            for read in pairs.by_ref().take(self.length) {
                let member = read.and_then(|(pair, frame)| {
                    let finished = if is_here { finished(&pair)? } else { None };
                    Ok(Member { pair, frame: frame.filter(|_| is_here), finished })
                });
                match member {
                    Ok(member) => group.push(member),
                    Err(error) => {
                        ended = Some(error);
                        break;
                    }
                }
            }
            if group.is_empty() {
                return ended.take().map_or(Ok(None), Err);
            }
            let group = Group(if is_here { group } else { Vec::new() });
            Ok(Some(group))
        };
        std::iter::from_fn(move || group().transpose()).filter(|group| !group.as_ref().is_ok_and(Group::is_finished))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_have_whole_groups() {
        let pair =
            |number: u32| Pair { name: number.to_string(), left: "left.png".into(), right: None, calibration: None };
        let names = |length, shard: Option<&str>| {
            let grouping = Grouping { length, shard: shard.map(|shard| shard.parse().unwrap()) };
            let groups = grouping.of((0..7).map(|number| Ok((pair(number), None))), |_| Ok(None));
            let name = |group: Result<Group>| group.unwrap().0.into_iter().map(|member| member.pair.name).collect();
            let names: Vec<String> = groups.map(name).collect();
            assert_eq!(names.concat().len(), grouping.count(7));
            names
        };
        assert_eq!(names(3, None), ["012", "345", "6"]);
        assert_eq!(names(3, Some("0/2")), ["012", "6"]);
        assert_eq!(names(3, Some("1/2")), ["345"]);
        assert_eq!(names(1, Some("1/3")), ["1", "4"]);
    }

    #[test]
    fn what_was_read_before_an_error_is_worked_on() {
        let pair = |number: i32| match number {
            4 => Err(anyhow::anyhow!("cut off")),
            _ => Ok((Pair { name: number.to_string(), left: "l".into(), right: None, calibration: None }, None)),
        };
        let grouping = Grouping { length: 3, shard: None };
        let mut groups = grouping.of((0..5).map(pair), |_| Ok(None));
        let lengths: Vec<_> = groups.by_ref().map(|group| group.ok().map(|Group(members)| members.len())).collect();
        assert_eq!(lengths, [Some(3), Some(1), None]);
    }
}
