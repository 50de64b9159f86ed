//! The order in which pairs are read and handed out.

use serde_json::json;

use super::{super::record::Record, *};

fn pair(number: usize) -> Pair {
    Pair { name: number.to_string(), left: "left.png".into(), right: None, calibration: None }
}

fn feed(
    pairs: impl Iterator<Item = Result<(Pair, Option<Frame>)>> + Send + 'static,
    grouping: Grouping,
) -> Feed<'static> {
    Feed::new(Box::new(pairs), grouping, |_, _| Ok(None))
}

/// The names of the pairs of all groups, worked on one after the other.
fn names(feed: &Feed<'_>) -> Vec<String> {
    std::iter::from_fn(|| feed.group()).map(|group| group.map(|member| member.pair.name).collect()).collect()
}

#[test]
fn shards_have_whole_groups() {
    let names = |length, shard: Option<&str>| {
        let grouping = Grouping { length, shard: shard.map(|shard| shard.parse().unwrap()) };
        let names = names(&feed((0..7).map(|number| Ok((pair(number), None))), grouping));
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
    let numbers =
        (0..6).map(|number| if number == 4 { Err(anyhow::anyhow!("cut off")) } else { Ok((pair(number), None)) });
    let feed = feed(numbers, Grouping { length: 3, shard: None });
    assert_eq!(names(&feed), ["012", "3"]);
    assert_eq!(feed.into_error().unwrap().to_string(), "cut off");
}

#[test]
fn finished_groups_are_passed_over_and_of_finished_frames_one_is_kept() {
    let finished = |numbers: &'static [usize], follow: &'static [usize]| {
        Feed::new(
            Box::new((0..9).map(|number| Ok((pair(number), None)))),
            Grouping { length: 3, shard: None },
            move |pair, _| {
                let number: usize = pair.name.parse()?;
                let (follows, inputs) = (follow.contains(&number), json!({ "left": { "hash": "0" } }));
                let record = json!({ "name": pair.name, "status": "done", "follows": follows, "inputs": inputs });
                Ok(Record::from_json(record)
                    .filter(|_| numbers.contains(&number))
                    .and_then(|record| record.finished().unwrap()))
            },
        )
    };
    let feed = finished(&[0, 1, 2, 3, 4, 8], &[4]);
    assert!(feed.has_work());
    assert_eq!(names(&feed), ["35", "678"]);
    let feed = finished(&[3, 4, 5, 6, 7, 8], &[]);
    assert_eq!(names(&feed), ["012"]);
    assert!(!finished(&[0, 1, 2, 3, 4, 5, 6, 7, 8], &[]).has_work());
}

/// Frames of 2^26 bytes each: four of them wait at most.
fn frames(count: usize) -> impl Iterator<Item = Result<(Pair, Option<Frame>)>> + Send {
    (0..count).map(|number| Ok((pair(number), Some(Frame::of_bytes(AHEAD / 4)))))
}

#[test]
fn no_more_is_read_ahead_than_has_room() {
    let feed = feed(frames(20), Grouping { length: 8, shard: None });
    let waiting = || feed.state().waiting.values().map(VecDeque::len).sum::<usize>();
    let mut first = feed.group().unwrap();
    assert_eq!(first.next().unwrap().pair.name, "0");
    assert_eq!((waiting(), feed.state().count), (0, 1), "a frame that is asked for is read, and no other one");
    thread::scope(|scope| {
        let second = scope.spawn(|| feed.group().unwrap().map(|member| member.pair.name).collect::<Vec<_>>());
        let mut names = Vec::new();
        for member in first {
            names.push(member.pair.name);
            assert!(waiting() <= 4);
        }
        assert_eq!(names.concat(), "1234567");
        assert_eq!(second.join().unwrap(), ["8", "9", "10", "11", "12", "13", "14", "15"]);
    });
    assert_eq!(names(&feed), ["16171819"]);
    assert_eq!(feed.state().bytes, 0);
}

#[test]
fn nobody_waits_for_a_feed_that_was_stopped() {
    let feed = feed(frames(20), Grouping { length: 16, shard: None });
    let mut first = feed.group().unwrap();
    first.next();
    thread::scope(|scope| {
        let second = scope.spawn(|| feed.group().is_none());
        while feed.state().bytes < AHEAD {
            thread::yield_now();
        }
        feed.stop();
        assert!(second.join().unwrap());
    });
    assert!(first.next().is_none() && feed.group().is_none());
}
