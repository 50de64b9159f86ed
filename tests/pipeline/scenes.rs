//! The shipped scenes in `data/` have exact ground truth for both views, and equal the renderer's output.

use std::path::{Path, PathBuf};

use hsad::{dense, eval::scene::SceneFiles, image::Plane, io::Picture};

use crate::renderer;

const SCENES: [&str; 3] = ["planes", "curved", "weak"];
const FILES: [&str; 7] =
    ["left.png", "right.png", "disp_left.pfm", "disp_right.pfm", "nonocc.png", "nonocc_right.png", "meta.json"];

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data")
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| {
        panic!("{}: {error}; render it by: cargo run --example render_scenes -- data", path.display())
    })
}

/// One view of a scene with its ground truth.
struct View {
    width: i64,
    height: i64,
    colour: Picture,
    disparity: Plane<f32>,
    visible: Plane<u8>,
    /// Sign of the step to a pixel's counterpart: -1 in the left view, whose counterparts lie to the left, else 1.
    direction: f64,
}

impl View {
    /// The left and the right view of a scene.
    fn both(scene: &str) -> [Self; 2] {
        let files = SceneFiles::find(&data().join(scene)).unwrap().remove(0);
        [(dense::View::Left, -1.0), (dense::View::Right, 1.0)].map(|(reference, direction)| {
            let scene = files.read(reference).unwrap();
            let colour = scene.reference_view().clone();
            let (width, height) = (colour.width().into(), colour.height().into());
            Self { width, height, colour, disparity: scene.truth, visible: scene.non_occluded.unwrap(), direction }
        })
    }

    fn disparity(&self, x: i64, y: i64) -> f64 {
        f64::from(self.disparity.get(x as u32, y as u32))
    }

    /// All pixels: (x, y, disparity, whether the other camera sees it).
    fn pixels(&self) -> impl Iterator<Item = (i64, i64, f64, bool)> {
        (0..self.width * self.height).map(|i| {
            let (x, y) = (i % self.width, i / self.width);
            (x, y, self.disparity(x, y), self.visible.get(x as u32, y as u32) == 255)
        })
    }
}

/// The mean difference of a view's visible pixels (0 to 255, over the colours) from the other view, warped by
/// `disparity + shift`; `light` maps grey levels of `other` to those of `view`.
fn warp_error(view: &View, other: &View, shift: f64, light: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (x, y, disparity, visible) in view.pixels() {
        let there = x as f64 + view.direction * (disparity + shift);
        if !visible || there < 0.0 || there > (view.width - 1) as f64 {
            continue;
        }
        let (from, part) = (there.floor(), there - there.floor());
        let next = (from as i64 + 1).min(view.width - 1);
        for channel in 0..3 {
            let level = |x: i64| light(f64::from(other.colour.rgb(x as u32, y as u32)[channel]));
            let warped = level(from as i64) * (1.0 - part) + level(next) * part;
            sum += (f64::from(view.colour.rgb(x as u32, y as u32)[channel]) - warped).abs();
            count += 1;
        }
    }
    sum / f64::from(count)
}

#[test]
fn each_scene_is_complete_and_says_its_range() {
    for scene in SCENES {
        for file in FILES {
            bytes(&data().join(scene).join(file));
        }
        let meta: serde_json::Value = serde_json::from_slice(&bytes(&data().join(scene).join("meta.json"))).unwrap();
        let number = |key: &str| meta[key].as_f64().unwrap_or_else(|| panic!("{scene}: no {key}"));
        assert_eq!(meta["scene"], scene);
        assert_eq!(meta["licence"], "CC0-1.0");
        assert!(number("focal_px") > 0.0 && number("baseline_mm") > 0.0 && number("doffs_px") >= 0.0);
        let [left, right] = View::both(scene);
        for view in [&left, &right] {
            assert_eq!((number("width"), number("height")), (view.width as f64, view.height as f64));
            assert!(view.visible.data().iter().all(|&value| value == 0 || value == 255), "{scene}: a mask is 0 or 255");
            assert!(
                view.disparity.data().iter().all(|disparity| (5.0..62.0).contains(disparity)),
                "{scene}: all is known"
            );
        }
        let least = left.disparity.data().iter().copied().fold(f32::INFINITY, f32::min);
        let most = left.disparity.data().iter().copied().fold(0.0, f32::max);
        assert!((number("min_disparity") - f64::from(least)).abs() < 1e-3, "{scene}");
        assert!((number("max_disparity") - f64::from(most)).abs() < 1e-3, "{scene}");
        assert!(most - least > 35.0, "{scene}: the range is too narrow to test a search");
    }
}

#[test]
fn all_of_it_takes_less_than_three_megabytes() {
    let size = |path: PathBuf| path.metadata().map_or(0, |file| file.len());
    let total: u64 = SCENES.iter().flat_map(|scene| FILES.map(|file| size(data().join(scene).join(file)))).sum();
    assert!((1_000_000..3_000_000).contains(&total), "{total} bytes");
}

