//! The pipeline from two pictures to a map: behaviour beyond that of its steps.

use std::{
    cell::RefCell,
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::Duration,
};

use hsad::{
    Backend,
    config::{Config, Method, Preset},
    dense::{Aggregation, Search, View},
    disparity::{DisparityRange, NONE},
    gpu::DeviceChoice,
    image::Size,
    io::{Picture, load, pfm},
    pipeline::{self, Activity, Precedent, RangeSource, Step, Task, Way},
    tiles::Tiling,
    wgpu,
};

fn scene(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(name)
}

/// Enlarges a picture: each pixel becomes a block of `factor` x `factor`.
/// The picture enlarged with linear interpolation: pixels that are only repeated are found and not trusted.
fn enlarged(picture: &Picture, factor: u32) -> Picture {
    let Size { width, height } = picture.size();
    Picture::from_fn((factor * width, factor * height), |x, y| {
        let (left, top) = (x / factor, y / factor);
        let (right, bottom) = ((left + 1).min(width - 1), (top + 1).min(height - 1));
        let mixed = |a: u32, b: u32, part: u32| (a * (factor - part) + b * part) / factor;
        std::array::from_fn(|channel| {
            let at = |x, y| u32::from(picture.get(x, y)[channel]);
            let row = |y| mixed(at(left, y), at(right, y), x % factor);
            mixed(row(top), row(bottom), y % factor) as u8
        })
    })
}

/// Where each view is the whole picture, tiles must give its map to the bit; else nearly so, over levels of a pyramid, too.
#[test]
fn tiles_give_the_map_of_the_whole_picture() {
    let folder = scene("curved");
    let [left, mut right] = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap());
    // Brightness and a mask are those of the whole pair.
    for [red, green, blue, _] in right.data_mut() {
        for value in [red, green, blue] {
            *value = (u32::from(*value) * 7 / 8) as u8;
        }
    }
    (100..130).for_each(|y| (60..340).for_each(|x| right.set(x, y, [0; 4])));
    let backend = Backend::open(&DeviceChoice::Best).expect("this test needs a device; lavapipe is one");
    let run = |config: &Config| pipeline::run(&backend, (&left, &right), config, |_| ()).unwrap();
    for (preset, search, reference) in [
        (Preset::Fast, None, View::Left),
        (Preset::Balanced, None, View::Right),
        (Preset::Balanced, Some(Search::Levels(3)), View::Left),
    ] {
        let mut config = Config { reference, ..preset.config() };
        if let (Method::Hsad(parameters), Some(search)) = (&mut config.method, search) {
            let Aggregation::Costs(costs) = &mut parameters.aggregation else { unreachable!() };
            costs.search = search;
        }
        let whole = run(&config);
        assert_ne!(whole.brightness.gain, 256);
        let [widest, narrow] = [400, 64].map(|margin| {
            let tiled = run(&Config { tiles: Some(Tiling { side: 256, margin }), ..config.clone() });
            assert_eq!(tiled.range, whole.range);
            tiled.dense
        });
        assert_eq!(widest, whole.dense, "{preset} {search:?}");
        let (found, expected) = (narrow.disparity.data(), whole.dense.disparity.data());
        let differ = found.iter().zip(expected).filter(|&(&a, &b)| a.abs_diff(b) > 128).count();
        // Windows end, and paths do not.
        let most = if preset == Preset::Fast { 0 } else { found.len() / 100 };
        assert!(differ <= most, "{preset} {search:?}: {differ}");
    }
}

/// The async functions also work natively, with the device polled by the caller.
#[test]
fn the_whole_pipeline_can_be_awaited() {
    fn sent<F: Future + Send>(future: F) -> F {
        future
    }
    let folder = scene("weak");
    let [left, right] = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap());
    let backend = Backend::open(&DeviceChoice::Best).expect("this test needs a device; lavapipe is one");
    let Backend::Gpu(gpu) = &backend else { unreachable!("the best is a device") };
    let config = Preset::Fast.config();
    let done = AtomicBool::new(false);
    let awaited = thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                gpu.device.poll(wgpu::PollType::Poll).unwrap();
                thread::sleep(Duration::from_millis(1));
            }
        });
        let awaited = pollster::block_on(sent(pipeline::run_async(&backend, (&left, &right), &config, |_| ())));
        done.store(true, Ordering::Relaxed);
        awaited.unwrap()
    });
    let waited_for = pipeline::run(&backend, (&left, &right), &config, |_| ()).unwrap();
    assert_eq!(awaited.dense, waited_for.dense);
    assert_eq!(awaited.range, waited_for.range);
}

