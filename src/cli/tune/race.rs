//! Races of candidates against what a device gets by default.
//!
//! Both run in turn, so that whatever else loads the machine slows down both. Of times that are slowed down and never sped up, the least are
//! nearest to the truth; the median of the ratios in rounds says whether the least are typical.

use anyhow::Result;

/// Fewest rounds that tell which of two is faster.
pub const LEAST_ROUNDS: u32 = 5;

/// A candidate takes the place of the default if it takes at most this share of the time: less is noise.
const CLEARLY_FASTER: f64 = 0.97;

/// A candidate that takes more than this multiple of the default's time in the first round runs no more.
const FAR_SLOWER: f64 = 2.0;

/// Runs once and returns the time in milliseconds.
pub type Runner<'r> = Box<dyn FnMut() -> Result<f64> + 'r>;

/// The times of a candidate and of the default beside it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Race {
    /// Default and candidate, round by round, in milliseconds.
    rounds: Vec<[f64; 2]>,
}

impl Race {
    /// Races `candidate` against `default` over so many rounds; fewer if the candidate is far slower, or [`LEAST_ROUNDS`] are run and there is
    /// no time left.
    fn run(rounds: u32, default: &mut Runner, mut candidate: Runner, has_time: &dyn Fn() -> bool) -> Result<Self> {
        let mut race = Self::default();
        for round in 0..rounds {
            // One begins, then the other: a load that comes and goes meets both.
            let times = if round % 2 == 0 {
                [default()?, candidate()?]
            } else {
                let time = candidate()?;
                [default()?, time]
            };
            race.rounds.push(times);
            let is_far_slower = round == 0 && times[1] > FAR_SLOWER * times[0];
            if is_far_slower || race.is_decided() && !has_time() {
                break;
            }
        }
        Ok(race)
    }

    /// Whether there are rounds enough.
    fn is_decided(&self) -> bool {
        self.rounds.len() >= LEAST_ROUNDS as usize
    }

    /// The least time of the candidate in milliseconds; `None` if it did not run.
    pub fn least(&self) -> Option<f64> {
        self.rounds.iter().map(|round| round[1]).min_by(f64::total_cmp)
    }

    /// The least time of the default in milliseconds; `None` if it did not run.
    fn least_of_default(&self) -> Option<f64> {
        self.rounds.iter().map(|round| round[0]).min_by(f64::total_cmp)
    }

    /// The candidate's time divided by the default's, the median of all rounds, the larger one of two in the middle; `None` without rounds.
    pub fn ratio(&self) -> Option<f64> {
        let mut ratios: Vec<f64> = self.rounds.iter().map(|[default, candidate]| candidate / default).collect();
        ratios.sort_by(f64::total_cmp);
        ratios.get(ratios.len() / 2).copied()
    }

    /// Whether the candidate is clearly faster than the default, whose least time in this race and others is `default`.
    fn is_won(&self, default: f64) -> bool {
        let at_most = |value: Option<f64>, most: f64| value.is_some_and(|value| value <= most);
        self.is_decided() && at_most(self.ratio(), CLEARLY_FASTER) && at_most(self.least(), CLEARLY_FASTER * default)
    }
}

/// The races of all candidates, and which of them takes the place of the default.
#[derive(Debug)]
pub struct Races {
    /// One per candidate, without rounds if there was no time for it.
    pub all: Vec<Race>,
    /// The candidate to take in place of the default: the fastest of those that are clearly faster, and were so once more at the end.
    pub winner: Option<usize>,
    /// The least time of the default in milliseconds.
    pub default: f64,
}