/// The desk of `planes` is the plane y = 0, 330 mm below the camera, which looks along (35, -238, -850), a vector of
/// length 883.385: the ray through row y falls by 238 / 883.385 + (y - 127) / 378 * 0.963023 mm per mm of depth. On
/// the last row that is 0.269418 + 0.323556 = 0.592974, the depth 556.517 mm, and 378 * 100 / 556.517 - 14 = 53.922.
#[test]
fn the_desk_lies_where_its_plane_puts_it() {
    for view in View::both("planes") {
        for x in [300, 339] {
            assert!((view.disparity(x, 254) - 53.922).abs() < 1e-3, "{}", view.disparity(x, 254));
        }
    }
}

/// Half of the pixels next to an edge see two surfaces at once, so the mean error stays above 0; the test is that no
/// other disparity explains the pictures as well, not even one a quarter of a pixel away.
#[test]
fn the_truth_warps_each_view_onto_the_other() {
    for (scene, limit) in [("planes", 3.0), ("curved", 4.1)] {
        let [left, right] = View::both(scene);
        for (view, other) in [(&left, &right), (&right, &left)] {
            let error = |shift| warp_error(view, other, shift, |level| level);
            let exact = error(0.0);
            assert!(exact < limit, "{scene}: {exact}");
            for shift in [-0.25, 0.25] {
                assert!(error(shift) > 1.2 * exact, "{scene}: {} at {shift} and {exact} at the truth", error(shift));
            }
            assert!(error(1.0) > 2.5 * exact && error(-1.0) > 2.5 * exact, "{scene}");
        }
    }
}

/// `weak`: the right camera's grey level is 255 * 0.86 * (level / 255)^(17/16) + 9, plus noise.
#[test]
fn the_weak_scene_changes_its_brightness_and_nothing_else() {
    let [left, right] = View::both("weak");
    let unchanged = warp_error(&left, &right, 0.0, |level| level);
    assert!(unchanged > 12.0, "{unchanged}");
    let restored = warp_error(&left, &right, 0.0, |level| 255.0 * ((level - 9.0) / (0.86 * 255.0)).powf(16.0 / 17.0));
    assert!(restored < 2.0, "{restored}");
}

/// The disparity of `other` at a counterpart lies between those of the two pixels around it. If these see one surface,
/// interpolation is exact on a plane, because disparity is linear in the picture there, and good to the curvature
/// elsewhere; only creases and the rims of thin objects are worse. (The nearest pixel alone would be off by up to half
/// the slope.) An occluded counterpart has a nearer surface in front of it.
#[test]
fn both_truths_agree_where_visible_and_contradict_each_other_where_not() {
    for (scene, typical, limit) in [("planes", 1e-4, 0.01), ("curved", 5e-3, 0.05), ("weak", 2e-3, 0.05)] {
        let [left, right] = View::both(scene);
        for (view, other) in [(&left, &right), (&right, &left)] {
            let (mut differences, mut torn, mut hidden, mut covered, mut outside) = (Vec::new(), 0, 0, 0, 0);
            for (x, y, disparity, visible) in view.pixels() {
                let there = x as f64 + view.direction * disparity;
                // Single precision moves a counterpart by far less than this.
                if there < 1e-3 || there > (view.width - 1) as f64 - 1e-3 {
                    outside += 1;
                    assert!(!visible || there > -1e-3 && there < (view.width - 1) as f64 + 1e-3, "{scene}: {x},{y}");
                    continue;
                }
                let from = there.floor();
                let (a, b) = (other.disparity(from as i64, y), other.disparity(from as i64 + 1, y));
                if !visible {
                    hidden += 1;
                    covered += u32::from(a.max(b) > disparity + 0.5);
                } else if (a - b).abs() < 1.0 {
                    differences.push((a + (b - a) * (there - from) - disparity).abs());
                } else {
                    torn += 1;
                }
            }
            differences.sort_by(f64::total_cmp);
            let quantile = |share: f64| differences[(differences.len() as f64 * share) as usize];
            assert!(quantile(0.9) < typical, "{scene}: {}", quantile(0.9));
            assert!(quantile(0.99) < limit, "{scene}: {}", quantile(0.99));
            assert!(torn < differences.len() / 20, "{scene}: {torn}");
            assert!(hidden > 1000 && outside > 1000, "{scene}: {hidden} and {outside} pixels");
            assert!(f64::from(covered) > 0.98 * f64::from(hidden), "{scene}: {covered} of {hidden}");
        }
    }
}

/// `curved` is left out: it takes three times as long as the other two together and runs the same code.
#[test]
fn the_renderer_makes_the_committed_files() {
    let folder = tempfile::tempdir().unwrap();
    for scene in renderer::scenes().iter().filter(|scene| ["planes", "weak"].contains(&scene.name)) {
        let pair = renderer::render(scene);
        renderer::write(scene, &pair, folder.path()).unwrap();
        for file in FILES {
            let (made, committed) = (bytes(&folder.path().join(file)), bytes(&data().join(scene.name).join(file)));
            // Another version of the encoder may pack the same picture differently.
            let same = if file.ends_with(".png") {
                image::load_from_memory(&made).unwrap() == image::load_from_memory(&committed).unwrap()
            } else {
                made == committed
            };
            assert!(same, "{}/{file}: run cargo run --example render_scenes -- data", scene.name);
        }
    }
    assert_eq!(renderer::scenes().iter().map(|scene| scene.name).collect::<Vec<_>>(), SCENES);
}
