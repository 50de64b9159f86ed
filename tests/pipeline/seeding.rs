//! Seeding: range, rectification, brightness relation and trust, on rendered pairs, and on real ones if present.

#[path = "../texture/mod.rs"]
mod texture;

use std::path::Path;

use hsad::{
    Error,
    disparity::DisparityRange,
    features::{Feature, FeatureConfig},
    image::{Luma, Plane},
    internals::cpu::features::detector::detect,
    io::{load, pfm},
    seeding::{RangeEnd, Seeding, SeedingConfig, Verdict},
};
use texture::texture;

use crate::real;

/// A pair that shows a wall at disparity `far` with a square in front of it at `near`; the right view's grey values are
/// mapped by `grey`, and its content lies `lower` px lower.
fn pair(far: f32, near: f32, lower: f32, grey: impl Fn(f32) -> f32) -> (Luma, Luma) {
    let (width, height) = (320, 240);
    let view = |eye: f32, lower: f32, grey: &dyn Fn(f32) -> f32| {
        Plane::from_fn((width, height), |x, y| {
            let (x, y) = (x as f32, y as f32 - lower);
            let square = x + eye * near;
            let front = (110.0..210.0).contains(&square) && (70.0..170.0).contains(&y);
            let value = if front { texture(square + 700.0, y) } else { texture(x + eye * far, y) };
            grey(value).round() as u8
        })
    };
    (view(0.0, 0.0, &|value| value), view(1.0, lower, &grey))
}

fn find((left, right): &(Luma, Luma)) -> Seeding {
    let features = |view: &Luma| -> Vec<Feature> { detect(view, &FeatureConfig::default()).unwrap().features };
    Seeding::find((left, right), (&features(left), &features(right)), &SeedingConfig::default()).unwrap()
}

#[test]
fn rendered_pair_is_described_completely() {
    let views = pair(8.0, 30.0, 0.0, |value| 0.8 * value + 12.0);
    let found = find(&views);
    let range = found.range.unwrap().range;
    assert!(range.contains(8) && range.contains(30) && range.min >= -2 && range.last() <= 48, "{range:?}");
    assert!(found.rectification.is_rectified(), "{}", found.rectification);
    let brightness = found.brightness.unwrap();
    assert!((brightness.gain - 0.8).abs() < 0.03 && (brightness.offset - 12.0).abs() < 4.0, "{brightness:?}");
    assert!(found.agreement > 0.6, "{}", found.agreement);
    let right =
        |seed: &&hsad::matching::Seed| (seed.disparity - 8.0).abs() < 0.5 || (seed.disparity - 30.0).abs() < 0.5;
    assert!(found.seeds.iter().filter(right).count() * 10 >= found.seeds.len() * 9);

    assert_eq!(find(&views), found, "the same pictures give the same figures");
}

#[test]
fn negative_disparities_are_found() {
    let range = find(&pair(-25.0, -5.0, 0.0, |value| value)).range.unwrap().range;
    assert!(range.contains(-25) && range.contains(-5) && range.last() < 15, "{range:?}");
}

/// A wall out of focus bears no features: the coarse map sees it.
#[test]
fn a_blurred_wall_lies_in_the_range() {
    let (left, right) = pair(8.0, 30.0, 0.0, |value| value);
    let wall = |view: &Luma, from: u32| {
        Luma::from_fn(view.size(), |x, y| {
            if (from..from + 100).contains(&x) && (70..170).contains(&y) {
                return view.get(x, y);
            }
            // A blur that leaves 2 to 3 grey levels of the texture's finest scale.
            let sum: u32 = (-8..=8).map(|i| u32::from(view.get_clamped(i64::from(x), i64::from(y) + i))).sum();
            ((sum / 17 + 3 * 120) / 4) as u8
        })
    };
    let views = (wall(&left, 110), wall(&right, 80));
    let found = find(&views);
    let on_wall = |seed: &&hsad::matching::Seed| seed.disparity < 15.0;
    assert!(found.seeds.iter().filter(on_wall).count() * 20 < found.seeds.len(), "the wall bears features");
    let range = found.range.unwrap();
    assert!(range.range.contains(8) && range.range.contains(30), "{range:?}");
    assert_eq!(range.ends[0], RangeEnd::CoarseMap);
}