impl Races {
    /// Races `candidates`, prepared one after the other from their index, over so many rounds each. None begins when there is no time left,
    /// but the last race, which decides.
    pub fn run<'r>(
        candidates: usize,
        rounds: u32,
        mut default: Runner,
        mut prepare: impl FnMut(usize) -> Result<Runner<'r>>,
        has_time: &dyn Fn() -> bool,
    ) -> Result<Self> {
        let mut all = Vec::new();
        let mut least = default()?;
        for index in 0..candidates {
            let race = match has_time() {
                true => Race::run(rounds, &mut default, prepare(index)?, has_time)?,
                false => Race::default(),
            };
            least = race.least_of_default().map_or(least, |time| time.min(least));
            all.push(race);
        }
        let won = (0..candidates).filter(|&index| all[index].is_won(least));
        let ratio = |&index: &usize| all[index].ratio().unwrap_or(f64::INFINITY);
        let fastest = won.min_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        let mut winner = None;
        if let Some(index) = fastest {
            let last = Race::run(rounds, &mut default, prepare(index)?, has_time)?;
            least = last.least_of_default().map_or(least, |time| time.min(least));
            winner = last.is_won(least).then_some(index);
        }
        Ok(Self { all, winner, default: least })
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// The races of candidates that take these times while the default takes 10 ms; `slowed` multiplies each run's time.
    fn races(times: &[f64], rounds: u32, slowed: &dyn Fn() -> f64, has_time: &dyn Fn() -> bool) -> Races {
        let runner = |time: f64| -> Runner { Box::new(move || Ok(time * slowed())) };
        Races::run(times.len(), rounds, runner(10.0), |index| Ok(runner(times[index])), has_time).unwrap()
    }

    fn quiet(times: &[f64]) -> Races {
        races(times, 10, &|| 1.0, &|| true)
    }

    #[test]
    fn another_candidate_must_be_clearly_faster() {
        assert_eq!(quiet(&[9.9, 90.0, 10.0]).winner, None);
        assert_eq!(quiet(&[9.9, 9.0, 8.0, 90.0]).winner, Some(2));
        assert_eq!(quiet(&[]).winner, None);
    }

    #[test]
    fn a_far_slower_candidate_runs_once() {
        let races = quiet(&[25.0, 9.0]);
        assert_eq!((races.all[0].rounds.len(), races.all[0].ratio()), (1, Some(2.5)));
        assert_eq!((races.all[1].rounds.len(), races.winner), (10, Some(1)));
    }

    /// Some runs take three times as long, alone or in a row, from seeds: of 40 candidates that are as fast as the default or slower none is kept.
    #[test]
    fn noise_keeps_nothing_that_is_slower() {
        let times: Vec<f64> = (0..40).map(|i| 10.0 + f64::from(i % 20)).collect();
        for share in [10, 30, 50] {
            for lasting in [1, 2, 3, 7, 20] {
                for seed in 0..100_u32 {
                    let (state, slow, left) = (Cell::new(seed * 3 + share), Cell::new(false), Cell::new(0));
                    let slowed = || {
                        if left.get() == 0 {
                            state.set(state.get().wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
                            slow.set((state.get() >> 16) % 100 < share);
                            left.set(lasting);
                        }
                        left.set(left.get() - 1);
                        if slow.get() { 3.0 } else { 1.0 }
                    };
                    for rounds in [LEAST_ROUNDS, 10] {
                        let winner = races(&times, rounds, &slowed, &|| true).winner;
                        assert_eq!(winner, None, "{share} % slow, {lasting} in a row, seed {seed}");
                    }
                }
            }
        }
    }

    /// A load that ends, such as a build: what runs after it is not faster for that.
    #[test]
    fn a_load_that_ends_keeps_nothing_that_is_slower() {
        for end in 0..400 {
            let run = Cell::new(0);
            let slowed = || {
                run.set(run.get() + 1);
                if run.get() <= end { 3.0 } else { 1.0 }
            };
            assert_eq!(races(&[10.0, 10.5, 12.0, 15.0, 29.0], 10, &slowed, &|| true).winner, None, "{end}");
        }
    }

    #[test]
    fn some_noise_does_not_hide_a_faster_one() {
        let run = Cell::new(0_u32);
        let slowed = || {
            run.set(run.get() + 1);
            if run.get().is_multiple_of(5) { 3.0 } else { 1.0 }
        };
        assert_eq!(races(&[11.0, 8.0], 20, &slowed, &|| true).winner, Some(1));
    }

    #[test]
    fn without_time_no_race_begins_and_the_last_one_is_run() {
        let runs = Cell::new(0);
        let counted = || {
            runs.set(runs.get() + 1);
            1.0
        };
        // The first run of the default, ten rounds, and the first of the second race.
        let races = races(&[9.0, 8.0, 7.0], 10, &counted, &|| runs.get() < 22);
        let rounds: Vec<_> = races.all.iter().map(|race| race.rounds.len()).collect();
        assert_eq!((rounds, races.winner), (vec![10, 5, 0], Some(1)));
        assert_eq!(races.all[2].ratio(), None);
    }
}
