//! The regression suite itself, without a device: it covers every kernel, its inputs are reproducible, its hashes hold.
#![cfg(feature = "verify")]

use std::collections::BTreeSet;

use hsad::{
    disparity::SCALE,
    verify::{Case, Extent, Values, cases, goldens, subjects},
};

#[test]
fn every_kernel_is_a_subject() {
    let names: BTreeSet<_> = subjects().map(|subject| subject.name).collect();
    assert_eq!(names.len(), subjects().count(), "names are unique");
    let kernels: BTreeSet<_> = subjects().filter(|subject| !subject.is_pipeline).map(|subject| subject.name).collect();
    let stages: BTreeSet<_> = hsad::stages().iter().map(|stage| stage.name).collect();
    assert_eq!(kernels, stages);
}

#[test]
fn a_case_is_the_same_each_time() {
    for case in cases(Extent::Quick) {
        let [first, second] = [0; 2].map(|_| case.trial());
        assert_eq!(first.parameters(), second.parameters());
        assert_eq!(first.input(), second.input());
        let other = Case::new(case.subject.name, case.size, case.seed + 1).unwrap().trial();
        assert!((first.parameters(), first.input()) != (other.parameters(), other.input()), "{case:?}");
    }
}

/// A map of a few flat pieces would hide what is wrong with penalties, checks and filters.
#[test]
fn pipelines_have_something_to_decide() {
    let dense = ["fast", "balanced", "quality", "paper"];
    for case in cases(Extent::Quick).into_iter().filter(|case| dense.contains(&case.subject.name)) {
        let twin = case.trial().twin().unwrap();
        let Values::I32(map) = &twin[0].values else { panic!("the first array is the map") };
        let distinct: BTreeSet<_> = map.iter().map(|disparity| disparity.div_euclid(SCALE)).collect();
        assert!(distinct.len() > 12, "{case:?}: {} whole disparities", distinct.len());
    }
}

/// Where this fails and the twins are meant to have changed, `cargo run --example goldens` makes the hashes anew.
#[test]
fn the_twins_leave_what_is_stored() {
    let (stored, current) = (goldens::text(), goldens::current().unwrap());
    for (stored, current) in stored.lines().zip(current.lines()) {
        assert_eq!(stored, current);
    }
    assert_eq!(stored.lines().count(), current.lines().count());
    // Orientations come with the exact rest of the keypoint; descriptors are nothing but floats.
    let without = |name: &str| !stored.lines().any(|line| line.starts_with(&format!("{name} ")));
    let without: Vec<_> = subjects().map(|subject| subject.name).filter(|name| without(name)).collect();
    assert_eq!(without, ["descriptor"]);
}

#[test]
fn what_does_not_exist_is_refused() {
    let refused = |name, size| Case::new(name, size, 1).unwrap_err().to_string();
    let unknown = refused("nonsense", (9, 9));
    assert!(
        unknown.starts_with("only is 'nonsense', but there are luma, ") && unknown.contains("block_match"),
        "{unknown}"
    );
    for size in [(0, 9), (9, 0), (4097, 1)] {
        assert!(refused("pad", size).contains("1 to 4096 px"));
    }
}