#[test]
fn rows_that_a_small_warp_mends_are_matched_by_their_model() {
    for lower in [1.0, 3.0, -12.0] {
        let found = find(&pair(8.0, 30.0, lower, |value| value));
        assert_eq!(found.rectification.verdict, Verdict::Alignable, "{}", found.rectification);
        let right_row = found.rectification.rows.right_row(50.0, 100.0);
        assert!((right_row - 100.0 - f64::from(lower)).abs() < 0.1, "{right_row}");
        assert!(found.agreement > 0.6, "{}", found.agreement);
        let range = found.range.unwrap().range;
        assert!(range.contains(8) && range.contains(30) && range.min >= -2 && range.last() <= 48, "{range:?}");
    }
}

#[test]
fn far_rows_are_told_and_not_trusted() {
    let found = find(&pair(8.0, 30.0, 40.0, |value| value));
    assert_eq!(found.rectification.verdict, Verdict::NotRectified);
    assert!((found.rectification.offset - 40.0).abs() < 0.3, "{}", found.rectification);
    assert!(found.agreement < 0.2, "{}", found.agreement);
}

#[test]
fn a_pair_turned_by_90_degrees_has_its_cameras_above_each_other() {
    let (left, right) = pair(8.0, 30.0, 0.0, |value| value);
    let transposed = |view: &Luma| Plane::from_fn((240, 320), |x, y| view.get(y, x));
    let found = find(&(transposed(&left), transposed(&right)));
    assert_eq!(found.rectification.verdict, Verdict::Vertical, "{}", found.rectification);
}

#[test]
fn pictures_that_show_nothing_give_reasons_not_ranges() {
    let found = find(&(Luma::filled((100, 80), 128), Luma::filled((100, 80), 128)));
    assert_eq!(found.rectification.verdict, Verdict::Unknown);
    assert_eq!((found.brightness, found.agreement), (None, 0.0));
    let error = Error::from(found.range.unwrap_err());
    assert!(matches!(error, Error::NoRange { .. }) && error.to_string().contains("0 points"), "{error}");
}

#[test]
fn unrelated_pictures_are_not_trusted() {
    let (left, _) = pair(8.0, 30.0, 0.0, |value| value);
    let other = Plane::from_fn((320, 240), |x, y| texture(y as f32 + 5000.0, x as f32 + 3000.0).round() as u8);
    let found = find(&(left, other));
    assert!(found.agreement < 0.1 && !found.rectification.is_rectified(), "{found:?}");
}

#[test]
fn sizes_are_checked() {
    let (small, large) = (Luma::filled((4, 4), 0), Luma::filled((5, 4), 0));
    let none: (&[Feature], &[Feature]) = (&[], &[]);
    let config = SeedingConfig::default();
    assert!(matches!(Seeding::find((&small, &large), none, &config), Err(Error::SizesDiffer { .. })));
    let found = Seeding::find((&small, &small), none, &config).unwrap();
    assert_eq!(found.rectification.verdict, Verdict::Unknown);
}

/// On real scenes the range found covers nearly all of the ground truth, and rows correspond.
#[test]
fn real_scenes_lie_in_the_range_found_for_them() {
    let Some(folder) = real("stereo") else { return };
    for scene in ["Art", "Cones", "Teddy", "Books", "Motorcycle_Q", "Adirondack_Q", "Adirondack_Q_exposure"] {
        let views = (luma(&folder.join(scene).join("left.png")), luma(&folder.join(scene).join("right.png")));
        let found = find(&views);
        let (range, known) = (found.range.unwrap().range, truth(&folder.join(scene).join("disp_left.pfm")));
        let share = known.iter().filter(|&&d| range.contains(d.round() as i32)).count() as f64 / known.len() as f64;
        assert!(share >= 0.997, "{scene}: {share} in {range:?}");
        let (low, high) = known.iter().fold((f32::MAX, f32::MIN), |(low, high), &d| (low.min(d), high.max(d)));
        let width = DisparityRange::inclusive(low.floor() as i32, high.ceil() as i32).unwrap().count;
        assert!(range.count as f32 <= 1.6 * width as f32, "{scene}: {range:?} for {low} to {high}");
        // The rows of some of these pairs are off by a third of a pixel.
        let rows = &found.rectification;
        assert!(rows.is_alignable() && rows.largest < 0.5 && rows.unexplained == 0.0, "{scene}: {rows}");
    }
}

fn luma(path: &Path) -> Luma {
    load::load(path).unwrap().luma()
}

/// The known disparities of a file.
fn truth(path: &Path) -> Vec<f32> {
    pfm::read(path).unwrap().into_data().into_iter().filter(|value| value.is_finite()).collect()
}
