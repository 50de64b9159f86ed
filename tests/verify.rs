//! The verification suite itself, without a device: it covers every kernel, its inputs are reproducible, its hashes
//! match.
#![cfg(feature = "verify")]

use std::collections::BTreeSet;

use hsad::{
    disparity::SCALE,
    gpu::DeviceChoice,
    verify::{Array, Case, Comparison, Extent, Tolerance, Values, cases, goldens, subjects},
};

#[test]
fn every_kernel_is_a_subject() {
    let names: BTreeSet<_> = subjects().map(|subject| subject.name).collect();
    assert_eq!(names.len(), subjects().count(), "names are unique");
    let kernels: BTreeSet<_> = subjects().filter(|subject| !subject.is_pipeline).map(|subject| subject.name).collect();
    let stages: BTreeSet<_> = hsad::internals::stages().iter().map(|stage| stage.name).collect();
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

/// A map of a few flat pieces would hide errors of penalties, checks and filters.
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

/// If this fails after an intended change of the twins, `cargo run --example goldens` computes the hashes again.
#[test]
fn the_twins_leave_what_is_stored() {
    let (stored, current) = (goldens::text(), goldens::current().unwrap());
    for (stored, current) in stored.lines().zip(current.lines()) {
        assert_eq!(stored, current);
    }
    assert_eq!(stored.lines().count(), current.lines().count());
    // Orientations are stored with the exact members of the keypoint; descriptors have floats only.
    let without = |name: &str| !stored.lines().any(|line| line.starts_with(&format!("{name} ")));
    let without: Vec<_> = subjects().map(|subject| subject.name).filter(|name| without(name)).collect();
    assert_eq!(without, ["descriptor"]);
}

/// Wrong values for the group at value `at` of `good`, an array with tolerances.
fn garbage(good: &Array, at: usize) -> Vec<Vec<f32>> {
    let (Values::F32(values), Tolerance::Within { angles, group, length, outliers, .. }) =
        (&good.values, good.tolerance)
    else {
        panic!("{} are floats with a tolerance", good.name)
    };
    let thing = &values[at..at + group];
    let first_is = |value: f32| [&[value], &thing[1..]].concat();
    let mut garbage = [f32::NAN, f32::INFINITY, -f32::INFINITY, 1e30, -1e30].map(first_is).to_vec();
    if angles {
        garbage.extend([-0.1, 6.3].map(first_is));
    }
    if length.is_some() && thing.iter().any(|&value| value != 0.0) {
        let times = |factor: f32| thing.iter().map(|value| factor * value).collect();
        garbage.extend([0.0, 0.98, 2.0].map(times));
        // The right length, but another vector: valid only where an orientation can be another one.
        if outliers.is_none_or(|outliers| outliers.difference < 0.1) {
            garbage.extend([times(-1.0), [&thing[5..], &thing[..5]].concat()]);
        }
    }
    garbage
}

/// Accepted outliers leave no room for an inexplicable group, wherever it is and however few there are.
#[test]
fn garbage_in_one_thing_is_noticed() {
    let inexact = ["nonmax", "orientation", "descriptor", "features"];
    let (mut without_outliers, mut with_outliers) = (0, 0);
    for case in [Extent::Full, Extent::Quick].into_iter().flat_map(cases) {
        if !inexact.contains(&case.subject.name) {
            continue;
        }
        for good in case.trial().twin().unwrap() {
            let Tolerance::Within { group, outliers, .. } = good.tolerance else { continue };
            if good.values.is_empty() {
                continue;
            }
            let noticed = |at: usize, thing: &[f32]| {
                let mut bad = good.clone();
                let Values::F32(values) = &mut bad.values else { unreachable!("what has a tolerance is a float") };
                values[at..at + group].copy_from_slice(thing);
                Comparison::new(&bad, &good).fault.is_some()
            };
            let last = good.values.len() - group;
            for (at, thing) in
                [0, last].into_iter().flat_map(|at| garbage(&good, at).into_iter().map(move |thing| (at, thing)))
            {
                assert!(noticed(at, &thing), "{case:?}, {} from {at} on: {thing:?}", good.name);
            }
            // Slightly off: accepted only if outliers are, and among enough groups.
            let Values::F32(values) = &good.values else { unreachable!("what has a tolerance is a float") };
            let mut thing = values[..group].to_vec();
            thing[0] += 0.04;
            let many = good.values.len() >= 200 * group;
            if outliers.is_some() && many {
                with_outliers += 1;
            } else {
                without_outliers += 1;
                assert!(noticed(0, &thing), "{case:?}, {}: {thing:?}", good.name);
            }
        }
    }
    // Arrays of both kinds occur.
    assert!(without_outliers > 20 && with_outliers > 2, "{without_outliers} {with_outliers}");
}

/// A shell passes the device's name on unchanged, whatever its characters.
#[test]
fn the_command_names_the_device() {
    let case = Case::new("pad", (17, 13), 5).unwrap();
    let command = |device: &str| case.command(&device.parse().unwrap());
    let alone = "hsad verify --only pad --size 17x13 --seed 5";
    assert_eq!(command("best"), alone);
    assert_eq!(command("1"), format!("{alone} --device '1'"));
    assert_eq!(command("Tom's $GPU"), format!(r"{alone} --device 'Tom'\''s $GPU'"));
    assert_eq!(case.command(&DeviceChoice::Named("a b".into())), format!("{alone} --device 'a b'"));
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
