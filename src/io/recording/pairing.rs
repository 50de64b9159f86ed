//! Which frames of two topics belong together: those of the same time, or the nearest ones.

use std::collections::{HashMap, VecDeque};

/// Most bytes of frames that wait for their partners.
const MOST: usize = 1 << 28;

/// A frame that waits for its partner.
struct Waiting<T> {
    /// Time, in nanoseconds.
    stamp: u64,
    frame: T,
    bytes: usize,
}

/// Frames of the left and of the right topic, those that wait in the order of their times. Clocks are set back, and messages overtake
/// each other.
///
/// Frames of the same time are a pair. Of others the earliest ones are a pair if their times differ by at most half of the least time between
/// one of them and its neighbours in its topic, so that each is the one nearest to the other.
pub(super) struct Pairing<T> {
    waiting: [VecDeque<Waiting<T>>; 2],
    /// Times of the last frames that no longer wait.
    last: [Option<u64>; 2],
    /// Greatest times so far of this recording.
    latest: [Option<u64>; 2],
    /// Times of the left frames of all pairs, each of which names one pair of a recording, and the number of the last recording that has one.
    paired: HashMap<u64, u32>,
    recording: u32,
    /// Bytes of all that wait.
    bytes: usize,
    has_ended: bool,
    /// Frames without a partner.
    pub alone: [u64; 2],
    /// Those of them that were given up since they were too many to wait.
    pub given_up: [u64; 2],
}

impl<T> Pairing<T> {
    pub fn new() -> Self {
        Self {
            waiting: [VecDeque::new(), VecDeque::new()],
            last: [None; 2],
            latest: [None; 2],
            paired: HashMap::new(),
            recording: 0,
            bytes: 0,
            has_ended: false,
            alone: [0; 2],
            given_up: [0; 2],
        }
    }

    /// Takes the next frame of a topic, 0 left or 1 right. A second one of a time finds no partner.
    pub fn add(&mut self, side: usize, stamp: u64, frame: T, bytes: usize) {
        let place = self.waiting[side].binary_search_by_key(&stamp, |waiting| waiting.stamp);
        let is_paired = side == 0 && self.paired.get(&stamp) == Some(&self.recording);
        let (Err(place), false) = (place, is_paired) else {
            self.alone[side] += 1;
            return;
        };
        self.bytes += bytes;
        self.latest[side] = self.latest[side].max(Some(stamp));
        self.waiting[side].insert(place, Waiting { stamp, frame, bytes });
        // Frames whose topic is far ahead of the other one wait in vain.
        while self.bytes > MOST {
            let ahead = usize::from(self.waiting[1].len() > self.waiting[0].len());
            if self.waiting[ahead].len() <= 2 {
                break;
            }
            self.given_up[ahead] += u64::from(self.drop_first(ahead));
        }
    }

    /// No frame follows in this recording.
    pub fn end(&mut self) {
        self.has_ended = true;
    }

    /// Whether a frame of this time goes back behind others of its topic.
    pub fn goes_back(&self, side: usize, stamp: u64) -> bool {
        self.latest[side].is_some_and(|latest| stamp <= latest)
    }

    /// Another recording begins, once the one before it has ended and all of its pairs were taken: none of its frames has a partner there.
    pub fn begin(&mut self) {
        self.has_ended = false;
        (self.last, self.latest) = ([None; 2], [None; 2]);
        self.recording += 1;
    }