/// Features of large pictures are detected in reduced ones; results must be in pixels of the large ones.
#[test]
fn a_large_pair_is_seen_at_its_own_size() {
    let folder = scene("planes");
    let [left, right] = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap());
    let factor = 6;
    let views = (&enlarged(&left, factor), &enlarged(&right, factor));
    assert!(views.0.data().len() > 1 << 21, "not large enough to be reduced");
    let backend = Backend::open(&DeviceChoice::Best).expect("this test needs a device; lavapipe is one");
    let outcome = pipeline::run(&backend, views, &Preset::Fast.config(), |_| ()).unwrap();

    assert!(matches!(outcome.range_source, RangeSource::Found(_)), "{:?}", outcome.range_source);
    let truth = pfm::read(&folder.join("disp_left.pfm")).unwrap();
    let known = truth.data().iter().filter(|d| d.is_finite()).map(|&d| (d * factor as f32).round() as i32);
    let (inside, outside): (Vec<i32>, Vec<i32>) = known.partition(|&d| outcome.range.contains(d));
    assert!(outside.len() * 100 < inside.len(), "{} of the truth outside of {:?}", outside.len(), outcome.range);
    assert!(outcome.seeding.rectification.is_alignable());
    assert!(outcome.trust > 0.5, "{}", outcome.trust);
    let Size { width, height } = views.0.size();
    let far = outcome.features[0].iter().filter(|f| f.x > width as f32 / 2.0 && f.x < width as f32).count();
    assert!(far > outcome.features[0].len() / 4, "points are not where the picture is");
    assert!(outcome.features[0].iter().all(|f| f.y < height as f32));
}

#[test]
fn the_paper_searches_from_the_right_view_to_the_right_only() {
    let folder = scene("curved");
    let [left, right] = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap());
    let config = Preset::Paper.config();
    assert_eq!(config.reference, View::Right);
    let outcome = pipeline::run(&Backend::Cpu, (&left, &right), &config, |_| ()).unwrap();
    assert!(outcome.range.min >= 0);
    let truth = pfm::read(&folder.join("disp_right.pfm")).unwrap();
    let score = hsad::eval::score(&outcome.dense.disparity, &truth, None, &[1.0]).unwrap();
    // There is no consistency check: only pixels without a partner in the left view have no disparity.
    let Size { width, height } = right.size();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let has_partner = i64::from(x) + i64::from(outcome.range.min) < i64::from(width);
        assert_eq!(outcome.dense.disparity.get(x, y) != NONE, has_partner, "({x}, {y})");
    }
    assert!(score.bad[0].of_known < 0.6, "{score:?}");
}

/// A right view that lies a row lower is matched as well as one that does not, and only with alignment.
#[test]
fn rows_that_are_off_are_aligned() {
    let folder = scene("planes");
    let [left, right] = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap());
    let truth = pfm::read(&folder.join("disp_left.pfm")).unwrap();
    let lower = |rows: u32| Picture::from_fn(right.size(), |x, y| right.get(x, y.saturating_sub(rows)));
    let wrong = |right: &Picture, align: bool| {
        let config = Config { align, force: true, ..Preset::Fast.config() };
        let outcome = pipeline::run(&Backend::Cpu, (&left, right), &config, |_| ()).unwrap();
        hsad::eval::score(&outcome.dense.disparity, &truth, None, &[1.0]).unwrap().bad[0].of_known
    };
    let level = wrong(&right, true);
    for rows in [1, 3] {
        let right = lower(rows);
        let (aligned, as_is) = (wrong(&right, true), wrong(&right, false));
        // The lowest rows of the left view lie outside the right one.
        let lost = f64::from(rows) / f64::from(right.height());
        assert!(aligned < level + lost + 0.005 && as_is > level + 0.1, "{rows} rows: {level}, {aligned}, {as_is}");
    }
}

