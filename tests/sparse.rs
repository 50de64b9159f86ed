//! Points of one view found in another that is turned, blurred, noisy or hidden in part, on a real pair with truth.
#![cfg(feature = "cli")]

use std::path::Path;

use hsad::{
    eval::{
        Judged, PointMatch, Truth,
        conditions::{Changed, Condition},
        curves::accuracy_of_first,
    },
    gpu::DeviceChoice,
    io::{load, pfm},
    pair::Backend,
    sparse::{SparseConfig, match_views},
};

/// 97 % of the 100 most confident, the accuracy that the paper claims.
#[test]
fn the_hundred_most_confident_are_right_whatever_happened_to_the_second_view() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data/stereo/Art"));
    if !folder.is_dir() {
        eprintln!("skipped: {} is absent", folder.display());
        return;
    }
    let picture = |name: &str| load::load(&folder.join(name)).unwrap();
    let (left, right) = (picture("left.png").luma(), picture("right.png"));
    let known = Truth::stereo(pfm::read(&folder.join("disp_left.pfm")).unwrap(), Some(&picture("nonocc.png").luma()));
    let backend = Backend::open(&DeviceChoice::Best).or_else(|_| Backend::open(&DeviceChoice::Cpu)).unwrap();
    for condition in ["gain=0.6", "rotation=45", "scale=0.8", "blur=2", "noise=10", "occlusion=0.3"] {
        let changed = Changed::by(&[condition.parse::<Condition>().unwrap()], &right, 1);
        let truth = known.as_ref().unwrap().clone().changed(&changed);
        let found = match_views(&backend, &left, &changed.picture.luma(), &SparseConfig::default()).unwrap();
        let matches: Vec<PointMatch> = found.matches.iter().map(PointMatch::from).collect();
        let right = Judged::new(&matches, &truth, 1.5).unwrap().right;
        let accuracy = accuracy_of_first(&right, 100);
        assert!(right.len() >= 100 && accuracy >= 0.97, "{condition}: {accuracy} of {}", right.len());
    }
}