    /// The next pair, if it is known by the frames so far: the time of its left frame, whether an earlier recording has a pair of this time,
    /// and both frames.
    pub fn next(&mut self) -> Option<(u64, bool, [T; 2])> {
        loop {
            let [Some(left), Some(right)] = self.waiting.each_ref().map(VecDeque::front) else {
                if self.has_ended {
                    [0, 1].into_iter().for_each(|side| while self.drop_first(side) {});
                }
                return None;
            };
            let apart = left.stamp.abs_diff(right.stamp);
            let are_known = self.has_ended || self.waiting.iter().all(|frames| frames.len() > 1);
            if apart > 0 && !are_known {
                return None;
            }
            if apart == 0 || self.gap().is_some_and(|gap| 2 * u128::from(apart) <= u128::from(gap)) {
                let stamp = left.stamp;
                let is_again = self.paired.insert(stamp, self.recording).is_some();
                let [left, right] = [0, 1].map(|side| self.take(side));
                return left.zip(right).map(|(left, right)| (stamp, is_again, [left, right]));
            }
            let earlier = usize::from(right.stamp < left.stamp);
            self.drop_first(earlier);
        }
    }

    /// The least time between the first frame of a topic and its neighbours there.
    fn gap(&self) -> Option<u64> {
        let gaps = self.waiting.iter().zip(self.last).flat_map(|(frames, last)| {
            let stamp = |place: usize| frames.get(place).map(|frame| frame.stamp);
            [last.zip(stamp(0)), stamp(0).zip(stamp(1))]
        });
        gaps.flatten().map(|(one, other)| one.abs_diff(other)).min()
    }

    fn take(&mut self, side: usize) -> Option<T> {
        let Waiting { stamp, frame, bytes } = self.waiting[side].pop_front()?;
        self.bytes -= bytes;
        self.last[side] = Some(stamp);
        Some(frame)
    }