/// Pixels that do not show the scene take no part in the refinement, on a device and on the CPU.
#[test]
fn what_is_masked_is_refined_alike_on_device_and_cpu() {
    let folder = scene("weak");
    let views = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap());
    // Alpha is 0 in a disc of one view and in a wedge of the other one.
    let [left, right] = [0, 1].map(|view: usize| {
        let picture = &views[view];
        let hidden = |x: u32, y: u32| {
            if view == 0 { (x as i32 - 90).pow(2) + (y as i32 - 70).pow(2) < 900 } else { x + 2 * y < 90 }
        };
        let shown = |x, y| picture.get(x, y).map(|value| if hidden(x, y) { 0 } else { value });
        Picture::from_fn(picture.size(), shown)
    });
    let device = Backend::open(&DeviceChoice::Best).expect("this test needs a device; lavapipe is one");
    for (preset, reference) in
        [(Preset::Balanced, View::Left), (Preset::Quality, View::Right), (Preset::Fast, View::Left)]
    {
        let config = Config { reference, ..preset.config() };
        let [found, expected] =
            [&device, &Backend::Cpu].map(|backend| pipeline::run(backend, (&left, &right), &config, |_| ()).unwrap());
        assert!(found.masks.iter().all(Option::is_some));
        assert_eq!(found.dense, expected.dense, "{preset}, {reference:?}");
    }
}

/// Detectors and matchers serve the next pairs of their size and range: other views, another brightness, masks.
#[test]
fn what_is_kept_serves_the_next_pairs_and_changes_no_map() {
    let backend = Backend::open(&DeviceChoice::Best).expect("this test needs a device; lavapipe is one");
    let Backend::Gpu(gpu) = &backend else { unreachable!("the best is a device") };
    let keeping = Backend::Gpu(gpu.clone().keeping(1 << 30));
    let folder = scene("curved");
    let views = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap());
    let size = Size::new(200, 120);
    let part = |row: u32, gain: u16, border: u32| {
        views.each_ref().map(|view| {
            Picture::from_fn(size, |x, y| {
                let [r, g, b, a] = view.get(x, y + row);
                let level = |level| if y < border { 0 } else { (u16::from(level) * gain / 8) as u8 };
                [level(r), level(g), level(b), a]
            })
        })
    };
    let darker = [part(20, 8, 0)[0].clone(), part(20, 6, 0)[1].clone()];
    let config = Config { range: Some(DisparityRange::new(0, 40).unwrap()), ..Preset::Balanced.config() };
    let existing = || {
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        gpu.device.get_internal_counters().hal.buffers.read()
    };
    let mut counts = Vec::new();
    for [left, right] in [part(0, 8, 0), darker, part(10, 8, 0), part(0, 8, 16), part(30, 8, 16)] {
        let run = |backend| pipeline::run(backend, (&left, &right), &config, |_| ()).unwrap();
        let [alone, kept] = [&backend, &keeping].map(run);
        assert!(alone.dense.disparity.data().iter().any(|&disparity| disparity != NONE));
        assert_eq!(alone.dense, kept.dense);
        assert_eq!(alone.features, kept.features);
        assert_eq!(alone.brightness, kept.brightness);
        counts.push((existing(), alone.brightness, alone.masks[0].is_some()));
    }
    assert_ne!(counts[0].1, counts[1].1, "another brightness");
    assert_eq!(counts.iter().map(|count| count.2).collect::<Vec<_>>(), [false, false, false, true, true], "masks");
    let buffers: Vec<isize> = counts.iter().map(|count| count.0).collect();
    assert!(buffers[0] == buffers[1] && buffers[1] == buffers[2], "a pair of the same kind allocates: {buffers:?}");
    assert!(buffers[3] > buffers[2] && buffers[3] == buffers[4], "a pair with masks has a matcher: {buffers:?}");
    drop(keeping);
    assert!(existing() < buffers[0], "nothing is kept any more");
}

