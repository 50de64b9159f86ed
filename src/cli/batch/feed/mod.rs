//! The pairs of a batch in their order, handed out to several threads in groups that are worked on one after the other: single pairs, or
//! frames of a sequence.

use std::{
    collections::{BTreeMap, VecDeque},
    mem,
    sync::{Condvar, Mutex, MutexGuard},
    thread,
};

use anyhow::{Error, Result};

use super::{frame::Frame, pair::Pair, record::Finished, shard::Shard};

/// Most bytes of frames that are read ahead.
const AHEAD: usize = 1 << 28;

/// A pair of a group.
pub struct Member {
    pub pair: Pair,
    /// The pictures, if they were read already.
    pub frame: Option<Frame>,
    /// What an earlier run recorded that has finished the pair.
    pub finished: Option<Finished>,
}

impl Member {
    fn bytes(&self) -> usize {
        self.frame.as_ref().map_or(0, Frame::bytes)
    }
}

/// Pairs as they are read.
pub type Pairs = Box<dyn Iterator<Item = Result<(Pair, Option<Frame>)>> + Send>;

/// Looks for what an earlier run has recorded.
type Look<'a> = Box<dyn Fn(&Pair, Option<&Frame>) -> Result<Option<Finished>> + Sync + 'a>;

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
}

/// Pairs that are read as threads ask for them. Whoever needs a pair reads it. A thread that asks for a group while the one before it is not
/// read through reads that one on for the other thread, as long as no more than [`AHEAD`] bytes of frames wait.
pub struct Feed<'a> {
    grouping: Grouping,
    finished: Look<'a>,
    state: Mutex<State>,
    /// Something was read or taken, or all has ended.
    changed: Condvar,
}

struct State {
    source: Source,
    /// Pairs that were read.
    count: usize,
    /// Members that wait for the threads of their groups, by the number of the group.
    waiting: BTreeMap<usize, VecDeque<Member>>,
    /// Bytes of all that wait.
    bytes: usize,
    /// The first group that was not handed out.
    next: usize,
    /// What ended the reading.
    error: Option<Error>,
}

enum Source {
    Open(Pairs),
    /// A thread reads from it.
    InUse,
    Ended,
}

/// The members of a group, read as they are asked for.
pub struct Group<'a> {
    feed: &'a Feed<'a>,
    number: usize,
}

impl<'a> Feed<'a> {
    /// The pairs of the shard. `finished` looks for what an earlier run has recorded.
    pub fn new(
        pairs: Pairs,
        grouping: Grouping,
        finished: impl Fn(&Pair, Option<&Frame>) -> Result<Option<Finished>> + Sync + 'a,
    ) -> Self {
        let state =
            State { source: Source::Open(pairs), count: 0, waiting: BTreeMap::new(), bytes: 0, next: 0, error: None };
        Self { grouping, finished: Box::new(finished), state: Mutex::new(state), changed: Condvar::new() }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("no panic while it is held")
    }

    /// Whether there is anything to do. Groups that earlier runs have finished are passed over.
    pub fn has_work(&self) -> bool {
        let mut state = self.state();
        loop {
            if state.waiting.values().any(has_work) {
                return true;
            }
            if matches!(state.source, Source::Ended) {
                return false;
            }
            state = self.read_on(state);
        }
    }