    /// Gives up the first frame; whether there was one.
    fn drop_first(&mut self, side: usize) -> bool {
        let dropped = self.take(side).is_some();
        self.alone[side] += u64::from(dropped);
        dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pairs of frames that come in this order, and how many are alone.
    fn paired(frames: &[(usize, u64)]) -> (Vec<[u64; 2]>, [u64; 2]) {
        let mut pairing = Pairing::new();
        let mut pairs = Vec::new();
        for &(side, stamp) in frames {
            pairing.add(side, stamp, stamp, 1);
            pairs.extend(std::iter::from_fn(|| pairing.next()).map(|(.., pair)| pair));
        }
        pairing.end();
        pairs.extend(std::iter::from_fn(|| pairing.next()).map(|(.., pair)| pair));
        (pairs, pairing.alone)
    }

    /// Frames of the left and of the right topic, in turn.
    fn in_turn(left: &[u64], right: &[u64]) -> Vec<(usize, u64)> {
        let at = |side, stamps: &[u64], place: usize| stamps.get(place).map(|&stamp| (side, stamp));
        (0..left.len().max(right.len())).flat_map(|n| [at(0, left, n), at(1, right, n)]).flatten().collect()
    }

    #[test]
    fn frames_of_one_time_are_a_pair_in_any_order_of_the_topics() {
        let expected = (vec![[10, 10], [20, 20], [30, 30]], [0, 0]);
        assert_eq!(paired(&in_turn(&[10, 20, 30], &[10, 20, 30])), expected);
        assert_eq!(paired(&[(1, 10), (1, 20), (1, 30), (0, 10), (0, 20), (0, 30)]), expected);
        let (mut pairing, mut first) = (Pairing::new(), Vec::new());
        for side in [0, 1] {
            pairing.add(side, 10, side, 1);
            first.extend(pairing.next());
        }
        assert_eq!(first, [(10, false, [0, 1])], "nothing needs to follow");
    }

    #[test]
    fn a_frame_without_a_partner_takes_none_of_another() {
        assert_eq!(paired(&in_turn(&[10, 20, 30, 40], &[10, 30, 40])), (vec![[10, 10], [30, 30], [40, 40]], [1, 0]));
        assert_eq!(paired(&in_turn(&[10, 20, 30], &[30])), (vec![[30, 30]], [2, 0]));
        assert_eq!(paired(&in_turn(&[10], &[11])), (vec![], [1, 1]), "nothing tells what near is");
        assert_eq!(paired(&in_turn(&[10, 20], &[])), (vec![], [2, 0]));
        assert_eq!(
            paired(&in_turn(&[10, 20, 15, 20, 30], &[10, 20, 30])).1,
            [2, 0],
            "one that has no partner, one twice"
        );
    }

    #[test]
    fn times_that_go_back_lose_no_other_frames() {
        let all = |stamps: &[u64]| (stamps.iter().map(|&stamp| [stamp; 2]).collect::<Vec<_>>(), [0; 2]);
        assert_eq!(
            paired(&in_turn(&[40, 50, 60, 10, 20], &[40, 50, 60, 10, 20])),
            all(&[40, 50, 60, 10, 20]),
            "a clock set back"
        );
        assert_eq!(paired(&in_turn(&[10, 30, 20, 40], &[10, 20, 30, 40])), all(&[10, 20, 30, 40]), "overtaken");
        let (pairs, alone) = paired(&in_turn(&[10, 999, 30, 40, 50], &[10, 20, 30, 40, 50]));
        assert_eq!((pairs, alone), (vec![[10; 2], [30; 2], [40; 2], [50; 2]], [1, 1]), "a time in the future");
        let (pairs, alone) = paired(&in_turn(&[10, 20, 10, 20], &[10, 20, 10, 20]));
        assert_eq!((pairs, alone), (vec![[10; 2], [20; 2]], [2, 2]), "a recording that begins anew");
    }

    #[test]
    fn frames_of_another_recording_are_pairs_of_their_own() {
        let (mut pairing, mut found) = (Pairing::new(), Vec::new());
        // The last left frame of the first recording has no partner, and the second one has both.
        for (recording, last) in [(0, None), (1, Some(20))] {
            for (side, stamp) in [(0, 10), (1, 10), (0, 20)].into_iter().chain(last.map(|last| (1, last))) {
                if recording == 1 && pairing.recording == 0 {
                    assert!(pairing.goes_back(side, stamp));
                    pairing.end();
                    assert_eq!(pairing.next(), None);
                    pairing.begin();
                }
                assert!(!pairing.goes_back(side, stamp));
                pairing.add(side, stamp, (recording, side), 1);
                found.extend(pairing.next());
            }
        }
        let pair = |stamp, is_again, recording| (stamp, is_again, [(recording, 0), (recording, 1)]);
        assert_eq!(found, [pair(10, false, 0), pair(10, true, 1), pair(20, false, 1)]);
        assert_eq!(pairing.alone, [1, 0]);
    }

    #[test]
    fn the_nearest_frames_are_a_pair_within_half_a_period() {
        assert_eq!(paired(&in_turn(&[10, 20, 30], &[15, 25, 35])), (vec![[10, 15], [20, 25], [30, 35]], [0, 0]));
        assert_eq!(paired(&in_turn(&[10, 20, 30], &[4, 14, 24])), (vec![[10, 14], [20, 24]], [1, 1]));
        assert_eq!(paired(&in_turn(&[100, 200, 300], &[151, 251, 351])), (vec![[200, 151], [300, 251]], [1, 1]));
        // One camera is slower: each of its frames has the nearest one of the other.
        assert_eq!(paired(&in_turn(&[0, 10, 20, 30, 40], &[1, 21, 41])), (vec![[0, 1], [20, 21], [40, 41]], [2, 0]));
    }

    #[test]
    fn frames_of_a_topic_that_is_far_ahead_are_given_up() {
        let mut pairing = Pairing::new();
        (0..8).for_each(|stamp| pairing.add(0, stamp, (), MOST / 4));
        pairing.add(1, 7, (), MOST / 4);
        assert!(pairing.bytes <= MOST && pairing.alone[0] >= 3, "{:?}", pairing.alone);
        assert_eq!(pairing.given_up, pairing.alone);
        assert_eq!(pairing.next(), None);
        pairing.end();
        assert_eq!(pairing.next(), Some((7, false, [(), ()])));
    }
}
