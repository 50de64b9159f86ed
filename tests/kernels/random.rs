//! Random kernels, at random sizes, with inputs drawn from a random seed.
//!
//! `PROPTEST_CASES=2000 cargo test --test kernels anything` takes half an hour on a software driver.

use hsad::{
    gpu::DeviceChoice,
    verify::{Case, Subject, subjects},
};
use proptest::{
    prelude::*,
    test_runner::{Config, TestRunner},
};

use crate::common::bench;

/// Sides, short more often than long.
fn side() -> impl Strategy<Value = u32> {
    prop_oneof![1..9_u32, 1..80_u32, 60..260_u32]
}

#[test]
fn anything_equals_the_twin() {
    let cases = std::env::var("PROPTEST_CASES").map_or(24, |cases| cases.parse().expect("a number of cases"));
    let all: Vec<&'static Subject> = subjects().collect();
    let strategy = (proptest::sample::select(all), (side(), side()), any::<u32>());
    // A failure is recorded by the command that repeats it.
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 30, ..Config::default() };
    let checked = TestRunner::new(config).run(&strategy, |(subject, size, seed)| {
        let case = Case::new(subject.name, size, seed).expect("a case that exists");
        let outcome = case.run(&bench());
        prop_assert!(outcome.passes(), "{}: {:?}", case.command(&DeviceChoice::Best), outcome.faults);
        Ok(())
    });
    if let Err(error) = checked {
        panic!("{error}");
    }
}