/// A precedent holds for the frames that its bounds let pass, and no others.
#[test]
fn a_frame_follows_its_precedent_as_long_as_it_holds() {
    let backend = Backend::open(&DeviceChoice::Best).expect("this test needs a device; lavapipe is one");
    let folder = scene("curved");
    let [left, right] = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap());
    let config = Preset::Fast.config();
    let matched = |views: (&Picture, &Picture), precedent: Option<&Precedent>| {
        let (backend, config, way) = (&backend, &config, &Way::AsNeeded);
        let (begin, progress) = (&|_| (), &|_| ());
        Task { backend, views, config, way, calibration: None, precedent, begin, progress }.run().unwrap()
    };
    let views = (&left, &right);
    let first = matched(views, None);
    let precedent = first.precedent(views).expect("a frame to be trusted");
    let again = matched(views, Some(&precedent));
    assert!(!first.follows && again.follows && again.precedent(views).is_none());
    assert!(!first.outcome.features[0].is_empty() && again.outcome.features[0].is_empty());
    assert_eq!(again.outcome.range, first.outcome.range);
    assert_eq!(again.outcome.brightness, first.outcome.brightness);
    assert_eq!(again.outcome.dense.disparity, first.outcome.dense.disparity);

    let Size { width, height } = left.size();
    let nearer = |shift: u32| Picture::from_fn(right.size(), |x, y| right.get((x + shift).min(width - 1), y));
    let darker = right.map(|&[r, g, b, a]| {
        let [r, g, b] = [r, g, b].map(|level| (u16::from(level) * 15 / 16) as u8);
        [r, g, b, a]
    });
    let smaller = |view: &Picture| Picture::from_fn((width - 8, height), |x, y| view.get(x, y));
    let (smaller_left, smaller_right) = (smaller(&left), smaller(&right));
    let lower = Picture::from_fn(right.size(), |x, y| right.get(x, (y + 3).min(height - 1)));
    for (what, (left, right)) in [
        ("all surfaces are nearer", (&left, &nearer(40))),
        ("the right view is darker", (&left, &darker)),
        ("the views are smaller", (&smaller_left, &smaller_right)),
        ("the rows are off", (&left, &lower)),
    ] {
        let own = matched((left, right), None);
        let found = matched((left, right), Some(&precedent));
        assert!(!found.follows, "{what}");
        assert_eq!(found.outcome.dense, own.outcome.dense, "{what}");
    }

    let leaning = Picture::from_fn(right.size(), |x, y| right.get((x + y / 8).min(width - 1), y));
    let leaning = matched((&left, &leaning), None);
    assert!(leaning.outcome.seeding.rectification.lean != 0.0 && leaning.rectified.is_none());
    assert!(leaning.precedent(views).is_none(), "its map is that of upright columns");
}

/// A right view turned by 4 degrees: a small warp mends its rows, and its columns lean, as a first look tells; in the scene as it is the
/// look has too few points, and those of the seeding tell.
#[test]
fn a_pair_whose_columns_lean_is_matched_once() {
    let backend = Backend::open(&DeviceChoice::Best).expect("this test needs a device; lavapipe is one");
    let folder = scene("planes");
    for factor in [1, 2] {
        let views = ["left.png", "right.png"].map(|name| enlarged(&load::load(&folder.join(name)).unwrap(), factor));
        assert_eq!(times_matched(&backend, &views[0], &turned_by_4_degrees(&views[1])), 1, "enlarged by {factor}");
    }
}

/// The picture turned by 4 degrees about its middle.
fn turned_by_4_degrees(picture: &Picture) -> Picture {
    let Size { width, height } = picture.size();
    let [middle, centre] = [width, height].map(|side| f64::from(side) / 2.0);
    let (sin, cos) = 4f64.to_radians().sin_cos();
    Picture::from_fn(picture.size(), |x, y| {
        let (x, y) = (f64::from(x) - middle, f64::from(y) - centre);
        let [u, v] = [cos * x - sin * y + middle, sin * x + cos * y + centre].map(|place| place.round() as i64);
        picture.get_clamped(u, v)
    })
}

/// How many times a pair with leaning columns is matched densely.
fn times_matched(backend: &Backend, left: &Picture, right: &Picture) -> usize {
    let begun = RefCell::new(Vec::new());
    let task = Task {
        backend,
        views: (left, right),
        config: &Preset::Fast.config(),
        way: &Way::AsNeeded,
        calibration: None,
        precedent: None,
        begin: &|activity| begun.borrow_mut().push(activity),
        progress: &|_| (),
    };
    let matched = task.run().unwrap();
    assert!(matched.outcome.seeding.rectification.lean != 0.0 && matched.rectified.is_none());
    assert!(matched.judgement.not_trusted.is_none(), "{:?}", matched.judgement.not_trusted);
    begun.into_inner().iter().filter(|&&activity| activity == Activity::Step(Step::Dense)).count()
}