    /// The next group of which something is to do.
    pub fn group(&'a self) -> Option<Group<'a>> {
        let mut state = self.state();
        loop {
            let first = state.next;
            if let Some((&number, _)) = state.waiting.range(first..).find(|(_, members)| has_work(members)) {
                state.next = number + 1;
                return Some(Group { feed: self, number });
            }
            if matches!(state.source, Source::Ended) {
                return None;
            }
            state = if state.has_enough() { self.wait(state) } else { self.read_on(state) };
        }
    }

    /// Hands out no more pairs.
    pub fn stop(&self) {
        let mut state = self.state();
        state.source = Source::Ended;
        state.waiting.clear();
        state.bytes = 0;
        self.changed.notify_all();
    }

    /// Whether no pair was read, of this shard or of others.
    pub fn is_empty(&self) -> bool {
        self.state().count == 0
    }

    /// The error that came after the last pair.
    pub fn into_error(self) -> Option<Error> {
        self.state.into_inner().expect("no panic while it is held").error
    }

    fn wait<'s>(&self, state: MutexGuard<'s, State>) -> MutexGuard<'s, State> {
        self.changed.wait(state).expect("no panic while it is held")
    }

    /// Reads a pair, or waits until another thread has read one.
    fn read_on<'s>(&'s self, mut state: MutexGuard<'s, State>) -> MutexGuard<'s, State> {
        let mut pairs = match mem::replace(&mut state.source, Source::InUse) {
            Source::Open(pairs) => pairs,
            Source::InUse => return self.wait(state),
            Source::Ended => {
                state.source = Source::Ended;
                return state;
            }
        };
        let group = state.count / self.grouping.length;
        drop(state);
        // A source may keep its reader waiting: not while other threads ask for what was read.
        let stop_on_panic = StopOnPanic(self);
        let read = pairs.next().map(|read| self.member(group, read));
        drop(stop_on_panic);
        let mut state = self.state();
        if matches!(state.source, Source::Ended) {
            return state;
        }
        state.source = Source::Ended;
        match read {
            Some(Ok(member)) => {
                state.source = Source::Open(pairs);
                state.count += 1;
                member.into_iter().for_each(|member| state.add(group, member));
            }
            Some(Err(error)) => state.error = Some(error),
            None => {}
        }
        self.changed.notify_all();
        state
    }

    /// A pair that was read as a member of its group, if that belongs to the shard.
    fn member(&self, group: usize, read: Result<(Pair, Option<Frame>)>) -> Result<Option<Member>> {
        let (pair, frame) = read?;
        if !self.grouping.has(group) {
            return Ok(None);
        }
        let finished = (self.finished)(&pair, frame.as_ref())?;
        Ok(Some(Member { pair, frame, finished }))
    }
}

/// Threads that wait for one that has panicked wait no longer.
struct StopOnPanic<'a>(&'a Feed<'a>);

impl Drop for StopOnPanic<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.0.stop();
        }
    }
}

/// Whether something is to do for the members of a group.
fn has_work(members: &VecDeque<Member>) -> bool {
    members.iter().any(|member| member.finished.is_none())
}

impl State {
    /// Adds a member of the last group. Of those that are finished one is kept, which later ones may follow.
    fn add(&mut self, group: usize, member: Member) {
        let (next, bytes) = (self.next, &mut self.bytes);
        self.waiting.retain(|&number, members| {
            let is_passed_over = (next..group).contains(&number) && !has_work(members);
            if is_passed_over {
                *bytes -= members.iter().map(Member::bytes).sum::<usize>();
            }
            !is_passed_over
        });
        let members = self.waiting.entry(group).or_default();
        if let Some(finished) = &member.finished {
            if finished.follows {
                return;
            }
            if members.back().is_some_and(|before| before.finished.is_some()) {
                self.bytes -= members.pop_back().map_or(0, |before| before.bytes());
            }
        }
        self.bytes += member.bytes();
        members.push_back(member);
    }

    fn take(&mut self, group: usize) -> Option<Member> {
        let member = self.waiting.get_mut(&group)?.pop_front()?;
        self.bytes -= member.bytes();
        Some(member)
    }

    /// Whether frames wait for threads that are at work.
    fn has_enough(&self) -> bool {
        self.bytes >= AHEAD && self.waiting.range(..self.next).any(|(_, members)| !members.is_empty())
    }
}

impl Iterator for Group<'_> {
    type Item = Member;

    fn next(&mut self) -> Option<Member> {
        let mut state = self.feed.state();
        loop {
            if let Some(member) = state.take(self.number) {
                self.feed.changed.notify_all();
                return Some(member);
            }
            let is_whole = state.count >= (self.number + 1).saturating_mul(self.feed.grouping.length);
            if is_whole || matches!(state.source, Source::Ended) {
                state.waiting.remove(&self.number);
                return None;
            }
            state = self.feed.read_on(state);
        }
    }
}

#[cfg(test)]
mod tests;
